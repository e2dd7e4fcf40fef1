// Random poses at which formulas are compared, with assumptions fulfilled, and finite differences of C there.
#pragma once

#include <functional>
#include <optional>

#include "derive/derivation.hpp"
#include "derive/numeric.hpp"

namespace cdot::derive {

class Poses {
 public:
  // `expressions`: everything that will be evaluated; `positive`: scalars that keep their sign (lengths, `free` names).
  Poses(const Joint& joint, std::vector<Expr> expressions);

  // The same poses moved to where all equations are zero; no poses if that is not possible.
  Poses where(const std::vector<Expr>& equations) const;

  Poses first(std::size_t count) const;
  bool empty() const { return samples_.empty(); }
  // |a - b| is round-off at every pose.
  bool equal(Expr a, Expr b) const;
  // The constant k with a = k b at every pose, if there is one.
  std::optional<double> constant_ratio(Expr a, Expr b) const;

  // How far `published` and `derived` are from `measured` at worst, relative to their size.
  struct Errors {
    double derived = 0, published = 0;
    int poses = 0;
  };
  using Measure = std::function<double(const Sample&)>;
  Errors against(const Measure& measured, Expr derived, Expr published) const;

 private:
  bool satisfy(const std::vector<Expr>& equations, Sample& sample) const;

  const Joint* joint_;
  std::vector<Sample> samples_;
};

// dC/dq by central differences: one number per x, y, angle of each body.
std::vector<double> measured_row(const Joint& joint, Expr C, const Sample& sample);

}  // namespace cdot::derive
