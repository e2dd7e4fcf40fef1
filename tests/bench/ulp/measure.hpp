// Errors of one scalar's kernels against Exact's on the same numbers.
#pragma once

#include <string_view>
#include <vector>

#include "tests/bench/ulp/inputs.hpp"
#include "tests/bench/ulp/measured.hpp"

namespace cdot::ulp {

struct Spread {
  double median = 0, p99 = 0, worst = 0;
  std::string_view worst_family = "";
};

struct Accuracy {
  Spread ulp;    // in units in the last place of the exact result
  Spread scale;  // in units in the last place of the result's natural scale
  double nanoseconds = 0;
  int guarded = 0;  // inputs left out because a guarded pivot dropped a row
};

// The functions of block `index` of measured_blocks<T>(), in their order.
template <class T>
std::vector<Accuracy> measure(std::size_t index, int samples_per_family);

}  // namespace cdot::ulp
