// Helpers of the adapters' tests.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

// The largest distance between the same bodies of two states.
inline double apart(const std::vector<State>& a, const std::vector<State>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, norm(a[k].x - b[k].x));
  return worst;
}

inline const Engine& named(const std::string& name) {
  return *std::find_if(engines().begin(), engines().end(), [&](const Engine& e) { return e.name == name; });
}

}  // namespace cdot::peers
