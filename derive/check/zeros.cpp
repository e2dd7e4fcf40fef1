// Newton's method moves poses with C = 0 to where something vanishes as well.
#include "derive/check/zeros.hpp"

#include <algorithm>
#include <cmath>

#include "derive/numbers/newton.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t most_zero_starts = 4;
constexpr double most_work_for_zeros = 1e7;          // evaluated nodes
constexpr double constant = 1e-9, near_zero = 1e-5;  // a double zero is reached slowly

bool contains(Expr e, Expr part) {
  const std::vector<Expr> parts = topological(std::span(&e, 1));
  return std::ranges::any_of(parts, [&](Expr p) { return p == part || p == -part; });
}

// True if e divides by something made of `zero`, or takes its direction: e may be undefined where that is 0.
bool may_break(Expr e, Expr zero) {
  return std::ranges::any_of(topological(std::span(&e, 1)), [&](Expr part) {
    if (part->kind == Kind::unit) return contains(part->args[0], zero);
    for (std::size_t i = 0; part->kind == Kind::product && i < part->args.size(); ++i)
      if (part->exponents[i] < 0 && contains(part->args[i], zero)) return true;
    return false;
  });
}

}  // namespace

Zeros::Zeros(const Subject& subject) : subject_(subject) {
  std::vector<std::vector<Expr>> J;
  for (const ScalarRow& row : subject.block.rows) {
    if (row.kind != RowKind::equality) continue;
    C_.push_back(row.C);
    J.push_back(columns_of(row.J));
  }
  // The defaults lie on the branch that the author means.
  const std::size_t all = subject.by_defaults > 0 ? subject.by_defaults : subject.on_constraint.size();
  if (all > 0) starts_.push_back(subject.usual);
  const auto first = subject.on_constraint.begin();
  starts_.insert(starts_.end(), first, first + static_cast<std::ptrdiff_t>(std::min(all, most_zero_starts)));
  Random random(1);
  for (std::size_t i = 0; i < starts_.size(); ++i) {
    Sample sample = subject.usual;
    for (Sample::Body& body : sample.bodies)
      for (std::size_t k = 0; k < (subject.joint.dimension == 2 ? 3u : 6u); ++k)
        body.move(subject.joint.dimension, k, random.between(-0.4, 0.4));
    if (C_.empty() || move_to_zero(subject.joint, C_, sample, J)) moved_.push_back(std::move(sample));
  }
}

Zero Zeros::of(const std::vector<Expr>& scalars, Expr divisor) {
  if (starts_.empty()) return {Reach::bodies, {}};
  if (is_constant(scalars)) return {};
  std::vector<Expr> equations = scalars;
  for (const Expr C : C_)
    if (!divisor || !may_break(C, divisor)) equations.push_back(C);
  for (const bool only_bodies : {true, false})
    for (const Sample& start : starts_) {
      if (work_ > most_work_for_zeros) return {Reach::bodies, {}};
      Sample sample = start;
      if (reaches(equations, sample, only_bodies)) return {only_bodies ? Reach::bodies : Reach::parameters, sample};
    }
  return {};
}

// True if no motion with C = 0 changes some of these from another number than 0, as dot(fa.x, fb.x) of a hinge.
bool Zeros::is_constant(const std::vector<Expr>& scalars) const {
  return std::ranges::any_of(scalars, [&](Expr e) {
    if (!depends_on_bodies(e) || moved_.empty()) return false;
    const double usual = values_at({e}, subject_.usual)[0];
    return std::abs(usual) > near_zero && std::ranges::all_of(moved_, [&](const Sample& sample) {
             return std::abs(values_at({e}, sample)[0] - usual) < constant;
           });
  });
}

bool Zeros::reaches(const std::vector<Expr>& equations, Sample& sample, bool only_bodies) {
  Numbers numbers(sample);
  const auto values = [&, work = static_cast<double>(topological(equations).size())](const Sample& at) {
    work_ += work;
    numbers.move_to(at);
    return numbers.of(equations);
  };
  const bool reached = move_to_zero(subject_.joint, values, sample, only_bodies);
  const auto in_range = [&](const Parameter& p) {
    const auto value = sample.scalars.find(p.name);
    return value == sample.scalars.end() ||
           (value->second > p.above - near_zero && value->second < p.below + near_zero);
  };
  const bool near = std::ranges::all_of(values(sample), [](double x) { return std::abs(x) < near_zero; });
  return (reached || near) && std::ranges::all_of(subject_.joint.parameters, in_range);
}

}  // namespace cdot::derive
