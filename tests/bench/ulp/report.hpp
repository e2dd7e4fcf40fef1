// The measurements as tables.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/ulp/measure.hpp"

namespace cdot::ulp {

struct Line {
  const AnyBlock* block;
  const AnyBlock* form_of;  // null: generated
  Measured which;
  int operations;
  Accuracy in_float, in_double;
};

std::string csv(const std::vector<Line>& lines);
std::string markdown(const std::vector<Line>& lines, int samples_per_family);

}  // namespace cdot::ulp
