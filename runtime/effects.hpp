// What a scene may ask of a joint's free coordinates. Each effect is one row of the coordinate with
// its own bias, softness and bounds; a World in which nobody calls these functions has no trace of
// them in step(). `coordinate` is a name from the joint's spec ("angle", "slide"). All throw
// cdot::Error on misuse.
#pragma once

#include <limits>
#include <optional>
#include <string_view>

#include "runtime/world.hpp"

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

template <class S>
void add_limit(BasicWorld<S>& world, int joint, std::string_view coordinate, const Limit& limit);
template <class S>
void add_motor(BasicWorld<S>& world, int joint, std::string_view coordinate, const Motor& motor);
template <class S>
void add_spring(BasicWorld<S>& world, int joint, std::string_view coordinate,
                const CoordinateSpring& spring);
template <class S>
void add_friction(BasicWorld<S>& world, int joint, std::string_view coordinate,
                  const DryFriction& friction);
// The joint disappears after the first step in which the norm of its row forces exceeds the load
// [N, N m].
template <class S>
void set_breaking_load(BasicWorld<S>& world, int joint, double load);

}  // namespace cdot
