// What the steps came to, over all islands; but for `retried` of the integrators that choose their own.
#pragma once

#include <limits>

namespace cdot {

struct StepCounts {
  long long evaluations = 0;          // of an island's accelerations
  long long taken = 0, rejected = 0;  // the error estimate was too large
  long long events = 0;               // located: something touched, let go, slipped or stuck
  // Ends of steps left to the linearly implicit Euler's: events without end, no step short enough, or, of fixed steps,
  // one whose error was estimated to be larger than the motion in its smallest parts as well.
  long long rescued = 0;
  long long retried = 0;  // steps that failed and succeeded in parts,
  long long direct = 0;   // and those of them for which the iterative solver had to step back
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;  // [s]
};

}  // namespace cdot
