// Where K is regular, proved. By Cauchy-Binet, det K is a sum over choices of columns of J: (minor of J)^2 times the
// inverse masses of the columns. No term is negative, so K is regular where the terms of one product of inverse masses
// are a sum of squares that cannot vanish.
#include "derive/check/mass.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "derive/check/parts.hpp"

namespace cdot::derive {
namespace {

// Beyond this number of minors, algebra is too expensive.
constexpr double most_minors = 250;

class SquaresOfMinors {
 public:
  explicit SquaresOfMinors(const Subject& subject)
      : joint_(subject.joint), width_(columns_per_body(joint_.dimension)), names_(joint_, Algebra::Route::names) {
    if (number_of_choices(width_ * joint_.bodies.size(), subject.block.rows.size()) > most_minors) return;
    std::vector<std::vector<ex>> J;
    for (const ScalarRow& row : subject.block.rows) {
      names_.shorten(row.kind == RowKind::velocity ? row.Cdot : row.C);
      J.emplace_back();
      for (const Expr entry : columns_of(row.J)) J.back().push_back(names_.of(entry));
    }
    rows_ = J.size();
    Minors minors(std::move(J));
    choose(minors, 0);
  }

  // The products of inverse masses whose terms cannot all vanish.
  std::vector<Movement> that_never_vanish() {
    std::vector<Movement> sure;
    for (const auto& [movement, sum] : sums_) {
      if (!sum.is_zero() && never_zero(sum)) sure.push_back(movement);
    }
    return sure;
  }

 private:
  void choose(Minors& minors, std::size_t from) {
    if (columns_.size() == rows_) return add_minor(minors);
    for (std::size_t c = from; c < width_ * joint_.bodies.size(); ++c) {
      columns_.push_back(c);
      choose(minors, c + 1);
      columns_.pop_back();
    }
  }

  void add_minor(Minors& minors) {
    const ex minor = minors.of(columns_);
    if (minor.is_zero()) return;
    Movement movement(2 * joint_.bodies.size());
    for (const std::size_t c : columns_)
      ++movement[2 * (c / width_) + (c % width_ >= static_cast<std::size_t>(joint_.dimension) ? 1 : 0)];
    sums_[movement] += minor * minor;
  }

  bool never_zero(const ex& sum) {
    const std::optional<ex> numerator = names_.numerator(sum, true);
    const auto positive = [&](const ex& p) { return is_positive(p, names_.symbols_in(p)); };
    return numerator && (positive(*numerator) || positive(names_.other_coordinates(*numerator)));
  }

  const Joint& joint_;
  // Inertia counts as a number in space, too: a positive definite tensor changes no rank.
  std::size_t width_;
  Algebra names_;
  std::size_t rows_ = 0;
  std::vector<std::size_t> columns_;
  std::map<Movement, ex> sums_;
};

}  // namespace

std::vector<Movement> proved_regular(const Subject& subject) try {
  return SquaresOfMinors(subject).that_never_vanish();
} catch (const GiNaC::pole_error&) {
  return {};
}

}  // namespace cdot::derive
