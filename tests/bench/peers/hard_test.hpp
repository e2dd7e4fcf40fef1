// What the tests of the adapters share.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

// The farthest that two have the same body from each other.
inline double apart(const std::vector<State>& a, const std::vector<State>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, norm(a[k].x - b[k].x));
  return worst;
}

inline const Engine& named(const std::string& name) {
  return *std::find_if(engines().begin(), engines().end(), [&](const Engine& e) { return e.name == name; });
}

}  // namespace cdot::peers
