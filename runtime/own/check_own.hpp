// The derived rates and slopes of a kernel of tapes against differences of C, energy and force: a second route, as
// proofs are for compiled ones.
#pragma once

#include <string>

#include "derive/own/own_kernel.hpp"

namespace cdot {

// The first row whose J v + dC/dt differs from central differences of C at most of the random poses, with both numbers;
// empty if there is none. Poses at which C has no finite value do not count.
std::string wrong_rate(const OwnKernel& kernel);

// Likewise of an effect's law: its slopes against differences of its force, and what its energy stores of the force
// against differences of that energy.
std::string wrong_law(const OwnKernel& kernel);

}  // namespace cdot
