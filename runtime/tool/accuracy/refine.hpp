// One method made ever finer until that changes nothing any more but round-off.
#pragma once

#include <limits>
#include <string>

#include "runtime/tool/run/trajectory.hpp"

namespace cdot {
// How much may be spent on one method. The evaluations decide the same on every machine; the seconds are for people.
struct Effort {
  long long evaluations = 2'000'000;                     // of an island's accelerations, or steps of RATTLE
  double cpu = std::numeric_limits<double>::infinity();  // [s]
};

struct Refined {
  std::string name;  // "dop853"
  Way way;
  Trajectory best;
  Knob knob;                    // that made it
  std::vector<double> changes;  // from the knob before, at each time [m, rad]
  bool at_its_floor = false;    // finer knobs did not make the changes smaller: they are round-off, grown on the way
  long long evaluations = 0;    // that all knobs took
  double change() const;        // the largest
  bool found() const { return !best.frames.empty(); }
};

// A Runge-Kutta method on accelerations, or RATTLE, composed, on impulses: with fixed steps, ever more of them; in
// doubles or in extended precision.
Refined refined(Integrator integrator, bool extended, const Scene& scene, const std::vector<double>& times,
                const Effort& effort, const Stop& stop);

// The largest distance or angle at each time; both are whole.
std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension);
double largest(const std::vector<double>& values);

// Whether the motion goes back the same way when velocities turn round, and nothing stops it: no dampers, friction,
// motors or limits, nothing driven in time, nothing that breaks. Only then is it of that order.
bool reversible(const Scene& scene);

// `steps` such steps from one of the times to the next, in doubles or in extended precision. Counts::evaluations are
// the method's steps.
Trajectory composed(Integrator symmetric, const Scene& scene, int steps, const std::vector<double>& times,
                    const Stop& stop = {}, bool extended = false);

}  // namespace cdot
