// The end of a step as text: C = 0 and J v = -dC/dt; and the impulses of rows with bounds.
#pragma once

#include <string>

namespace cdot::compile {

// The parts of a mechanism: rows of joints, effects by forces, rows with bounds, and among these some with ends.
struct Contents {
  bool rows = false, effects = false, bounded = false, ends = false;
  bool closes() const { return rows || ends; }
};

// close() and project().
std::string corrections_of(double tolerance, const Contents& has);
// largest(), and for rows with bounds struct Bounded, divide() and settle(). is_rate: "true, false", by row.
std::string bounded_of(const std::string& is_rate, const Contents& has);

}  // namespace cdot::compile
