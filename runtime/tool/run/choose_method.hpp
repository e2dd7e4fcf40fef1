// A scene's `accuracy` -> an integrator and its local error. Trial runs find them.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct Choice {
  Integrator integrator{};
  double local_error = 0;
  // [m, rad] distance of the chosen run from one with a hundredth of its local error, over the samples.
  double achieved = 0;
  bool reached = false;  // the distance is within the accuracy
  // Evaluations of accelerations in the chosen run. They decide, since they are the same on every machine.
  long long evaluations = 0;
};

// Of the integrators that choose their steps. The scene must ask for an accuracy. Runs it a few times.
Choice choose_method(const Scene& scene);

// Number of samples. Trial runs and the run itself end a step at each.
inline constexpr int looks_for_accuracy = 64;

// The scene with that method.
Scene solved_by(const Choice& choice, Scene scene);

}  // namespace cdot
