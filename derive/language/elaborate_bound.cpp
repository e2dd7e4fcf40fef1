// Rows with bounds in the law of an effect: ends of a coordinate, and a rate that a bounded force prescribes.
#include <algorithm>

#include "derive/expression/functions.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {
namespace {

// Radians count as numbers: a torque is in N m, or in N m/rad.
Unit without_angle(Unit u) {
  u.rad = 0;
  return u;
}

}  // namespace

// A number in a bounded row. It may read parameters, and what else `also` has.
Expr Elaborator::bound_value(Source& source, const Ast& ast, const Unit& unit, const std::vector<Expr>& also) {
  Diagnostics& d = source.diagnostics;
  in_law_ = true;
  const Value v = evaluate(source, ast);
  in_law_ = false;
  if (v.type == Type::poison || !v.e) return {};
  if (v.type != Type::scalar) {
    d.error(ast.where, "a bound is a number, not " + std::string(in_words(v.type)));
    return {};
  }
  if (v.unit && !v.zero && without_angle(*v.unit) != without_angle(unit)) {
    d.error(ast.where,
            "this is " + (*v.unit == Unit{} ? "" : std::string("in ")) + spoken(*v.unit) + ", not in " + spoken(unit),
            *v.unit == Unit{} && v.e->kind == Kind::number ? "give the number its unit, as in 2 [N] or 2 [N*m]" : "");
    return {};
  }
  const auto known = [&](Expr leaf) {
    return leaf->role == Role::parameter || leaf->role == Role::constant || (in_bound_ && leaf == in_bound_->load) ||
           std::ranges::find(also, leaf) != also.end();
  };
  if (std::ranges::all_of(leaves_of(std::span<const Expr>(&v.e, 1)), known)) return v.e;
  if (also.empty())
    d.error(ast.where, "an end of a coordinate depends on parameters alone",
            "move the rest into the coordinate, and bound that by 0");
  else
    d.error(ast.where,
            in_bound_ ? "a bound of a force depends on parameters, time, its own coordinate and one load alone"
                      : "a prescribed rate depends on parameters and time alone",
            "write a law of rates or of other coordinates as a force: force on NAME = ...");
  return {};
}

// Of limits that nothing fits between, whatever the parameters are within their ranges.
bool Elaborator::are_limits(Source& source, const Ast& where, Expr lower, Expr upper) {
  if (!lower || !upper) return true;
  const Term gap = split_coefficient(lower - upper);
  const auto parameter = std::ranges::find(joint_.parameters, gap.e, &Parameter::symbol);
  const bool positive = gap.e->kind == Kind::number
                            ? (gap.coef * gap.e->value).sign() > 0
                            : gap.coef.sign() > 0 && parameter != joint_.parameters.end() && parameter->above >= 0;
  if (positive)
    source.diagnostics.error(where.where, "no number lies within these limits", "put the smaller one first");
  return !positive;
}

// `left >= right` as (right - left) / (|left| + |right|).
bool Elaborator::event(Source& source, const ConditionAst& condition, BoundedRow& row, Expr& distance) {
  Diagnostics& d = source.diagnostics;
  in_bound_ = &row;
  in_law_ = in_event_ = true;
  const Value left = evaluate(source, condition.left), right = evaluate(source, condition.right);
  in_bound_ = nullptr;
  in_law_ = in_event_ = false;
  if (left.type == Type::poison || right.type == Type::poison) return false;
  const auto known = [&](Expr leaf) {
    return leaf->role == Role::parameter || leaf->role == Role::constant || leaf->role == Role::time ||
           leaf == row.value || leaf == row.own_rate || leaf == row.own_load;
  };
  for (const auto& [value, ast] : {std::pair(&left, &condition.left), std::pair(&right, &condition.right)}) {
    if (value->type != Type::scalar) {
      d.error(ast->where, "a condition compares numbers, not " + std::string(in_words(value->type)));
      return false;
    }
    if (std::ranges::all_of(leaves_of(std::span<const Expr>(&value->e, 1)), known)) continue;
    d.error(ast->where,
            joint_.law->on_joint
                ? "the event that breaks a joint depends on parameters, time and its load alone"
                : "an event depends on parameters, time, the coordinate of its row, its rate and its load alone",
            "load(" + row.name + ") is the size of the force of the row");
    return false;
  }
  if (!left.zero && !right.zero && !same_unit(left, right, true)) {
    d.error(condition.right.where, "this is in " + spoken(*right.unit) + ", not in " + spoken(*left.unit), "",
            {condition.left.where});
    return false;
  }
  const Expr gap = condition.at_least ? right.e - left.e : left.e - right.e;
  const Expr sides[] = {left.e, right.e};
  distance = gap * pow(call(Fn::abs, std::span(sides, 1)) + call(Fn::abs, std::span(sides + 1, 1)), -1);
  return true;
}

