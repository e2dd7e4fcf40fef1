// The laws of effects as operations: forces along rows, their slopes, energies.
#pragma once

#include <vector>

#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

// Of one effect, by row; `in` are the inputs of its rows with their J.
class LawWriter {
 public:
  LawWriter(const RowBlocks& rows, Algebra& algebra, std::size_t effect, const Values& in);

  // J v + dC/dt at the velocities of `in`.
  const std::vector<int>& rate() const { return rate_; }
  // Within its limits, if it has any.
  std::vector<int> force() const;
  // Stiffness and damping by row, such that the diagonal matrices of these are at least as stiff as the whole ones:
  // k_rr + sum |k_rc|. Never negative.
  struct Slopes {
    std::vector<int> k, d;
  };
  Slopes slopes() const;
  // 0 for a law that stores none.
  int energy() const;

 private:
  const Effect& effect() const { return rows_.mechanism().effects[number_]; }
  Values call_law(const std::string& function) const;
  std::vector<int> spring_force() const;
  Slopes spring_slopes() const;
  std::vector<int> bound(const Values& slopes, const std::string& letter) const;
  bool acts(std::size_t row) const;
  int least(int a, int b) const;
  int magnitude(int a) const;

  const RowBlocks& rows_;
  Algebra& algebra_;
  std::size_t number_;
  const RowBlock& block_;
  const Values& in_;
  std::vector<int> C_, rate_;
};

}  // namespace cdot::compile
