// One run of a scene, for judge().
#pragma once

#include <algorithm>
#include <string>

#include "tests/torture/invariants.hpp"

namespace cdot::torture {

constexpr double resolved = 0.5;  // largest Accounts::roughest of a resolved motion

constexpr double turns_round = 0.5;  // of unit rows, in a step

inline Verdict verdict(Outcome outcome, std::string what, std::string detail, double value = 0, double bound = 0,
                       int step = 0) {
  Verdict v;
  v.outcome = outcome, v.what = std::move(what), v.detail = std::move(detail);
  v.value = value, v.bound = bound, v.step = step;
  return v;
}

// f(S{}) with the scene's space S.
template <class F>
auto in_space_of(const Scene& scene, F f) {
  if (scene.dimension == Dimension::planar) return scene.single ? f(Planar<float>{}) : f(Planar<double>{});
  return scene.single ? f(Spatial<float>{}) : f(Spatial<double>{});
}

// True for bounds that hold only for short steps, by the order of the method.
inline bool judged_by_order(const std::string& what) {
  return what.starts_with("energy") || what == "angular momentum";
}

// The verdict on one run, without shorter steps.
Verdict judge_once(const Scene& scene, const Asked& asked);
// The largest rotation of a row in one step.
double most_turned(const Scene& scene, const Asked& asked);

}  // namespace cdot::torture
