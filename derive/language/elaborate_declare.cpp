// Parameters and lets: their values and defaults; a name may be declared once.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "derive/expression/functions.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {
namespace {

ParameterKind kind_of(const std::string& word) {
  return word == "point"    ? ParameterKind::point
         : word == "vector" ? ParameterKind::vector
         : word == "unit"   ? ParameterKind::unit
         : word == "frame"  ? ParameterKind::frame
                            : ParameterKind::scalar;
}

bool is_reserved(const std::string& name) {
  static const std::array<std::string_view, 23> words = {
      "joint", "effect", "planar", "spatial", "source", "include", "as",       "on",
      "world", "point",  "vector", "unit",    "frame",  "scalar",  "velocity", "coordinate",
      "let",   "C",      "Cdot",   "J",       "K",      "lambda",  "keep"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

// A number without a unit takes the declared one: `scalar k [1/m] = 0.25`.
bool is_plain_number(const Value& v) { return v.type == Type::scalar && v.unit == Unit{} && constant_value(v.e); }

// True unless both includes give a default and these differ.
bool same_default(Expr a, Expr b) { return !a || !b || a == b; }

}  // namespace

// point, vector, unit, frame or scalar
void Elaborator::declare(Source& source, const DeclaredAst& d) {
  if (take_given(source, d)) return;
  const std::string full = source.prefix + d.name.text;
  Parameter p;
  p.name = full;
  p.kind = kind_of(d.kind);
  p.where = in_spec(source, d.name.where);
  const bool placed = !d.broken && resolve_body(source, d, p);
  Value given = default_value(source, d);
  const bool good = placed && default_fits(source, d, given) && resolve_unit(source, d, given, p) &&
                    resolve_range(source, d, p) && default_in_range(source, d, given, p);
  if (const auto known = names_.find(full); good && source.include && known != names_.end()) {
    const auto before = std::find_if(joint_.parameters.begin(), joint_.parameters.end(),
                                     [&](const Parameter& q) { return q.name == full; });
    if (before != joint_.parameters.end() && before->kind == p.kind && before->body == p.body &&
        before->unit == p.unit && before->range == p.range && same_default(before->default_value, given.e))
      return;
  }
  if (!name_is_free(source, d.name, full)) return;
  Value value;
  if (good && build_symbol(source, d, p, value)) {
    p.default_value = given.e;
    if (!p.axes.empty() && given.e) default_axes(given, p);
    joint_.parameters.push_back(p);
  }
  enter(source, full, d.kind, value, d.name.where, p.kind != ParameterKind::scalar && p.body < 0);
}

bool Elaborator::resolve_body(Source& source, const DeclaredAst& d, Parameter& p) {
  if (p.kind == ParameterKind::scalar) return true;
  std::string word = d.body.text;
  const auto anchor = anchors_.find(p.name);
  SourceNames names(*this, source);
  if (anchor != anchors_.end()) {
    word = anchor->second;
    p.body = body_of_letter(word);
  } else {
    p.body = names.body(word);
  }
  if (word == "world") {
    use_world();
    return true;
  }
  if (p.body < 0) {
    source.diagnostics.error(d.body.where, "there is no body " + quote(word),
                             word == "ground" || word == "earth" || word == "fixed" || word == "origin"
                                 ? "the ground is called `world`"
                                 : "bodies are a, b, c, ... up to h, and world");
    return false;
  }
  names.use_body(p.body, d.body.where);
  return true;
}

Value Elaborator::default_value(Source& source, const DeclaredAst& d) {
  if (!d.value || d.broken) return {};
  in_default_ = d.kind == "scalar";
  const Value v = evaluate(source, *d.value);
  in_default_ = false;
  if (v.type == Type::poison) return {};
  if (!free_of_velocity(source, *d.value, v, "a default")) return {};
  if (v.e && depends_on_role(v.e, Role::time)) {
    source.diagnostics.error(d.value->where, "a default depends on time",
                             "defaults are taken from the initial pose, before time runs");
    return {};
  }
  return v;
}

// Brings the default into the declared kind; reports an error where that is impossible.
bool Elaborator::default_fits(Source& source, const DeclaredAst& d, Value& given) {
  if (!d.value) return true;
  if (given.type == Type::poison) return false;
  const auto is = [&](Type t) { return given.type == t; };
  if (d.kind == "frame" && is(Type::body)) {
    SourceNames(*this, source).use_body(given.body, d.value->where);
    const std::vector<Expr> axes = body_axes(*pool_, given.body);
    given = vector(axes[0]);
    given.axes = axes;
  }
  if (d.kind == "frame" && is(Type::frame)) given.type = Type::vector;
  if (given.zero && d.kind == "vector") given = vector(zero_vector(*pool_), {});
  const Type wanted = d.kind == "point" ? Type::point : d.kind == "scalar" ? Type::scalar : Type::vector;
  if (!is(wanted)) {
    source.diagnostics.error(d.value->where,
                             "the default of the " + d.kind + " " + quote(d.name.text) + " must be " +
                                 std::string(in_words(wanted)) + ", not " + std::string(in_words(given.type)),
                             wanted == Type::point && is(Type::vector) ? "add it to a point, such as x(a) + ..." : "");
    return false;
  }
  if (!given.along.empty()) {
    source.diagnostics.error(d.value->where, "a default is given in world axes, not along a frame",
                             "leave out local(...)");
    return false;
  }
  if (d.kind != "unit" && d.kind != "frame") return true;
  if (given.unit && *given.unit != Unit{}) {
    source.diagnostics.error(d.value->where, "a direction has no unit, but the default is in " + spoken(*given.unit),
                             "write unit(...)");
    return false;
  }
  if (!given.e->unit_length) given.e = unit(given.e);
  return true;
}

bool Elaborator::resolve_unit(Source& source, const DeclaredAst& d, const Value& given, Parameter& p) {
  if (d.unit && (d.kind == "unit" || d.kind == "frame" || d.unit->degrees != 0)) {
    source.diagnostics.error(
        d.unit->where,
        d.unit->degrees != 0 ? "angles are stored in radians, not in degrees"
                             : "a " + d.kind + " is a direction, without a unit",
        d.unit->degrees != 0 ? "write [rad]; a default may be 90 [deg]" : "remove the unit, or declare a vector");
    return false;
  }
  const Unit metre{.m = 1};
  if (d.unit && !of_coordinate_ && d.unit->unit.any != Rational(0)) {
    source.diagnostics.error(d.unit->where, "`any` is the unit of the coordinate of a joint that an effect acts on",
                             "write `effect " + joint_.name + " coordinate` in the header, or another unit");
    return false;
  }
  if (d.kind == "point") p.unit = metre;
  else if (d.unit) p.unit = d.unit->unit;
  else if (given.unit && d.value) p.unit = *given.unit;
  if (d.kind == "point" && d.unit && d.unit->unit != metre) {
    source.diagnostics.error(d.unit->where, "a point is in metres", "remove the unit");
    return false;
  }
  if (d.value && !is_plain_number(given) && !same_unit(scalar(Expr(), p.unit), given)) {
    source.diagnostics.error(
        d.value->where,
        "the default of " + quote(d.name.text) + " is in " + spoken(*given.unit) + ", not in " + spoken(p.unit),
        given.unit == Unit{} ? "give the number its unit, as in 2 [m]" : "",
        d.unit ? std::vector<Span>{d.unit->where} : std::vector<Span>{});
    return false;
  }
  return true;
}

bool Elaborator::resolve_range(Source& source, const DeclaredAst& d, Parameter& p) {
  if (!d.range || d.broken) return true;
  for (const auto& [ast, to] : {std::pair(&d.range->above, &p.above), std::pair(&d.range->below, &p.below)}) {
    if (!*ast) continue;
    const std::optional<double> value = bound(source, **ast, d, p);
    if (!value) return false;
    *to = *value;
  }
  p.from = d.range->from;
  if (!(p.above < p.below)) {
    source.diagnostics.error(d.range->where, "no number lies in this range", "put the smaller bound first");
    return false;
  }
  p.range = source.file->text.substr(static_cast<std::size_t>(d.range->where.begin),
                                     static_cast<std::size_t>(d.range->where.end - d.range->where.begin));
  return true;
}

// A default that is computed from the pose is checked by each scene.
bool Elaborator::default_in_range(Source& source, const DeclaredAst& d, const Value& given, const Parameter& p) {
  const std::optional<double> value = d.value && d.range && given.e ? constant_value(given.e) : std::nullopt;
  if (!value || std::isinf(*value) || (*value > p.above && *value < p.below) || (p.from && *value == p.above))
    return true;
  source.diagnostics.error(d.value->where,
                           fmt::format("the default of {} is {:g}, outside of its range", quote(d.name.text), *value),
                           "another default, or a wider range", {d.range->where});
  return false;
}

// One bound of a range, a constant in the unit of the parameter; empty if that is reported as an error.
std::optional<double> Elaborator::bound(Source& source, const Ast& ast, const DeclaredAst& d, const Parameter& p) {
  const Value v = evaluate(source, ast);
  if (v.type == Type::poison) return {};
  const std::optional<double> value = v.type == Type::scalar ? constant_value(v.e) : std::nullopt;
  if (!value)
    source.diagnostics.error(ast.where, "a bound of " + quote(d.name.text) + " is not a constant",
                             "write a number, such as 0 or pi");
  else if (!is_plain_number(v) && !same_unit(scalar(Expr(), p.unit), v))
    source.diagnostics.error(
        ast.where, "a bound of " + quote(d.name.text) + " is in " + spoken(*v.unit) + ", not in " + spoken(p.unit),
        "write the number alone: it takes the declared unit");
  else return value;
  return {};
}

// A frame of another body as it is; a direction n for the x axis is completed to a triad by axes that depend on nothing
// but n: with s = 1 where n.z > 0 and -1 elsewhere, a = -1/(s + n.z), b = n.x n.y a,
// y = (1 + s a n.x^2, s b, -s n.x) and z = (b, s + a n.y^2, -n.y).
// Source: Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin, Building an Orthonormal Basis, Revisited, 2017
void Elaborator::default_axes(const Value& given, Parameter& p) {
  if (!given.axes.empty()) {
    p.default_axes = given.axes;
    return;
  }
  const std::vector<Expr> world = world_axes(*pool_);
  const Expr n = given.e, one = pool_->number(1);
  const Expr x = dot(world[0], n), y = dot(world[1], n), z = dot(world[2], n);
  const Expr cases[] = {z, one, -one};
  const Expr s = call(Fn::select, cases), a = -pow(s + z, -1), b = x * y * a;
  const auto vector_of = [&](Expr u, Expr v, Expr w) { return u * world[0] + v * world[1] + w * world[2]; };
  p.default_axes = {n, vector_of(one + s * a * x * x, s * b, -(s * x)), vector_of(b, s + a * y * y, -y)};
}

bool Elaborator::symbol_is_free(Source& source, const DeclaredAst& d, const std::string& symbol, bool arm) {
  if (!pool_->find(symbol) && !is_symbol_of_tool(symbol) && !(arm && names_.contains(symbol))) return true;
  const auto other = names_.find(symbol);
  error(source, d.name.where,
        "the " + d.kind + " " + quote(d.name.text) + " needs the name " + quote(symbol) + (arm ? " for its arm" : "") +
            ", which is taken",
        "choose another name", other != names_.end() ? std::vector<Span>{other->second.where} : std::vector<Span>{});
  return false;
}

// In space a frame is a triad of three leaves, in the plane its x axis.
bool Elaborator::build_frame(Source& source, const DeclaredAst& d, Role role, Parameter& p, Value& value) {
  if (joint_.dimension == 3) {
    for (const char* axis : {"_x", "_y", "_z"})
      if (!symbol_is_free(source, d, p.name + axis, false)) return false;
    const Triad triad = pool_->triad(p.name, role, p.body);
    p.axes.assign(triad.begin(), triad.end());
    p.symbol = p.value = p.axes[0];
    value = vector(p.value, p.unit);
    value.axes = p.axes;
  } else {
    if (!symbol_is_free(source, d, p.name + "_x", false)) return false;
    p.symbol = p.value = pool_->vector_symbol(p.name + "_x", role, p.body, true);
    value = vector(p.value, p.unit);
    value.axes = {p.value, perp(p.value)};
  }
  value.body = p.body;
  value.type = Type::frame;
  return true;
}

// The leaf behind a parameter, and the value of its name in expressions.
bool Elaborator::build_symbol(Source& source, const DeclaredAst& d, Parameter& p, Value& value) {
  const Role role = p.body < 0 ? Role::world_vector : Role::body_vector;
  if (p.kind == ParameterKind::frame) return build_frame(source, d, role, p, value);
  const bool arm = p.kind == ParameterKind::point && p.body >= 0;
  const std::string symbol = arm ? arm_name(source.prefix, d.name.text) : p.name;
  if (!symbol_is_free(source, d, symbol, arm)) return false;
  if (p.kind == ParameterKind::scalar) {
    p.symbol = p.value = pool_->symbol(symbol, Role::parameter);
    value = scalar(p.value, p.unit);
    return true;
  }
  p.symbol = p.value = pool_->vector_symbol(symbol, role, p.body, p.kind == ParameterKind::unit);
  if (arm) p.value = body_position(*pool_, p.body) + p.symbol;
  value = vector(p.value, p.unit);
  value.body = p.body;
  if (p.kind == ParameterKind::point) {
    value.type = Type::point;
    value.anchored = true;
    if (arm) value.arm = p.symbol;
  }
  if (arm) enter(source, symbol, "arm", vector(p.symbol, p.unit), d.name.where);
  return true;
}

// let NAME = expression
void Elaborator::let(Source& source, const DeclaredAst& d) {
  const std::string full = source.prefix + d.name.text;
  Value value = d.value && !d.broken ? evaluate(source, *d.value) : Value{};
  if (value.type == Type::body || value.type == Type::frame) {
    source.diagnostics.error(d.value->where, std::string(in_words(value.type)) + " needs no second name",
                             "use " + quote(d.value->text) + " itself");
    value = {};
  }
  if (const auto known = names_.find(full);
      source.include && known != names_.end() && known->second.kind == "let" && known->second.value.e == value.e)
    return;
  if (!name_is_free(source, d.name, full)) return;
  value.zero = false;
  if (value.type != Type::poison) {
    const Span where = in_spec(source, d.name.where);
    const Unit unit = value.unit.value_or(Unit{});
    if (!value.along.empty()) {
      for (std::size_t i = 0; i < value.along.size(); ++i) {
        const Expr part = component(value.e, i);
        const std::string name = full + "_" + "xyz"[i];
        pool_->name(part, name, true);
        joint_.lets.push_back({name, part, unit, where});
      }
    } else {
      pool_->name(value.e, full, true);
      joint_.lets.push_back({full, value.e, unit, where});
    }
    value.unit = unit;
  }
  enter(source, full, "let", value, d.name.where, of_world_);
}

// t1 for t: no word of the language or of C++, no name so far.
std::string Elaborator::free_name_like(const std::string& name) const {
  const auto is_taken = [&](const std::string& candidate) {
    return names_.contains(candidate) || is_operator(candidate) || is_symbol_of_tool(candidate) ||
           pool_->find(candidate) || !vector_of_component(candidate).empty();
  };
  std::string candidate;
  for (int k = 1; candidate.empty() || is_taken(candidate); ++k) candidate = name + std::to_string(k);
  return candidate;
}

bool Elaborator::name_is_free(Source& source, const Word& word, const std::string& full) {
  const std::string other = "call it `" + free_name_like(full) + "`, for instance";
  const auto say = [&](const std::string& message, const std::string& fix) {
    error(source, word.where, quote(full) + message, fix);
    if (!names_.contains(full)) enter(source, full, "let", {}, word.where);
    return false;
  };
  if (is_reserved(full)) return say(" is a word of the language", other);
  if (is_operator(full)) {
    const Operator& o = *operators_named(full)[0];
    if (o.where != Operator::Where::hand) return say(" is the operator " + std::string(o.signature), other);
  }
  if (is_word_of_cpp(full)) return say(" is a C++ keyword: the generated kernel cannot use it", other);
  if (const std::string vector = vector_of_component(full); !vector.empty())
    return say(" is the name of a component of " + quote(vector), other);
  if (is_symbol_of_tool(full)) return say(" is a name that generated code uses", other);
  const auto known = names_.find(full);
  if (known == names_.end()) return true;
  const std::string fix = source.include ? "include it under a prefix: include ... as left" : other;
  error(source, word.where,
        known->second.kind == "arm"                ? quote(full) + " is already the arm of a point"
        : source.include || known->second.included ? quote(full) + " has another meaning in the included joint"
                                                   : quote(full) + " is declared twice",
        fix, {known->second.where});
  return false;
}

// "_x", "_y", and in space "_z".
bool Elaborator::is_component(std::string_view ending) const {
  return ending == "_x" || ending == "_y" || (ending == "_z" && joint_.dimension == 3);
}

// The vector that has `name` as the name of a component in kernels: `t` for `t_x`.
std::string Elaborator::vector_of_component(const std::string& name) const {
  const auto is_vector = [](const Value& v) {
    return v.type == Type::vector || v.type == Type::point || v.type == Type::frame;
  };
  if (name.size() > 2 && is_component(name.substr(name.size() - 2))) {
    const auto base = names_.find(name.substr(0, name.size() - 2));
    if (base != names_.end() && is_vector(base->second.value)) return base->first;
  }
  return {};
}

void Elaborator::enter(Source& source, const std::string& full, std::string kind, Value value, Span where,
                       bool of_world) {
  if (value.type == Type::vector || value.type == Type::point || value.type == Type::frame)
    for (const char* component : {"_x", "_y", "_z"})
      if (const auto taken = names_.find(full + component); is_component(component) && taken != names_.end())
        error(source, where,
              "a component of " + quote(full) + " is called " + quote(full + component) + ", which is another name",
              "choose another name", {taken->second.where});
  names_[full] = {std::move(value),           std::move(kind), in_spec(source, where),
                  source.include.has_value(), false,           of_world};
}

}  // namespace cdot::derive
