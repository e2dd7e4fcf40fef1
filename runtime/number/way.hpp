// The cubic by which a row's C moves within a step.
#pragma once

#include <cmath>

namespace cdot {

// A way that keeps less than this share of its first rate may turn twice: cubics err by less than that.
inline constexpr double slow_turn = 0.25;

// It has the values and rates of C at both ends.
template <class T>
struct Way {
  T from, change, rate_from, rate_to;  // rates times the length of the step
  T at(T share) const { return from + share * (rate_from + share * (change - rate_from - (T(1) - share) * bend())); }
  // Where values known to `noise` do not tell how the way bends, as in short steps: the parabola of the rates.
  Way known_to(T noise) const {
    const T mean = T(0.5) * (rate_from + rate_to);
    return std::abs(bend()) < noise ? Way{from, mean, rate_from, rate_to} : *this;
  }
  T bend() const { return rate_from + rate_to - T(2) * change; }
  T rate_at(T share) const { return rate_from + share * (rate_to - rate_from - T(3) * bend() * (T(1) - share)); }
  // Where that rate turns back.
  T turn() const { return T(0.5) + (rate_from - rate_to) / (T(6) * bend()); }
  bool turns_back() const { return rate_from * rate_to < 0; }
  // Both ends go the same way, and less than `slow_turn` of that rate is left between them.
  bool may_turn_twice() const {
    const T share = turn();
    return share > 0 && share < 1 && rate_at(share) * rate_from < T(slow_turn) * rate_from * rate_from;
  }
};

}  // namespace cdot
