// Where formulas are undefined, and the kernel's result there: the guards of runtime/include/cdot/kernel.hpp in the
// spec's own names. A formula that is undefined wherever C = 0 is an error.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "derive/check/zeros.hpp"
#include "derive/expression/sign.hpp"
#include "derive/proof/words.hpp"

namespace cdot::derive {
namespace {

constexpr double vanishing = 1e-6;
constexpr std::size_t most_letters = 100;  // of the conditions in a note

enum class Guard { direction, divisor };

class Undefined {
 public:
  Undefined(const Subject& subject, Findings& findings, std::vector<PoseToDraw>* poses)
      : subject_(subject), findings_(findings), poses_(poses), zeros_(subject) {}

  void look_at(const Block& block) {
    for (const ScalarRow& row : block.rows) {
      name_ = row.name;
      where_ = row.row != nullptr ? row.row->where : place_of(block, subject_.joint);
      held_ = row.row != nullptr && row.kind != RowKind::velocity;
      guarded_.clear();
      value_ = row.row == nullptr ? row.C : Expr();
      const Expr roots[] = {row.C, row.Cdot, row.gamma};
      for (const Expr e : topological(roots)) look_at(e);
      for (const bool some : {false, true})
        for (const Guard guard : {Guard::direction, Guard::divisor}) tell(guard, some);
    }
  }

 private:
  // A zero of this row at which the kernel takes a value of its own.
  struct Guarded {
    Guard guard;
    std::string name;
    bool by_parameters;
  };

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
    guard(Guard::divisor, e);
  }

  void direction(Expr u) {
    if (!seen_.insert(&*u).second) return;
    if (vanishes_on_constraint(u)) {
      return add(Level::error,
                 name_ + ": J is undefined wherever C = 0: " + words(u) + " is zero there and has no direction",
                 "write `" + vanishing_vector(u, subject_.joint) + "`: a vector is zero by rows of its components");
    }
    guard(Guard::direction, u);
  }

  void guard(Guard guard, Expr e) {
    const Zero zero = zeros_.of(e);
    if (zero.reach == Reach::never) return;
    const std::string name = zero_text(e, subject_.joint);
    if (!names_.insert(name).second) return;
    guarded_.push_back({guard, name, zero.reach == Reach::parameters});
    if (depends_on_bodies(e))
      draw(zero, fmt::format("where {} = 0, in row {}, the kernel takes {}", name, name_, taken(guard, name)));
  }

  void draw(const Zero& zero, std::string caption) {
    constexpr std::size_t most = 6;
    if (poses_ != nullptr && zero.pose && poses_->size() < most)
      poses_->push_back({PoseToDraw::Why::guarded, std::move(caption), completed(*zero.pose, subject_.usual)});
  }

  std::string axis_taken() const { return subject_.joint.dimension == 2 ? "(1, 0)" : "(1, 0, 0)"; }
  std::string taken(Guard guard, const std::string& name) const {
    const bool is_name = name.find_first_of(" *(") == name.npos;
    if (guard == Guard::divisor) return is_name ? "0 for 1/" + name : "0 for 1 over it";
    return axis_taken() + " for its direction and 0 for 1/norm";
  }

  // One note for all zeros of a row that have one guard; by_parameters: those that no pose of the bodies reaches.
  void tell(Guard guard, bool by_parameters) {
    std::vector<std::string> names;
    for (const Guarded& g : guarded_)
      if (g.guard == guard && g.by_parameters == by_parameters) names.push_back(g.name);
    if (names.empty()) return;
    std::string which = names[0];
    std::size_t told = 1;
    while (told < names.size() && which.size() + names[told].size() < most_letters) which += ", " + names[told++];
    if (told < names.size()) which += fmt::format(" or one of {} others", names.size() - told);
    else if (told > 1) which.replace(which.size() - names.back().size() - 2, 2, " or ");
    add(Level::note,
        fmt::format("{}: where {} {}{} the kernel takes {}", name_, which, names.size() == 1 ? "= 0" : "is 0",
                    by_parameters ? ", which some parameters allow," : "",
                    taken(guard, names.size() == 1 ? names[0] : "one of them")));
  }

  void function(Expr e) {
    if (!seen_.insert(&*e).second) return;
    if (e->fn == Fn::atan2) {
      seen_.insert(&*(pow(e->args[0], 2) + pow(e->args[1], 2)));  // it vanishes where both arguments do
      return angle(e);
    }
    const std::string_view finding = function_of(e->fn).finding;
    const bool impossible = (e->fn == Fn::sqrt && is_never_negative(e->args[0])) ||
                            (e->fn == Fn::abs && zeros_.of(e->args[0]).reach == Reach::never);
    if (!finding.empty() && !impossible)
      add(Level::note, name_ + ": " + fmt::format(fmt::runtime(finding), words(e->args[0])));
  }

  void angle(Expr e) {
    const std::string own = words(e);
    const std::string name = e == value_ ? name_ : name_ + ": " + (own.starts_with("atan2(") ? "the angle " : "") + own;
    if (e->args[0]->kind == Kind::norm) {
      // Its axis has no direction at both ends.
      if (!seen_.insert(&*e->args[0]->args[0]).second) return;
      const Zero ends = zeros_.of(e->args[0]->args[0]);
      const std::string corner =
          name + " in [0, pi] has a corner at both ends; there the kernel takes " + axis_taken() + " for its axis";
      if (ends.reach != Reach::never) add(Level::note, corner);
      return draw(ends, fmt::format("at an end of [0, pi], in row {}, the kernel takes {} for the axis of the angle",
                                    name_, axis_taken()));
    }
    if (is_root(e->args[1])) return latitude(e, name);
    const std::optional<AngleBetween> between = angle_between(e);
    const bool defined = between && between->from->unit_length && between->to->unit_length;
    const Zero both = defined ? Zero{} : zeros_.of(e->args[0], e->args[1]);
    const std::string guarded = own.starts_with("atan2(") ? "where both arguments are 0" : "where it is undefined";
    add(Level::note,
        name + " jumps by 2 pi at pi" +
            (both.reach == Reach::never ? ""
                                        : fmt::format("; {} the kernel takes 0 for it and for its row of J", guarded)));
    draw(both, fmt::format("{} of the angle in row {} the kernel takes 0", guarded, name_));
  }

  // atan2(y, sqrt(...)) never jumps: it turns back at both ends, where its rate divides by the root.
  void latitude(Expr e, const std::string& name) {
    seen_.insert(&*e->args[1]);
    const Zero ends = zeros_.of(e->args[1]->args[0]);
    if (ends.reach == Reach::never) return;
    add(Level::note, name + " in [-pi/2, pi/2] has a corner at both ends; there the kernel takes 0 for its row of J");
    draw(ends, fmt::format("at an end of [-pi/2, pi/2], in row {}, the kernel takes 0 for the row of J", name_));
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
  std::vector<PoseToDraw>* poses_;
  Zeros zeros_;
  std::set<const Node*> seen_;  // looked up only
  std::set<std::string> names_;
  std::vector<Guarded> guarded_;
  std::string name_;
  Expr value_;
  Span where_;
  bool held_ = false;
};

}  // namespace

void check_undefined(const Subject& subject, Findings& findings, std::vector<PoseToDraw>* poses) {
  Undefined undefined(subject, findings, poses);
  undefined.look_at(subject.block);
  for (const Block& coordinate : subject.coordinates) undefined.look_at(coordinate);
}

}  // namespace cdot::derive
