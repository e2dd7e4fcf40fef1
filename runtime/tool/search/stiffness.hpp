// The price of explicit steps of the highest order that stay stable over a whole run, in evaluations.
#pragma once

#include <limits>

#include "runtime/tool/run/simulate.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot {

// Of a run that was stopped, diagnosed for steps of this length. Forces with limits count as within these: explicit
// steps throw a stiff one from limit to limit, where it has no slope.
double stiff_price(const Scene& scene, double step, const std::vector<WorstOfIsland>& islands);
// At the start, where such a force counts as it is: it may stay at its limit.
struct StiffStart {
  double price = 0;
  double limited = 0;  // the largest Diagnosis::Island::limited, for steps of an interval
  double omega = 0;    // [1/s] of the stiffest oscillation
  double energy =
      std::numeric_limits<double>::infinity();  // [J] that one of amplitude 1 has at least, by the yardstick
};
StiffStart stiffness_at_start(const Scene& scene, const Yardstick& yardstick);

}  // namespace cdot
