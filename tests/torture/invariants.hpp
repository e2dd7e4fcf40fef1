// The invariants of every mechanism with every method: judge() runs a scene and checks them. README.md derives the
// bounds.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

enum class Outcome {
  held,
  refused,  // not run: the World or its start was refused with a reason
  limited,  // a known limitation of the method, named by `what`
  broken    // violates an invariant
};

struct Verdict {
  Outcome outcome = Outcome::held;
  std::string what;  // the invariant, the limitation, or the refusal: the same words for the same kind
  std::string detail;
  double value = 0, bound = 0;
  int step = 0;  // number of the step that showed it
  double roughest =
      0;  // largest relative change of the acceleration in a step; above 0.5 the step does not resolve the motion
  double length = 1;   // of the mechanism [m]
  double fastest = 0;  // Accounts::fastest() [1/s]
  bool judged_energy = false, judged_momentum = false;
  bool broken() const { return outcome == Outcome::broken; }
};

// For tests of the torture itself: called after every step, may push a body of the World.
using Push = std::function<void(int body, double impulse)>;
using Sabotage = std::function<void(const Scene& scene, int step, const Push& push)>;

struct Asked {
  bool bits = true;      // also repeats the run in two threads at once and from a snapshot
  bool varying = false;  // the steps' lengths vary between a fifth of the scene's step and all of it
  bool changes = false;  // impulses, forces and the loss of a joint, while running
  bool forces = false;   // a force on each body that is a function of time
  bool hurry = false;    // ends a run that rescued_in_vain()
  int refinements = 4;   // how often a step is divided by four after a violation
  // Nothing else is judged: a run by sweeps, of a drift correction, numbers of sweeps and substeps and of steps that
  // this seed draws, up to 30 times the scene's. No energy may appear.
  std::optional<std::uint64_t> swept = {};
  Sabotage sabotage;
};

Verdict judge(const Scene& scene, const Asked& asked = {});

// The number of steps of the scene.
int steps_of(const Scene& scene);

}  // namespace cdot::torture
