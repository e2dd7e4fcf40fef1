// What a scene may ask of a joint's free coordinates. Each effect is one row of the coordinate with
// its own bias, softness and bounds; a World in which nobody calls these functions has no trace of
// them in step(). `coordinate` is a name from the joint's spec ("angle", "slide"). All throw
// cdot::Error on misuse.
#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include <cdot/world.hpp>

namespace cdot {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

struct Limit {
  std::optional<double> lower, upper;  // [m] or [rad]; one or both; equal: the coordinate is locked
};

struct Motor {
  double speed = 0;              // [m/s] or [rad/s]
  double max_force = unlimited;  // [N] or [N m]
};

struct CoordinateSpring {
  Softness softness;  // a damper alone: stiffness 0 and a damping
  double rest = 0;    // [m] or [rad]
};

struct DryFriction {
  double max_force = 0;  // [N] or [N m]
};

// Each returns the effect's number among those of its joint; -1 where the joint connects only immovable bodies.
template <class S>
int add_limit(BasicWorld<S>& world, int joint, std::string_view coordinate, const Limit& limit);
template <class S>
int add_motor(BasicWorld<S>& world, int joint, std::string_view coordinate, const Motor& motor);
template <class S>
int add_spring(BasicWorld<S>& world, int joint, std::string_view coordinate, const CoordinateSpring& spring);
template <class S>
int add_friction(BasicWorld<S>& world, int joint, std::string_view coordinate, const DryFriction& friction);

// While a World runs: other numbers for the effect of that number, from the next step on. Wakes the joint's island. A
// motor whose largest force is 0 is switched off, and so is a limit from -unlimited to unlimited; a limit with two ends
// and a locked coordinate do not become each other.
template <class S>
void set_limit(BasicWorld<S>& world, int joint, int effect, const Limit& limit);
template <class S>
void set_motor(BasicWorld<S>& world, int joint, int effect, const Motor& motor);
template <class S>
void set_spring(BasicWorld<S>& world, int joint, int effect, const CoordinateSpring& spring);
template <class S>
void set_friction(BasicWorld<S>& world, int joint, int effect, const DryFriction& friction);

// The joint disappears after the first step in which the norm of its row forces exceeds the load
// [N, N m].
template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load);

}  // namespace cdot
