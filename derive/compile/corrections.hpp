// The end of a step as text: C = 0 and J v = -dC/dt; and the impulses of rows with bounds.
#pragma once

#include <string>

namespace cdot::compile {

// The parts of a mechanism: rows of joints, effects by forces, rows with bounds, and among these some with ends; bodies
// in space, and among these some whose inertia turns with them.
struct Contents {
  bool rows = false, effects = false, bounded = false, ends = false;
  bool spatial = false, gyroscopes = false, angles = false;  // angles: that count whole turns
  bool closes() const { return rows || ends; }
};

// close() and project(); `renew`: lines that set inertias in the lanes of `renews`.
std::string corrections_of(double tolerance, const Contents& has, const std::string& renew);
// largest(), and for rows with bounds struct Bounded, divide() and settle(). is_rate: "true, false", by row.
std::string bounded_of(const std::string& is_rate, const Contents& has);

}  // namespace cdot::compile
