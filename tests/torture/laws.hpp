// What the motion of a scene keeps, by what the scene consists of: which momenta, and whether energy.
#pragma once

#include <array>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

struct Laws {
  std::array<bool, 3> linear{}, angular{};  // by axis; angular about the origin. In the plane: x, y and about z.
  bool energy_kept = false;                 // nothing takes or gives any
  bool energy_falls = false;                // nothing gives any
  bool may_contradict = false;              // a motion is prescribed, and something else may not let it happen
  bool smooth = false;  // nothing that hits, sticks or switches: every motion is resolved by some step
  bool momentum() const { return linear[0] || linear[1] || linear[2] || angular[0] || angular[1] || angular[2]; }
};

Laws laws_of(const Scene& scene);

// 1 / m that a pull on these bodies feels at most, at arms of that length.
double lightness(const Scene& scene, const std::vector<int>& bodies, double length);

// A spring or damper, taken as a force over a step of that length, would throw its bodies back further than it found
// them: h^2 k / m > 4 or h d / m > 2, m being the least that it may feel of bodies with arms up to `length`.
bool stiff(const Scene& scene, double step, double length);

}  // namespace cdot::torture
