// A joint of MJCF's <equality><joint>: the spec of one's own that the scene takes beside it.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cdot {

// A coordinate of a hinge or a slider, by the letters of the bodies above and below that joint.
struct CoupledCoordinate {
  char above = 'a', below = 'b';
  bool turns = true;
  double start = 0;  // its value in the model where that of the scene is 0 [rad], [m]
};

// first = c[0] + c[1] second + c[2] second^2 + ..., in radians and metres; without a second one it stays at c[0].
std::string coupling_spec(const std::string& name, const CoupledCoordinate& first,
                          const std::optional<CoupledCoordinate>& second, const std::vector<double>& c);

}  // namespace cdot
