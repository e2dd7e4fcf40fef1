// A walk from state to state in which each follows from the one before: finds that it goes in circles. (R. P. Brent,
// "An improved Monte Carlo factorization algorithm", BIT 20, 1980.)
#pragma once

#include <cstddef>
#include <vector>

namespace cdot {

class Circle {
 public:
  void reserve(std::size_t numbers) { noted_.assign(numbers, 0); }
  void begin(const std::vector<char>& state) { note(state, 1); }

  // Call with each further state. The number of states in the circle that this one closes; 0: none is seen yet.
  int closes(const std::vector<char>& state) {
    ++since_;
    if (state == noted_) return since_;
    if (since_ == patience_) note(state, 2 * patience_);
    return 0;
  }

 private:
  void note(const std::vector<char>& state, int patience) { noted_ = state, since_ = 0, patience_ = patience; }

  std::vector<char> noted_;
  int since_ = 0, patience_ = 1;  // notes the state anew after so many
};

}  // namespace cdot
