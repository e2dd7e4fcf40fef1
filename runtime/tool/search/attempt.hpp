// One run of a search, and its distance from a coarser one.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include "runtime/tool/run/simulate.hpp"
#include "runtime/tool/search/knobs.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot {

struct Attempt {
  Try knob;
  RunResult result;
  std::vector<Frame> frames;  // at the ends of the intervals
  std::vector<Frame> rows;
  std::shared_ptr<Paces> paces;           // of its steps
  std::shared_ptr<const Paces> paced_by;  // of the run that it follows; empty: of none
  double energy_share = 0;                // the largest error of the energy so far, see EnergyWatch
  double price = 0;
  bool full = false;                                          // it has the outputs asked for
  bool whole = false;                                         // it has ended in time and well
  double apart = std::numeric_limits<double>::infinity();     // distance from a coarser run
  double achieved = std::numeric_limits<double>::infinity();  // as that distance makes sure
  double claimed = std::numeric_limits<double>::infinity();   // Choice::achieved
  double holds_until = 0;
  bool reached = false;
  double foreseen = 0;  // distance from the run before at the end, if it made the run end early
};

struct Distance {
  double largest = 0;      // in the units of the yardstick
  double agree_until = 0;  // [s]: where runs part for good, no gain is sure
};
// At the first `ends` of the coarse run's intervals; all by default.
Distance distance(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine,
                  std::size_t ends = std::numeric_limits<std::size_t>::max());
// The factor by which the error of the fine run is surely smaller, if they are so far apart.
double sure_gain(const Attempt& coarse, const Attempt& fine, double apart);
// The distance at the end, foreseen from that up to now, if it shows that the two runs will not agree; else 0.
double foreseen_distance(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine);

}  // namespace cdot
