// The ways of solving a scene that `cdot-run accuracy` compares: every integrator of
// higher order in the same ways.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct Way {
  Integrator integrator = Settings{}.integrator;
  Solver solver = Settings{}.solver;
  Drift drift = Settings{}.drift;
  int iterations = 10;    // of the iterative solver
  bool single = false;    // in float
  bool adaptive = false;  // its knob is the local error, not the step
  bool extended = false;  // in extended precision: for references, never compared
  bool operator==(const Way&) const = default;
};

const std::vector<Way>& all_ways();

// "rk4, direct", "euler + baumgarte, 10 iterations, float", "dop853, direct, adaptive": as a scene's keys have it.
std::string name_of(const Way& way);

// How finely a way is told to work.
struct Knob {
  int steps = 1;           // from one sample of the trajectory to the next, all of the same length
  double local_error = 0;  // of an adaptive way, which takes as many steps as it needs for it
};

// Level 0 is the coarsest. Steps go by 1, 2, 4, … for ways of first order, else by 1, 2, 3, 4, 6, 8, …; local errors
// by powers of ten.
inline constexpr int most_levels = 36;
bool has_level(const Way& way, int level);
Knob knob_at(const Way& way, int level);

// The scene, to be solved this way.
Scene solved_by(const Way& way, const Knob& knob, Scene scene);

}  // namespace cdot
