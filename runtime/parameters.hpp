// A joint's parameters as a scene names them, turned into the numbers that its kernel reads.
#pragma once

#include <vector>

#include "runtime/joints.hpp"
#include "runtime/settings.hpp"

namespace cdot {

// S computes in doubles. All numbers of Parameters<double>: given ones checked and normalised, the
// others by the spec's default from the poses of the joint's bodies. Throws Error.
template <class S>
std::vector<double> parameter_numbers(int type, const std::vector<NamedValue>& given,
                                      const typename S::Pose* poses, double time);

}  // namespace cdot
