// Confirms differences by numbers at random poses: central differences of C, applied impulses, both sides evaluated.
// The generated formulas are only measured, never used as the reference.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "derive/derivation/forms.hpp"
#include "derive/diff/poses.hpp"
#include "derive/expression/matrix.hpp"

namespace cdot::derive {

// One number per column of J.
using Motion = std::vector<double>;

// The change of C along a motion of the bodies and of time, by central differences. For a velocity row: its value at
// that motion minus its value at rest.
double rate_along(const Joint& joint, const ScalarRow& row, const Sample& sample, const Motion& motion, double time);

// An update of velocities or positions with an explicit impulse, or with an impulse of any size. Of the latter only the
// direction M^-1 J^T can be judged.
enum class UpdateLevel { velocities, positions, any_impulse };

// The change by an update, one expression per column of J: as generated and as published.
struct Change {
  std::vector<Expr> generated, published;
};

// Each sentence gives the errors of the generated and of the published value.
class Confirm {
 public:
  using Measure = std::function<double(const Sample&)>;

  // `form`: of J's columns.
  Confirm(const Joint& joint, int immovable, const Poses& poses, Form form)
      : joint_(joint), immovable_(immovable), poses_(poses), form_(form) {}

  // By central differences of C: a row of J, an entry of K, Cdot.
  Motion columns(const ScalarRow& row, const Sample& sample) const { return in_form(gradient(row, sample), sample); }
  double mass(const ScalarRow& row, const ScalarRow& other, const Sample& sample) const;
  double rate(const ScalarRow& row, const Sample& sample) const;
  std::string against(const Measure& measured, Expr generated, Expr published,
                      const std::string& how = "central differences of C") const;
  // `fulfilled`: poses with C = 0. The published C must vanish there, unless the row is a coordinate.
  std::string value_of_C(const ScalarRow& row, const Poses& fulfilled, Expr generated, Expr published) const;
  std::string claim(Expr left, Expr right) const;
  // Shows that some other reading of a formula without a value is right; `sign` is that of the row.
  std::string reading(const std::string& words, const ScalarRow& row, double sign, Expr read) const;

  // The distance of the rows of `smaller` from the row space of `larger`.
  std::string row_space(const Poses& poses, const Matrix& larger, const Matrix& smaller) const;

  // The error of the rows after a change; for an impulse of any size, its work along motions that the rows allow.
  std::string after(UpdateLevel level, const std::vector<ScalarRow>& rows, const Change& change) const;
  // While C rises by itself: the impulse of an equation pulls it back, that of an inequality does not act.
  std::string bound(const std::vector<ScalarRow>& rows, const std::vector<Expr>& lambda, bool inequality) const;

 private:
  // The largest errors over all poses.
  std::string worst(const std::string& how, const Poses& poses, const Measure& generated_error,
                    const Measure& published_error) const;
  // Of e, relative to the size of the measured value.
  Measure error(const Measure& measured, Expr e) const;
  double value(Expr e, const Sample& sample) const { return values_at({e}, sample)[0]; }
  Motion in_form(const Motion& gradient, const Sample& sample) const;
  Motion gradient(const ScalarRow& row, const Sample& sample) const;
  Motion velocity(const Sample& sample) const;
  Motion times_inverse_mass(const Sample& sample, const Motion& impulse) const;
  Motion times_mass(const Sample& sample, const Motion& change) const;
  double work(const std::vector<ScalarRow>& rows, const Motion& added, const Sample& sample) const;

  const Joint& joint_;
  int immovable_;
  const Poses& poses_;
  Form form_;
};

}  // namespace cdot::derive