bool Elaborator::events(Source& source, const StatementAst& s, BoundedRow& row) {
  if (!joint_.law->on_joint) row.own_rate = law_rates_.at(row.coordinate).e;
  const bool after = !s.after || event(source, *s.after, row, row.after);
  const bool until = !s.until || event(source, *s.until, row, row.until);
  return after && until;
}

// The coordinate that a row bounds, as a row block of its own. Null after an error.
const Coordinate* Elaborator::bounded_coordinate(Source& source, const Word& name) {
  const auto declared = bounded_candidates_.find(name.text);
  if (declared == bounded_candidates_.end()) {
    const auto entered = names_.find(name.text);
    if (entered != names_.end() && entered->second.value.type == Type::poison) return nullptr;  // reported there
    source.diagnostics.error(name.where, quote(name.text) + " is no coordinate of this effect",
                             "declare it before: coordinate " + name.text + (of_coordinate_ ? " [any]" : " [m] = ..."));
    return nullptr;
  }
  names_.at(name.text).used = true;
  if (of_coordinate_) return &declared->second;
  auto& all = joint_.coordinates;
  const auto known = std::ranges::find(all, name.text, &Coordinate::name);
  if (known != all.end()) return &*known;
  all.push_back(declared->second);
  return &all.back();
}

// True if the generated kernel has something else of that name.
bool Elaborator::names_in_kernel(const std::string& name) const {
  return std::ranges::find(joint_.law->bounded, name, &BoundedRow::name) != joint_.law->bounded.end() ||
         bounded_candidates_.contains(name) || is_word_of_cpp(name) || is_member_of_kernels(name) ||
         name == joint_.name;
}

bool Elaborator::may_name_row(Source& source, const Word& label) {
  const bool taken = names_in_kernel(label.text);
  if (taken)
    source.diagnostics.error(label.where, quote(label.text) + " is already a name of the generated kernel",
                             "choose another name");
  return !taken;
}

// The row without its numbers: its name, or after a label with several rates the label and the coordinate. Nothing
// after an error.
std::optional<BoundedRow> Elaborator::bounded_row(Source& source, const StatementAst& s, const Word& coordinate) {
  if (!bounded_coordinate(source, coordinate)) return {};
  const auto value = law_values_.find(coordinate.text);
  if (!s.of_rate && value == law_values_.end()) {
    source.diagnostics.error(coordinate.where, quote(coordinate.text) + " has a rate, but no value and no ends",
                             "write rate(" + coordinate.text + ") = ..., force in [-most, most]");
    return {};
  }
  const bool is_named = !s.label.text.empty();
  BoundedRow row{!is_named          ? coordinate.text + (s.of_rate ? "_rate" : "_ends")
                 : s.across.empty() ? s.label.text
                                    : s.label.text + "_" + coordinate.text,
                 coordinate.text,
                 s.of_rate,
                 {},
                 {},
                 {},
                 value == law_values_.end() ? Expr() : value->second.e,
                 in_spec(source, s.where),
                 written(source, s)};
  if (is_named && !may_name_row(source, s.label)) return {};
  while (names_in_kernel(row.name)) row.name += '_';
  return row;
}

