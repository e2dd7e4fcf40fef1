// The price of explicit steps of the highest order that stay stable over a whole run, in evaluations.
#pragma once

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

double stiff_price(const Scene& scene, const std::vector<WorstOfIsland>& islands);
double stiff_price_at_start(const Scene& scene);

}  // namespace cdot
