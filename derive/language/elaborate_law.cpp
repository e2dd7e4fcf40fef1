// The law of an effect: an energy, forces and torques as functions of coordinates, their rates, parameters and time.
//
// All that a law reads of the bodies are its inputs: declared coordinates, points, and the angles, centres and
// velocities of bodies. Each input is a row of the joint behind the effect, so J, gamma and the geometric stiffness of
// an effect are derived and proved as those of constraints are. In the law itself the inputs are leaves.
#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {
namespace {

const Unit joule{.m = 2, .s = -2, .kg = 1};

Unit without_radians(Unit u) {
  u.rad = 0;
  return u;
}

// Radians count as numbers: a torque is in N m, or in N m/rad.
bool fits(const Value& v, const Unit& unit) {
  return !v.unit || v.zero || without_radians(*v.unit) == without_radians(unit);
}

}  // namespace

// The input of a row with this text, if the law has one.
LawInput* Elaborator::input_of(const std::string& text) {
  const auto row = std::ranges::find(joint_.rows, text, &Row::text);
  return row == joint_.rows.end() ? nullptr : &joint_.law->inputs[static_cast<std::size_t>(row - joint_.rows.begin())];
}

// A leaf that nobody else has: a parameter may be called length_rate.
Expr Elaborator::leaf_of_input(std::string name, bool vector_input) {
  const auto taken = [&](const std::string& symbol) {
    const auto known = [&](const std::string& ending) { return static_cast<bool>(pool_->find(symbol + ending)); };
    return known("") || known("_x") || known("_y") || known("_z");
  };
  while (taken(name)) name += '_';
  return vector_input ? pool_->vector_symbol(name, Role::given) : pool_->symbol(name, Role::given);
}

LawInput& Elaborator::add_input(std::string name, Row row, bool has_value) {
  const auto is_taken = [&](const LawInput& other) { return other.name == name; };
  while (std::ranges::any_of(joint_.law->inputs, is_taken)) name += '_';
  const bool vector_input = row.C->vector;
  LawInput input{name,
                 has_value ? leaf_of_input(name, vector_input) : Expr(),
                 leaf_of_input(name + "_rate", vector_input),
                 row.unit,
                 {}};
  Value value = scalar(input.value, row.unit), rate = scalar(input.rate, row.unit / Unit{.s = 1});
  if (vector_input) value.type = rate.type = Type::vector;
  if (has_value) law_values_.emplace(name, value);
  law_rates_.emplace(name, rate);
  row.name = name;
  if (!of_coordinate_) joint_.rows.push_back(std::move(row));
  joint_.law->inputs.push_back(input);
  return joint_.law->inputs.back();
}

// coordinate NAME [unit] = [ velocity ] expression. With a rate alone, expressions may not read its value.
void Elaborator::coordinate_of_effect(Source& source, const StatementAst& s, const Value& value, Unit unit) {
  const DeclaredAst& d = s.declared;
  if (!name_is_free(source, d.name, d.name.text)) return;
  if (value.type == Type::poison) return enter(source, d.name.text, "coordinate", value, d.name.where);
  Row row;
  row.kind = s.velocity ? RowKind::velocity : RowKind::equality;
  row.C = value.e;
  row.unit = unit;
  row.where = in_spec(source, d.name.where);
  row.text = d.name.text + " = " + written(source, s);
  row.of_world = of_world_;
  joint_.uses_time |= depends_on_role(value.e, Role::time);
  bounded_candidates_.emplace(d.name.text, Coordinate{d.name.text,
                                                      value.e,
                                                      unit,
                                                      in_spec(source, d.name.where),
                                                      written(source, s),
                                                      "",
                                                      {},
                                                      of_world_,
                                                      s.velocity});
  add_input(d.name.text, std::move(row), !s.velocity);
  if (s.velocity) enter(source, d.name.text, "rate", law_rates_.at(d.name.text), d.name.where);
  else enter(source, d.name.text, "coordinate", law_values_.at(d.name.text), d.name.where);
}

// A point that a law names: its place, with a row for each of its components.
LawInput& Elaborator::point_input(const std::string& name, const Value& point, Span where) {
  if (LawInput* const known = input_of(name)) return *known;
  Row row;
  row.C = point.e;
  row.unit = Unit{.m = 1};
  row.where = where;
  row.text = name;
  row.of_world = true;  // the world's axes see it
  LawInput& input = add_input(name, std::move(row), true);
  law_values_.at(name).type = Type::point;
  return input;
}

