// A joint's named parameters -> the numbers that its kernel reads.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <cdot/joints.hpp>
#include <cdot/settings.hpp>

namespace cdot {

// All numbers of Parameters<double>: given parameters checked and normalised, the others by the spec's defaults from
// the poses of the joint's bodies. S computes in doubles. Throws Error.
template <class S>
std::vector<double> parameter_numbers(int type, const std::vector<NamedValue>& given, const typename S::Pose* poses,
                                      double time);

// " above 0", " between 0 and 3.14159"; empty for a parameter without bounds.
std::string range_of(const ParameterInfo& info);

// The number above which a parameter lies: just below `above` where that itself is allowed.
inline double open_end(const ParameterInfo& info) {
  return info.from ? std::nextafter(info.above, -unbounded) : info.above;
}

// Writes the given parameters into `numbers`; the others stay. Returns the given ones. Throws Error.
std::vector<const ParameterInfo*> change_parameters(const JointType& type, const std::vector<NamedValue>& given,
                                                    std::vector<double>& numbers);

// Moves the joint's points in the world: points that its spec declares on the world, and points on bodies with
// fixed_in_world(body).
template <class Fixed>
void move_world_points(const JointType& type, const std::vector<int>& bodies, Fixed fixed_in_world,
                       const std::array<double, 3>& by, double sign, std::vector<double>& numbers) {
  for (const ParameterInfo& info : type.parameters) {
    if (info.kind != ParameterKind::point) continue;
    if (info.body >= 0 && !fixed_in_world(bodies[static_cast<size_t>(info.body)])) continue;
    double* const point = numbers.data() + info.offset;
    for (int k = 0; k < info.size; ++k) point[k] += sign * by[static_cast<size_t>(k)];
  }
}

}  // namespace cdot
