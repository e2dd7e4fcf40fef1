// Ways to solve a scene: integrator, solver, drift correction, precision. `cdot-run accuracy` compares them.
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
  bool adaptive = false;  // its knob is the local error instead of the step
  bool extended = false;  // in extended precision: for references only
  int lanes = 0;          // compiled (`cdot compile`), so many mechanisms at once; 0: a World
  bool operator==(const Way&) const = default;
};

const std::vector<Way>& all_ways();

// "rk4, direct", "euler + baumgarte, 10 iterations, float", "dop853, direct, adaptive": the words of a scene's keys.
std::string name_of(const Way& way);

// How fine a way works.
struct Knob {
  int steps = 1;           // equal ones from one sample of the trajectory to the next
  double local_error = 0;  // of an adaptive way, which chooses its number of steps
};

// Level 0 is the coarsest. Steps are 1, 2, 4, … for ways of first order, else 1, 2, 3, 4, 6, 8, …; local errors are
// powers of ten.
inline constexpr int most_levels = 36;
bool has_level(const Way& way, int level);
Knob knob_at(const Way& way, int level);

// The scene with the settings of the way.
Scene solved_by(const Way& way, const Knob& knob, Scene scene);

}  // namespace cdot