// The angle of a body, or the place of its centre. A turn in space has a rate but no value.
LawInput& Elaborator::body_input(int body, bool turns, Span where) {
  const std::string name = (turns ? "angle_" : "centre_") + body_name(body);
  const bool of_rate = turns && joint_.dimension == 3;
  const std::string text = (turns ? of_rate ? "w(" : "angle(" : "x(") + body_name(body) + ")";
  if (LawInput* const known = input_of(text)) return *known;
  Row row;
  row.kind = of_rate ? RowKind::velocity : RowKind::equality;
  row.C = of_rate ? body_spin(*pool_, body) : turns ? body_angle(*pool_, body) : body_position(*pool_, body);
  row.unit = turns ? Unit{.rad = 1} : Unit{.m = 1};
  row.where = where;
  row.text = text;
  row.of_world = true;
  bodies_.emplace(body, where);
  return add_input(name, std::move(row), !of_rate);
}

// A direction or arm that turns with its body: its components along the world's axes are rows that only read.
LawInput& Elaborator::turning_input(Expr leaf, Span where) {
  if (LawInput* const known = input_of(leaf->symbol)) return *known;
  const auto parameter = std::find_if(joint_.parameters.begin(), joint_.parameters.end(),
                                      [&](const Parameter& p) { return p.symbol == leaf; });
  Row row;
  row.C = leaf;
  row.unit = parameter == joint_.parameters.end() ? Unit{} : parameter->unit;
  row.where = where;
  row.text = leaf->symbol;
  row.of_world = true;
  bodies_.emplace(leaf->body, where);
  return add_input(leaf->symbol + "_world", std::move(row), true);
}

// e with the leaves of bodies replaced by those of inputs.
Expr Elaborator::read_by_inputs(const StatementAst& s, Expr e) {
  std::map<const Node*, Expr> replaced;
  for (const Expr leaf : leaves_of(std::span<const Expr>(&e, 1))) {
    const bool rate = leaf->role == Role::velocity || leaf->role == Role::spin;
    if (rate || leaf->role == Role::angle || leaf->role == Role::position) {
      const LawInput& input = body_input(leaf->body, leaf->role == Role::spin || leaf->role == Role::angle, s.where);
      replaced.emplace(&*leaf, rate ? input.rate : input.value);
    } else if (leaf->role == Role::body_vector) {
      replaced.emplace(&*leaf, turning_input(leaf, s.where).value);
    }
  }
  return substitute(e, replaced);
}

Value Elaborator::law_value(Source& source, const StatementAst& s) {
  in_law_ = true;
  Value v = evaluate(source, s.left);
  in_law_ = false;
  if (v.type == Type::poison) return {};
  if (v.type != Type::scalar && v.type != Type::vector) {
    source.diagnostics.error(s.left.where, "a force is a number or a vector, not " + std::string(in_words(v.type)));
    return {};
  }
  if (!v.e) return {};
  v.e = read_by_inputs(s, v.e);
  joint_.uses_time |= depends_on_role(v.e, Role::time);
  return v;
}

void Elaborator::energy(Source& source, const StatementAst& s) {
  const Value v = law_value(source, s);
  if (v.type == Type::poison) return;
  Diagnostics& d = source.diagnostics;
  if (v.type != Type::scalar) return d.error(s.left.where, "an energy is a number, not a vector");
  if (!fits(v, joule)) return d.error(s.left.where, "an energy is in J, not in " + spoken(*v.unit));
  for (const LawInput& input : joint_.law->inputs) {
    const std::vector<Expr> leaves = leaves_of(std::span<const Expr>(&v.e, 1));
    if (std::find(leaves.begin(), leaves.end(), input.rate) != leaves.end())
      return d.error(s.left.where, "an energy depends on positions, not on the rate of " + quote(input.name),
                     "write a force: force on " + input.name + " = ...");
  }
  if (depends_on_role(v.e, Role::time))
    return d.error(s.left.where, "an energy that depends on time does work by itself", "write a force in its place");
  joint_.law->energy = joint_.law->energy ? joint_.law->energy + v.e : v.e;
}

