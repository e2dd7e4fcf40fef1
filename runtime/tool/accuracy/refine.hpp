// A method and a scene -> its trajectory, refined until only round-off changes.
#pragma once

#include <limits>
#include <string>

#include "runtime/tool/run/trajectory.hpp"

namespace cdot {
// The limits of one method. Evaluations give the same result on every machine; the CPU time bounds the wait.
struct Effort {
  long long evaluations = 2'000'000;                     // of an island's accelerations, or steps composed
  double cpu = std::numeric_limits<double>::infinity();  // [s]
};

struct Refined {
  std::string name;  // "dop853"
  Way way;
  Trajectory best;
  Knob knob;                    // of the best
  std::vector<double> changes;  // from the previous knob, at each time [m, rad]
  bool at_its_floor = false;    // finer knobs do not reduce the changes: they are round-off
  long long evaluations = 0;    // of all knobs
  double change() const;        // the largest
  bool found() const { return !best.frames.empty(); }
};

// Takes more and more fixed steps, in doubles or in extended precision. A symmetric method is composed().
Refined refined(Integrator integrator, bool extended, const Scene& scene, const std::vector<double>& times,
                const Effort& effort, const Stop& stop);

// The largest distance or angle at each time; both are whole.
std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension);
double largest(const std::vector<double>& values);

// True if the motion retraces its path when velocities turn round: no damper, friction, motor, limit, drive in time or
// breaking load.
bool reversible(const Scene& scene);

// A trajectory of order 10 from a symmetric method alone: 35 of its steps, some backwards, cancel the errors of lower
// order in one composed step. The order holds for reversible scenes. The method is known only by its World, so the
// result owes nothing to accelerations, and nothing is extrapolated: round-off stays that of the steps.
// Takes `steps` composed steps between times. StepCounts::evaluations counts the method's steps.
Trajectory composed(Integrator symmetric, const Scene& scene, int steps, const std::vector<double>& times,
                    const Stop& stop = {}, bool extended = false);

}  // namespace cdot
