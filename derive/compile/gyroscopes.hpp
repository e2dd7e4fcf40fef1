// Bodies in space whose inertia turns with them, as text: tensors in the world's axes, spin by angular momentum.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// True if forces read the spin of such a body: drag does, or some effect (`looks`).
bool carries_spin(const Mechanism& mechanism, bool looks);
// An argument of functions that read M^-1: poses, if they have it.
std::string pose_argument(const Mechanism& mechanism);

// weigh(): M^-1 at the poses. For a step at velocities also wind(), follow() and drift(): spins by angular momenta.
std::string gyroscopes_of(const Mechanism& mechanism, const std::vector<std::string>& names);
// find_mean_spins(): velocities by which drift() turns.
std::string mean_spins_of(const Mechanism& mechanism, const std::vector<std::string>& names);

// A line that declares I^-1 torque of the constant torque as `rod_rate`; empty: there is none.
std::string torque_of(const Body& body, const std::string& name);
// Lines of energy() that subtract from `sum` the work of a constant torque in space.
std::string work_of_torque(const Body& body, const std::string& name);
// Lines that add w . I w to `sum`.
std::string spin_energy_of(const Body& body, const std::string& name);

}  // namespace cdot::compile