// The bounds, the rate and the events of one row. True if there was no error.
bool Elaborator::numbers_of_bound(Source& source, const StatementAst& s, const Ast& rate, BoundedRow& row) {
  const auto number = [&](const std::optional<Ast>& ast, Expr& to, const Unit& of, const std::vector<Expr>& also) {
    if (ast) to = bound_value(source, *ast, of, also);
    return !ast || to;
  };
  const Expr time = time_symbol(*pool_);
  const Unit unit = bounded_candidates_.at(row.coordinate).unit, joule{.m = 2, .s = -2, .kg = 1};
  const Unit of_bounds = s.of_rate ? joule / unit : unit;
  std::vector<Expr> also;
  if (s.of_rate) also.push_back(time);
  if (s.of_rate && row.value && s.across.empty()) also.push_back(row.value);
  in_bound_ = s.of_rate ? &row : nullptr;
  bool right = number(s.lower, row.lower, of_bounds, also);
  right &= number(s.upper, row.upper, of_bounds, also);
  in_bound_ = nullptr;
  if (!s.across.empty() && row.upper) row.lower = -row.upper;
  const std::optional<Ast>& where = s.lower ? s.lower : s.upper;
  right = right && (!where || are_limits(source, *where, row.lower, row.upper));
  if (s.of_rate) right &= number(rate, row.rate, unit / Unit{.s = 1}, {time});
  return right & events(source, s, row);
}

// NAME ":" "joint" "," "until" condition
void Elaborator::row_of_joint(Source& source, const StatementAst& s) {
  Diagnostics& d = source.diagnostics;
  if (!joint_.law->on_joint)
    return d.error(s.relation_where, "only an effect on a joint may break it",
                   "write `effect " + joint_.name + " joint`");
  if (!joint_.law->bounded.empty())
    return d.error(s.relation_where, "an effect breaks its joint by one event", "write a second effect",
                   {joint_.law->bounded.front().where});
  if (s.label.text.empty())
    return d.error(s.relation_where, "the rows of the joint have no name here", "write bond: joint, until ...");
  if (s.after)
    return d.error(s.after->where, "a joint acts from the start, it does not wait for an event", "write until ...");
  if (!may_name_row(source, s.label)) return;
  BoundedRow row{s.label.text, "joint", false, {}, {}, {}, {}, in_spec(source, s.where), written(source, s)};
  if (!events(source, s, row)) return;
  joint_.uses_time |= depends_on_role(row.until, Role::time);
  joint_.law->bounded.push_back(std::move(row));
}

// [ NAME ":" ] ( NAME ( ( ">=" | "<=" ) expression | "in" range ) | "rate" "(" NAME ")" "=" expression ... )
void Elaborator::bound(Source& source, const StatementAst& s) {
  if (s.of_joint) return row_of_joint(source, s);
  const int rows = s.across.empty() ? 0 : static_cast<int>(s.across.size()) + 1;
  int place = 0;
  const auto add = [&](const Word& coordinate, const Ast& rate) {
    std::optional<BoundedRow> row = bounded_row(source, s, coordinate);
    if (!row) return;
    row->cone_row = place++, row->cone_rows = rows;
    if (!numbers_of_bound(source, s, rate, *row)) return;
    for (const Expr e : {row->lower, row->upper, row->rate, row->after, row->until})
      joint_.uses_time |= e && depends_on_role(e, Role::time);
    joint_.law->bounded.push_back(std::move(*row));
  };
  add(s.bounded, s.left);
  for (const RateAst& other : s.across) add(other.coordinate, other.value);
}

// Coordinates that only bounded rows read are no inputs of the forces.
void Elaborator::drop_idle_inputs() {
  EffectLaw& law = *joint_.law;
  std::vector<Expr> read;
  if (law.energy) read.push_back(law.energy);
  for (const LawInput& input : law.inputs)
    if (input.force) read.push_back(input.force);
  const std::vector<Expr> leaves = leaves_of(read);
  const auto reads = [&](Expr leaf) { return std::ranges::find(leaves, leaf) != leaves.end(); };
  for (std::size_t i = law.inputs.size(); i-- > 0;) {
    const LawInput& input = law.inputs[i];
    const bool bounded = std::ranges::find(law.bounded, input.name, &BoundedRow::coordinate) != law.bounded.end();
    if (!bounded || input.force || reads(input.value) || reads(input.rate)) continue;
    law.inputs.erase(law.inputs.begin() + static_cast<std::ptrdiff_t>(i));
    if (!of_coordinate_) joint_.rows.erase(joint_.rows.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

}  // namespace cdot::derive
