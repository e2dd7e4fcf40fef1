// The problems by name: Cdot's own scenes, so that every engine is asked the same, with the times at which answers are
// compared and the reference there.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

// How a scene is measured.
struct ProblemRow {
  const char* name;
  const char* title;
  const char* scene;  // below specs/scenes, without .toml
  double duration;    // [s]
  Measure measure;
};

const std::vector<ProblemRow>& problem_rows();

// Bodies and joints of a scene, as its World has them at the start; throws CannotSay. S is in doubles.
template <class S>
Problem problem_of(const Scene& scene, const BasicWorld<S>& built);

// Without its reference.
Problem pose(const ProblemRow& row);
// With it, from references/; throws std::runtime_error if that is of another problem.
Problem load(const ProblemRow& row);

std::string reference_file(const std::string& problem);

// Total linear momentum, angular momentum about the origin, kinetic and potential energy (zero at the origin).
struct Totals {
  Vec3 momentum{}, angular_momentum{};
  double kinetic = 0, potential = 0;
};
Totals totals(const Problem& problem, const std::vector<State>& states);

std::vector<State> starts(const Problem& problem);

}  // namespace cdot::peers
