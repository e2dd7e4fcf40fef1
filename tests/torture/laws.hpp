// A scene -> its conserved quantities: momenta, energy.
#pragma once

#include <array>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

struct Laws {
  std::array<bool, 3> linear{}, angular{};  // by axis; angular about the origin. In the plane: x, y and about z.
  bool energy_kept = false;                 // no sources, no sinks
  bool energy_falls = false;                // no sources
  bool may_contradict = false;              // a motion is prescribed and may be blocked
  bool smooth = false;                      // no impact, friction or switch: a short enough step resolves the motion
  void forget_what_is_kept() { linear = angular = {}, energy_kept = energy_falls = false; }
  bool momentum() const { return linear[0] || linear[1] || linear[2] || angular[0] || angular[1] || angular[2]; }
};

Laws laws_of(const Scene& scene);

// The largest effective 1 / m of a force on these bodies with arms of that length.
double lightness(const Scene& scene, const std::vector<int>& bodies, double length);

// True if a spring or damper as an explicit force is unstable at that step: h^2 k / m > 4 or h d / m > 2, where m is
// the least effective mass of its bodies with arms up to `length`.
bool stiff(const Scene& scene, double step, double length);

// An estimate of the rounded operations on a body's velocity in a step: each row of each of its joints, once per solve.
double operations_of(const Scene& scene);

// The scene without the effects that only push bodies: their rows hold nothing, but they add to the rank of all rows.
Scene without_forces(const Scene& scene);

// The ratio of masses of movable bodies.
double heaviest_over_lightest(const Scene& scene);

}  // namespace cdot::torture
