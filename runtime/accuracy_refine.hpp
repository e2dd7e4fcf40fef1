// One method made ever finer until that changes nothing any more but round-off.
#pragma once

#include <limits>
#include <string>

#include "runtime/accuracy_run.hpp"

namespace cdot {

// How much may be spent on one method. The evaluations decide the same on every machine; the seconds are for people.
struct Effort {
  long long evaluations = 2'000'000;  // of an island's accelerations, or steps of RATTLE
  double cpu = std::numeric_limits<double>::infinity();  // [s]
};

struct Refined {
  std::string name;  // "dop853"
  Trajectory best;
  Knob knob;                    // that made it
  std::vector<double> changes;  // from the knob before, at each time [m, rad]
  bool at_its_floor = false;    // finer knobs did not make the changes smaller: they are round-off, grown on the way
  long long evaluations = 0;    // that all knobs took
  double change() const;        // the largest
  bool found() const { return !best.frames.empty(); }
};

// Runge-Kutta methods on accelerations, and RATTLE, composed, on impulses; all with fixed steps, ever more of them.
Refined refined_dop853(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop);
Refined refined_rk4(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop);
Refined refined_rattle(const Scene& scene, const std::vector<double>& times, const Effort& effort, const Stop& stop);

// What refined_dop853 runs, with a knob.
Way way_of_dop853();

// The largest distance or angle at each time; both are whole.
std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension);
double largest(const std::vector<double>& values);

}  // namespace cdot
