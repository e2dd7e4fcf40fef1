// The problems by name: Cdot's scenes for all engines, with the sample times and the reference.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

// A scene and its measure.
struct ProblemRow {
  const char* name;
  const char* title;
  const char* scene;  // below specs/scenes, without .toml
  double duration;    // [s]
  Measure measure;
};

const std::vector<ProblemRow>& problem_rows();

// Copies properties of a joint from the scene that the World does not report; throws CannotSay.
void take_given(const SceneJoint& source, Problem& problem, Joint& joint);

// Bodies and joints of a scene, as its World has them at the start; throws CannotSay. S is in doubles.
template <class S>
Problem problem_of(const Scene& scene, const BasicWorld<S>& built);

// The problem without its reference.
Problem pose(const ProblemRow& row);
// The problem with its reference from references/; throws std::runtime_error if that belongs to another problem.
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