// ( "force" on NAME | "torque" on BODY ) "=" expression
void Elaborator::force(Source& source, const StatementAst& s) {
  Diagnostics& d = source.diagnostics;
  const std::string& on = s.label.text;
  SourceNames names(*this, source);
  const int body = names.body(on);
  std::string name = on;
  if (s.torque) {
    if (body < 0)
      return d.error(s.label.where, "a torque acts on a body, not on " + quote(on),
                     "write torque on a = ..., or force on " + on + " = ...");
    name = body_input(body, true, in_spec(source, s.where)).name;
  } else if (body >= 0) {
    name = body_input(body, false, in_spec(source, s.where)).name;
  } else {
    in_law_ = true;
    names.find(on);
    in_law_ = false;
  }
  const auto found = std::ranges::find(joint_.law->inputs, name, &LawInput::name);
  const auto at = static_cast<std::size_t>(found - joint_.law->inputs.begin());  // law_value() may add inputs
  if (found == joint_.law->inputs.end())
    return d.error(s.label.where, quote(on) + " is neither a coordinate of this effect nor a point of a body",
                   "declare it before: coordinate " + on + " [m] = ..., or point " + on + " on a");
  const Value v = law_value(source, s);
  if (v.type == Type::poison) return;
  LawInput& input = joint_.law->inputs[at];
  const bool zero_vector_given = v.zero && input.rate->vector;
  if (!zero_vector_given && v.e->vector != input.rate->vector)
    return d.error(s.left.where, "the force on " + quote(on) + " is " + (input.rate->vector ? "a vector" : "a number") +
                                     ", not " + std::string(in_words(v.type)));
  if (!fits(v, joule / input.unit))
    return d.error(s.left.where, "this force is in " + spoken(*v.unit) + ", not in " + spoken(joule / input.unit));
  const Expr value = zero_vector_given ? zero_vector(*pool_) : v.e;
  input.force = input.force ? input.force + value : value;
  if (s.lower) limit_force(source, s, at);
}

// "," "within" "[" lower "," upper "]", of the sum of all forces on this coordinate.
void Elaborator::limit_force(Source& source, const StatementAst& s, std::size_t at) {
  const LawInput input = joint_.law->inputs[at];
  if (input.rate->vector || !input.value)
    return source.diagnostics.error(s.lower->where, "limits are for the force on a coordinate",
                                    "declare a coordinate, and push along it");
  if (input.lower)
    return source.diagnostics.error(s.lower->where, "the force on " + quote(input.name) + " has limits already",
                                    "write them once: they limit the sum");
  const std::vector<Expr> also = {input.value, time_symbol(*pool_)};
  const Expr lower = bound_value(source, *s.lower, joule / input.unit, also);
  const Expr upper = bound_value(source, *s.upper, joule / input.unit, also);
  are_limits(source, *s.lower, lower, upper);
  joint_.law->inputs[at].lower = lower;
  joint_.law->inputs[at].upper = upper;
}

void Elaborator::check_law(Source& spec) {
  if (spec.diagnostics.has_errors()) return;
  if (joint_.law->on_joint && joint_.law->bounded.empty())
    return spec.diagnostics.error(spec.ast.name.where, "the effect has no event that breaks its joint",
                                  "write bond: joint, until load(bond) >= strength");
  const auto acts = [](const LawInput& input) { return static_cast<bool>(input.force); };
  if (!joint_.law->energy && std::ranges::none_of(joint_.law->inputs, acts) && joint_.law->bounded.empty())
    spec.diagnostics.error(spec.ast.name.where,
                           "the effect has neither an energy nor a force nor a row with bounds: it does nothing",
                           "write energy ..., force on NAME = ..., NAME in [..., ...], or rate(NAME) = ...");
  const auto limited = [](const LawInput& input) { return static_cast<bool>(input.lower); };
  if (joint_.law->energy && std::ranges::any_of(joint_.law->inputs, limited))
    spec.diagnostics.error(spec.ast.name.where, "a force with limits stores no energy, but this effect has one",
                           "write the slope of the energy into the force");
  drop_idle_inputs();
  check_free(spec);
}

}  // namespace cdot::derive
