#pragma once

namespace cdot {

// The same numbers in [0, 1) every time, that have nothing to do with any scene: no eigenvector is orthogonal to them
// but by chance, and no pose made of them is a special one.
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
