// The laws of effects as operations: forces along rows, their slopes, energies.
#pragma once

#include <vector>

#include "derive/compile/rows/row_blocks.hpp"

namespace cdot::compile {

// From the kernel's angle within half a turn; `number`: of the angle.
Unwound unwound(Algebra& algebra, int number, int C);

// Of one effect, by row; `in` are the inputs of its rows with their J.
class LawWriter {
 public:
  LawWriter(const RowBlocks& rows, Algebra& algebra, const Effect& effect, const RowBlock& block, const Values& in);

  // The same law at other values and rates.
  LawWriter at(std::vector<int> C, std::vector<int> rate) const;
  LawWriter at_rest() const;
  // The same law with these numbers of K = J M^-1 J^T of each row, by which springs by frequency are stiff.
  LawWriter with_masses(std::vector<int> K) const;

  // The same law of a row that carries this load.
  LawWriter with_load(int load) const;

  const std::vector<int>& C() const { return C_; }

  const std::vector<int>& drift() const { return drift_; }  // dC/dt
  // J v + dC/dt at the velocities of `in`.
  const std::vector<int>& rate() const { return rate_; }
  std::vector<int> force_without_limits() const;
  // Within its limits, if it has any.
  std::vector<int> force() const;
  // A function of the law of a spec.
  Values call(const derive::Program& function) const;
  const SpecPrograms& spec() const { return rows_.law(effect_); }
  int least(int a, int b) const;
  int most(int a, int b) const;
  // Stiffness and damping by row, such that the diagonal matrices of these are at least as stiff as the whole ones:
  // k_rr + sum |k_rc|. Never negative.
  struct Slopes {
    std::vector<int> k, d;
  };
  Slopes slopes() const;
  // The same, but a force at one of its limits has no slope.
  Slopes slopes_within_limits() const;
  // False if the force is the same at all rates.
  bool reads_rates() const;
  // 0 for a law that stores none.
  int energy() const;

 private:
  std::vector<int> spring_force() const;
  bool has_limits() const { return !effect_.law_type.empty() && spec().rows.has("limits"); }
  Slopes spring_slopes() const;
  std::vector<int> bound(const Values& slopes, const std::string& letter) const;
  bool acts(std::size_t row) const;

  const RowBlocks& rows_;
  Algebra& algebra_;
  const Effect& effect_;
  const RowBlock& block_;
  const Values& in_;
  std::vector<int> C_, drift_, rate_;
  std::vector<int> K_;  // empty: those at the pose
  int load_ = -1;       // unknown
};

}  // namespace cdot::compile
