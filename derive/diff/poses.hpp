// Random poses at which formulas are compared, and the same poses moved until equations hold.
#pragma once

#include <optional>

#include "derive/derivation/derivation.hpp"
#include "derive/numbers/newton.hpp"

namespace cdot::derive {

class Poses {
 public:
  // `expressions`: all expressions that will be evaluated.
  Poses(const Joint& joint, std::vector<Expr> expressions);

  // The same poses, moved until these equations hold as well; none if Newton fails at too many.
  Poses where(const std::vector<Expr>& equations) const;

  // The same poses with all bodies in nearly the same orientation: starting points for C = 0.
  Poses aligned() const;
  Poses first(std::size_t count) const;
  bool empty() const { return samples_.empty(); }
  const std::vector<Sample>& samples() const { return samples_; }

  // By exact arithmetic, or |a - b| is round-off at every pose.
  bool equal(Expr a, Expr b) const;
  // The constant k with a = k b at every pose, if there is one.
  std::optional<double> constant_ratio(Expr a, Expr b) const;

 private:
  const Joint* joint_;
  std::vector<Sample> samples_;
  std::vector<Expr> equations_;  // that hold at the samples
};

}  // namespace cdot::derive
