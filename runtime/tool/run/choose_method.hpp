// What a scene's `accuracy` is turned into: an integrator and its local error, found by runs whose results are
// compared.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct Choice {
  Integrator integrator{};
  double local_error = 0;
  // [m, rad] how far the run chosen is from one of a hundredth of its local error, over the samples of the run.
  double achieved = 0;
  bool reached = false;  // that is within the accuracy asked for
  // Of accelerations, of the run chosen: what the choice went by, since it is the same on every machine.
  long long evaluations = 0;
};

// Of the integrators that choose their steps. The scene must ask for an accuracy. Runs it a few times.
Choice choose_method(const Scene& scene);

// A run is looked at so often, at least: those that compare as well as the run itself end a step there.
inline constexpr int looks_for_accuracy = 64;

// The scene with that method.
Scene solved_by(const Choice& choice, Scene scene);

}  // namespace cdot
