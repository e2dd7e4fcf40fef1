// Defaults are taken from the initial pose, where C must be 0. Told are a number measured from the pose that leaves
// C != 0, and points and directions that leave the same C at every pose.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "derive/check/parts.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr double negligible_residual = 1e-9;  // of quantities near 1

class Defaults {
 public:
  Defaults(const Subject& subject, Findings& findings) : joint_(subject.joint), findings_(findings) {
    for (const Parameter& p : joint_.parameters) {
      if (!p.default_value) continue;
      const Expr value = at_start(p.default_value);
      if (p.kind == ParameterKind::point && p.body >= 0) {
        put(p.symbol, value - body_symbols(joint_, p.body).x);
      } else if (p.axes.empty()) {
        put(p.symbol, value);
      }
      for (std::size_t k = 0; k < p.axes.size(); ++k) put(p.axes[k], at_start(p.default_axes[k]));
    }
  }

  void look_at(const Row& row) {
    const Expr C = at_start(row.C);
    if (row.kind == RowKind::velocity || C == row.C || is_zero(C) || waits_for_a_number(C)) return;
    const std::vector<double> residuals = residuals_of(C, row.kind);
    if (std::ranges::all_of(residuals, [](double x) { return std::fabs(x) < negligible_residual; })) return;
    const Parameter* measured = measured_number(row.C);
    const auto [least, largest] = std::ranges::minmax(residuals);
    if (measured) tell(row, *measured, largest);
    else if (least > 0 && largest - least < negligible_residual * largest)
      add(row, fmt::format("with the defaults |C| is {:.3g} at every initial pose", largest),
          "choose defaults with C = 0");
  }

 private:
  void put(Expr leaf, Expr value) { start_.emplace(&*leaf, value); }
  Expr at_start(Expr e) const { return substitute(e, start_, KeepNames::no); }

  // A scene gives the numbers without a default, and may satisfy the row by them.
  bool waits_for_a_number(Expr C) const {
    return std::ranges::any_of(leaves_of(std::span(&C, 1)), [](Expr leaf) { return leaf->role == Role::parameter; });
  }

  // |C| at random poses; 0 where an inequality holds.
  std::vector<double> residuals_of(Expr C, RowKind kind) const {
    std::vector<double> residuals;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const Sample sample = random_sample(joint_, std::span(&C, 1), seed);
      Numbers numbers(sample);
      const Triple<double> value = C->vector ? numbers.vector(C) : Triple<double>{numbers.scalar(C)};
      const bool holds = kind == RowKind::inequality && value[0] >= 0;
      residuals.push_back(holds ? 0 : std::hypot(value[0], value[1], value[2]));
    }
    return residuals;
  }

  // A number in C whose default depends on the pose.
  const Parameter* measured_number(Expr C) const {
    for (const Expr leaf : leaves_of(std::span(&C, 1))) {
      for (const Parameter& p : joint_.parameters) {
        if (p.symbol == leaf && p.kind == ParameterKind::scalar && p.default_value &&
            depends_on_bodies(p.default_value))
          return &p;
      }
    }
    return nullptr;
  }

  void tell(const Row& row, const Parameter& p, double residual) {
    const std::optional<std::string> right = solved_for(p, row.C);
    add(row,
        fmt::format("with the default of `{}` the row does not hold at the start: |C| is {:.3g} at a random pose",
                    p.name, residual),
        right ? fmt::format("make `{}` its default", *right) : "choose a default with C = 0");
  }

  // The value of p with C = 0, if C is a number times p and a rest.
  std::optional<std::string> solved_for(const Parameter& p, Expr C) const {
    const std::vector<Term> terms = terms_of(C);
    const auto own = std::ranges::find_if(terms, [&](const Term& t) { return t.e == p.symbol; });
    if (own == terms.end()) return std::nullopt;
    const Expr rest = C - own->coef * p.symbol;
    const std::vector<Expr> leaves = leaves_of(std::span(&rest, 1));
    if (std::ranges::find(leaves, p.symbol) != leaves.end()) return std::nullopt;
    return spec_text(Rational(-1) / own->coef * rest, joint_);
  }

  void add(const Row& row, std::string message, std::string fix) {
    findings_.add(Level::warning, "default", row.where, row.name + ": " + std::move(message), std::move(fix));
  }

  const Joint& joint_;
  Findings& findings_;
  std::map<const Node*, Expr> start_;
};

}  // namespace

void check_defaults(const Subject& subject, Findings& findings) {
  Defaults defaults(subject, findings);
  for (const Row& row : subject.joint.rows) defaults.look_at(row);
}

}  // namespace cdot::derive
