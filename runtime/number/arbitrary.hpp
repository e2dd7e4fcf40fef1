#pragma once

namespace cdot {

// A fixed sequence of numbers in [0, 1) without relation to any scene: a start vector for power iterations, and poses
// that are not singular.
class Arbitrary {
 public:
  double operator()() {
    state_ = state_ * 1664525u + 1013904223u;
    return state_ / 4294967296.0;
  }

 private:
  unsigned state_ = 1;
};

}  // namespace cdot
