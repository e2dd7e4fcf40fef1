// Where formulas are undefined, and the kernel's result there: the guards of runtime/include/cdot/kernel.hpp in the
// spec's own names. A formula that is undefined wherever C = 0 is an error.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "derive/check/parts.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr double vanishing = 1e-6;

class Undefined {
 public:
  Undefined(const Subject& subject, Findings& findings) : subject_(subject), findings_(findings) {}

  void look_at(const Block& block) {
    for (const ScalarRow& row : block.rows) {
      name_ = row.name;
      where_ = row.row != nullptr ? row.row->where : place_of(block, subject_.joint);
      held_ = row.row != nullptr && row.kind != RowKind::velocity;
      const Expr roots[] = {row.C, row.Cdot, row.gamma};
      for (const Expr e : topological(roots)) look_at(e);
    }
  }

 private:
  std::string words(Expr e) const { return brief_spec_text(e, subject_.joint); }

  void look_at(Expr e) {
    if (e->kind == Kind::unit) return direction(e->args[0]);
    if (e->kind == Kind::product) {
      for (std::size_t i = 0; i < e->args.size(); ++i) {
        if (e->exponents[i] < 0) divisor(e->args[i]);
      }
    }
    if (e->kind == Kind::function) function(e);
  }

  // A length stands for its vector: |u|, u . u and the direction of u are one place.
  void divisor(Expr e) {
    if (e->kind == Kind::norm) return direction(e->args[0]);
    if (e->kind == Kind::dot && e->args[0] == e->args[1]) return direction(e->args[0]);
    if (!seen_.insert(&*e).second) return;
    if (vanishes_on_constraint(e)) {
      return add(Level::error, name_ + ": it divides by " + words(e) + ", which is 0 wherever C = 0",
                 "write the row without the division");
    }
    add(Level::note, name_ + ": where " + words(e) + " = 0 the kernel takes 0 for 1/(" + words(e) + ")");
  }

  void direction(Expr u) {
    if (!seen_.insert(&*u).second) return;
    const std::string name = words(u);
    if (vanishes_on_constraint(u)) {
      return add(Level::error,
                 name_ + ": J is undefined wherever C = 0: " + name + " is zero there and has no direction",
                 "write `" + vanishing_vector(u, subject_.joint) + "`: a vector is zero by rows of its components");
    }
    add(Level::note, name_ + ": where " + name + " is zero it has no direction: the kernel takes " +
                         (subject_.joint.dimension == 2 ? "(1, 0)" : "(1, 0, 0)") + " for unit(" + name +
                         ") and 0 for 1/norm(" + name + ")");
  }

  void function(Expr e) {
    if (!seen_.insert(&*e).second) return;
    const std::string x = words(e->args[0]);
    if (e->fn == Fn::atan2) {
      seen_.insert(&*(pow(e->args[0], 2) + pow(e->args[1], 2)));  // it vanishes where both arguments do
      return angle(e);
    }
    const std::string_view finding = function_of(e->fn).finding;
    if (!finding.empty()) add(Level::note, name_ + ": " + fmt::format(fmt::runtime(finding), x));
  }

  void angle(Expr e) {
    const std::string own = words(e);
    const std::string name = name_ + ": " + (own.starts_with("atan2(") ? "the angle " : "") + own;
    if (e->args[0]->kind == Kind::norm) return add(Level::note, name + " in [0, pi] has a corner at both ends");
    const std::optional<AngleBetween> between = angle_between(e);
    const bool defined = between && between->from->unit_length && between->to->unit_length;
    add(Level::note,
        name + " jumps by 2 pi at pi" +
            (defined                     ? ""
             : own.starts_with("atan2(") ? ", and where both arguments are 0 the kernel takes 0, also for its row of J"
                                         : ", and where it is undefined the kernel takes 0, also for its row of J"));
  }

  // Tested at every pose with C = 0 that was found.
  bool vanishes_on_constraint(Expr e) const {
    if (!held_ || subject_.on_constraint.empty()) return false;
    return std::all_of(subject_.on_constraint.begin(), subject_.on_constraint.end(), [&](const Sample& sample) {
      Numbers numbers(sample);
      if (!e->vector) return std::fabs(numbers.scalar(e)) < vanishing;
      const Triple<double> u = numbers.vector(e);
      return std::hypot(u[0], u[1], u[2]) < vanishing;
    });
  }

  void add(Level level, std::string message, std::string fix = {}) {
    findings_.add(level, "undefined", where_, std::move(message), std::move(fix));
  }

  const Subject& subject_;
  Findings& findings_;
  std::set<const Node*> seen_;  // looked up only
  std::string name_;
  Span where_;
  bool held_ = false;
};

}  // namespace

void check_undefined(const Subject& subject, Findings& findings) {
  Undefined undefined(subject, findings);
  undefined.look_at(subject.block);
  for (const Block& coordinate : subject.coordinates) undefined.look_at(coordinate);
}

}  // namespace cdot::derive
