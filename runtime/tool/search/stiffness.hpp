// The price of explicit steps of the highest order that stay stable over a whole run, in evaluations.
#pragma once

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// Of a run that was stopped, diagnosed for steps of this length. Forces with limits count as within these: explicit
// steps throw a stiff one from limit to limit, where it has no slope.
double stiff_price(const Scene& scene, double step, const std::vector<WorstOfIsland>& islands);
// At the start, where such a force counts as it is: it may stay at its limit.
struct StiffStart {
  double price = 0;
  double limited = 0;  // the largest Diagnosis::Island::limited, for steps of an interval
};
StiffStart stiffness_at_start(const Scene& scene);

}  // namespace cdot
