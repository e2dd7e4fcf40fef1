// The derived rates of a kernel of tapes against differences of its C: a second route, as proofs are for compiled ones.
#pragma once

#include <string>

#include "derive/own/own_kernel.hpp"

namespace cdot {

// The first row whose J v + dC/dt differs from central differences of C at most of the random poses, with both numbers;
// empty if there is none. Poses at which C has no finite value do not count.
std::string wrong_rate(const OwnKernel& kernel);

}  // namespace cdot
