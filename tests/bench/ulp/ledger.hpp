// Operations of a generated function, from generated/ledger.csv.
#pragma once

#include <string>

#include "tests/bench/ulp/measured.hpp"

namespace cdot::ulp {

int operations(const MeasuredBlock<double>& block, Measured which);

}  // namespace cdot::ulp
