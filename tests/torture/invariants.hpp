// What must hold of any mechanism, whichever way it is run, and whether it did: judge() runs a scene and says so.
// README.md has the bounds and where they come from.
#pragma once

#include <functional>
#include <string>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

enum class Outcome {
  held,
  refused,  // not run: the World, or its start, was refused with a reason
  limited,  // a known limitation of the method, told by `what`
  broken    // an invariant
};

struct Verdict {
  Outcome outcome = Outcome::held;
  std::string what;  // the invariant, the limitation, or the refusal: the same words for the same kind
  std::string detail;
  double value = 0, bound = 0;
  int step = 0;         // after which it was seen
  double roughest = 0;  // how much the acceleration changed within a step, relative; above 0.5 no step resolves it
  double length = 1;    // of the mechanism [m]
  bool judged_energy = false, judged_momentum = false;
  bool broken() const { return outcome == Outcome::broken; }
};

// Of tests of the tests: called after every step, may push a body of the World.
using Push = std::function<void(int body, double impulse)>;
using Sabotage = std::function<void(const Scene& scene, int step, const Push& push)>;

struct Asked {
  bool bits = true;     // also repeat it, in two threads at once, and from a snapshot
  int refinements = 4;  // how often a step at which something breaks is made four times shorter
  Sabotage sabotage;
};

Verdict judge(const Scene& scene, const Asked& asked = {});

// So many steps the scene has.
int steps_of(const Scene& scene);

}  // namespace cdot::torture
