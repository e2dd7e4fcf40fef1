// Rows and coordinates: the constraints, and the scalars that stay free.
#include <algorithm>

#include "derive/expression/symbols.hpp"
#include "derive/language/elaborate.hpp"

namespace cdot::derive {
namespace {

// The part of an expression that is a velocity: a call of v or w.
const Ast* velocity_in(const Ast& ast) {
  if (ast.kind == Ast::Kind::call && (ast.text == "v" || ast.text == "w")) return &ast;
  for (const Ast& a : ast.args)
    if (const Ast* found = velocity_in(a)) return found;
  return nullptr;
}

}  // namespace

bool Elaborator::free_of_velocity(Source& source, const Ast& ast, const Value& value, std::string_view place) {
  if (!value.e || !depends_on_velocity(value.e)) return true;
  const Ast* part = velocity_in(ast);
  source.diagnostics.error(
      part ? part->where : ast.where, "a velocity stands in " + std::string(place),
      place == "a row" ? "mark the row: velocity ... = ..." : "velocities may occur in `velocity` rows only");
  return false;
}

// [ NAME ":" ] [ "velocity" ] left ( "=" | "<=" | ">=" ) right [ "keep" NUMBER ]
void Elaborator::row(Source& source, const StatementAst& s) {
  if (joint_.law)
    return source.diagnostics.error(s.where, "an effect has no rows without bounds",
                                    "write energy ..., force on NAME = ..., NAME >= ..., NAME in [..., ...], or "
                                    "rate(NAME) = ..., force in [..., ...]");
  const auto C = constraint(source, s);
  if (!C || !row_makes_sense(source, s, *C)) return;
  Row row;
  row.name = s.label.text.empty() ? "" : source.prefix + s.label.text;
  row.kind = s.velocity ? RowKind::velocity : s.relation == "=" ? RowKind::equality : RowKind::inequality;
  row.C = C->e;
  row.unit = C->unit.value_or(Unit{});
  row.where = in_spec(source, s.where);
  row.text = written(source, s);
  row.of_world = of_world_;
  if (source.include) row.from = source.including.back();
  if (s.keep.text.empty()) add_row(source, s, std::move(row));
  else keep(source, s, row);
}

void Elaborator::add_row(Source& source, const StatementAst& s, Row row) {
  const bool again = std::any_of(joint_.rows.begin(), joint_.rows.end(), [&](const Row& r) {
    return r.kind == row.kind && r.C == row.C && (source.include || !r.from.empty());
  });
  if (again) return;
  ++row_count_;
  if (row.name.empty()) row.name = "C" + std::to_string(row_count_);
  const auto [before, is_new] = row_names_.emplace(row.name, row.where);
  if (!is_new)
    error(source, s.label.text.empty() ? s.where : s.label.where, "two rows are named " + quote(row.name),
          "choose another name", {before->second});
  joint_.rows.push_back(std::move(row));
}

// n x m = 0 makes m parallel to n: two conditions in three components. With n = f.x an axis of a frame, `keep 2`
// selects the components along its other axes: f.z . (f.x x m) = f.y . m and -f.y . (f.x x m) = f.z . m. These stay
// independent as long as the row holds.
void Elaborator::keep(Source& source, const StatementAst& s, const Row& whole) {
  Diagnostics& d = source.diagnostics;
  const Term term = split_coefficient(whole.C);
  if (!whole.C->vector) return d.error(s.keep.where, "`keep` selects rows, but this is one row", "leave `keep` out");
  if (s.keep.text != "2" || joint_.dimension == 2)
    return d.error(s.keep.where, "`keep` takes 2 of the three rows of a cross product",
                   "write cross(f.x, u) = 0 keep 2, or the independent rows themselves");
  if (term.e->kind != Kind::cross)
    return d.error(s.left.where, "the independent rows of this equation are unknown",
                   "`keep 2` is for cross(n, m) = 0; else write the independent rows themselves");
  for (const int side : {0, 1}) {
    const Expr n = term.e->args[static_cast<std::size_t>(side)];
    const Expr m = term.e->args[static_cast<std::size_t>(1 - side)];
    const Pool::Axis axis = pool_->axis_of(n);
    if (!axis.triad || n->body < 0) continue;
    for (const int offset : {1, 2}) {
      const int other = (axis.index + offset) % 3;
      Row row = whole;
      row.kept = term.e;
      row.C = dot((*axis.triad)[static_cast<std::size_t>(other)], m);
      if (!row.name.empty()) row.name += std::string("_") + "xyz"[other];
      add_row(source, s, std::move(row));
    }
    return;
  }
  d.error(s.left.where, "no side of this cross product is an axis of a frame of a body",
          "declare `frame f on a` in place of the unit vector and write cross(f.x, ...): the rows along f.y and f.z "
          "are kept");
}

// lhs - rhs, or rhs - lhs for <=.
std::optional<Value> Elaborator::constraint(Source& source, const StatementAst& s) {
  SourceNames names(*this, source);
  Evaluator evaluator(*pool_, names, source.diagnostics);
  Value left = evaluator(s.left), right = evaluator(s.right);
  if (left.type == Type::poison || right.type == Type::poison) return {};
  Diagnostics& d = source.diagnostics;
  for (const auto& [value, ast] : {std::pair{&left, &s.left}, std::pair{&right, &s.right}})
    if (value->type == Type::body || value->type == Type::frame) {
      d.error(ast->where, std::string(in_words(value->type)) + " cannot stand in an equation",
              value->type == Type::body ? "compare positions, x(" + ast->text + "), or angles, angle(" + ast->text + ")"
              : joint_.dimension == 3 ? "write rotation(fa, fb) = 0, or compare one axis: cross(fa.x, fb.x) = 0 keep 2"
                                      : "compare its axes, " + ast->text + ".x");
      return {};
    }
  const bool point_and_vector = (left.type == Type::point) != (right.type == Type::point);
  if (point_and_vector) {
    d.error((left.type == Type::point ? s.right : s.left).where,
            "a point cannot equal " + std::string(in_words(left.type == Type::point ? right.type : left.type)),
            "compare it with a point, such as `point origin on world`",
            {(left.type == Type::point ? s.left : s.right).where});
    return {};
  }
  if (s.relation != "=" && (left.type != Type::scalar || right.type != Type::scalar)) {
    d.error(s.relation_where, quote(s.relation) + " compares numbers, not vectors",
            "compare a component with dot(u, n), or a length with norm(u)", {s.left.where, s.right.where});
    return {};
  }
  const bool flipped = s.relation == "<=";
  Value C = evaluator.add({left, right}, flipped ? "-+" : "+-", {s.left.where, s.right.where},
                          s.relation == "=" ? "equates " : "compares ");
  if (C.type == Type::poison) return {};
  return C;
}

bool Elaborator::row_makes_sense(Source& source, const StatementAst& s, const Value& C) {
  Diagnostics& d = source.diagnostics;
  if (is_zero(C.e)) {
    d.error(s.where, "the row is redundant: both sides are always equal", "remove it");
    return false;
  }
  if (const Term term = split_coefficient(C.e); term.e->vector && term.e->unit_length) {
    d.error(s.where, "the row cannot hold: both sides always differ by a vector of length " + abs(term.coef).text(),
            "write a condition on directions of two bodies, as cross(fa.x, fb.x) = 0, or remove the row");
    return false;
  }
  if (!depends_on_bodies(C.e)) {
    d.error(s.where, "the row contains no body, so it constrains nothing",
            "write a row that contains the position or orientation of a body");
    return false;
  }
  if (s.velocity && s.relation != "=") {
    d.error(s.relation_where, "inequalities between velocities are not supported",
            "write an inequality of positions, or a velocity row with =");
    return false;
  }
  if (s.velocity && !depends_on_velocity(C.e)) {
    d.error(s.where, "this `velocity` row contains no velocity",
            "remove the word `velocity`: this is a position constraint");
    return false;
  }
  if (!s.velocity) {
    const Ast& side = velocity_in(s.left) || !velocity_in(s.right) ? s.left : s.right;
    if (!free_of_velocity(source, side, C, "a row")) return false;
  }
  joint_.uses_time |= depends_on_role(C.e, Role::time);
  return true;
}

// The right side of a coordinate; poison if it is none.
Value Elaborator::coordinate_value(Source& source, const StatementAst& s) {
  const DeclaredAst& d = s.declared;
  const Value v = evaluate(source, *d.value);
  if (v.type == Type::poison) return v;
  const auto refuse = [&](const std::string& message, const std::string& fix, std::vector<Span> also = {}) {
    source.diagnostics.error(d.value->where, message, fix, also);
    return Value{};
  };
  if (v.type != Type::scalar)
    return refuse("a coordinate is a number, not " + std::string(in_words(v.type)),
                  "take a component, such as dot(u, t), or a length, norm(u)");
  if (s.velocity && !joint_.law)
    return refuse("a coordinate of a joint has a value, not only a rate", "only an effect prescribes rates");
  if (s.velocity && !depends_on_velocity(v.e))
    return refuse("this `velocity` contains no velocity", "remove the word `velocity`: the coordinate has a value");
  if (!s.velocity && !free_of_velocity(source, *d.value, v, "a coordinate")) return {};
  if (!depends_on_bodies(v.e))
    return refuse("the coordinate contains no body",
                  "write a scalar that contains the position or orientation of a body");
  const Unit second = s.velocity ? Unit{.s = 1} : Unit{};
  if (d.unit && !same_unit(scalar(Expr(), d.unit->unit / second), v))
    return refuse((s.velocity ? "the rate of the coordinate is in " : "the coordinate is in ") + spoken(*v.unit) +
                      ", not in " + spoken(d.unit->unit / second),
                  "", {d.unit->where});
  return v;
}

// coordinate NAME [unit] = [ velocity ] expression
void Elaborator::coordinate(Source& source, const StatementAst& s) {
  const DeclaredAst& d = s.declared;
  const std::string full = source.prefix + d.name.text;
  if (d.broken || (!d.value && !of_coordinate_)) return;
  if (is_word_of_cpp(full) || is_member_of_kernels(full) || full == joint_.name)
    return error(source, d.name.where, quote(full) + " is already a name of the generated kernel",
                 "choose another name");
  if (of_coordinate_ && !d.value) return free_coordinate(source, s);
  const Value v = coordinate_value(source, s);
  const Unit of_value = v.unit.value_or(Unit{}), second{.s = s.velocity ? 1 : 0};
  if (joint_.law) return coordinate_of_effect(source, s, v, d.unit ? d.unit->unit : of_value * second);
  if (v.type == Type::poison) return;
  const auto same = std::find_if(joint_.coordinates.begin(), joint_.coordinates.end(),
                                 [&](const Coordinate& c) { return c.name == full; });
  if (same != joint_.coordinates.end()) {
    if (source.include && same->value == v.e) return;
    return error(source, d.name.where, "two coordinates are named " + quote(full),
                 source.include ? "include it under a prefix: include ... as left" : "choose another name",
                 {same->where});
  }
  joint_.uses_time |= depends_on_role(v.e, Role::time);
  const Unit unit = d.unit ? d.unit->unit : v.unit.value_or(Unit{});
  const std::string from = source.include ? source.including.back() : "";
  joint_.coordinates.push_back(
      {full, v.e, unit, in_spec(source, d.name.where), written(source, s), from, {}, of_world_});
}

// A row or the right side of a coordinate as its author wrote it, in one line, with the names that things have here.
std::string Elaborator::written(const Source& source, const StatementAst& s) const {
  std::string out = s.velocity ? "velocity " : "";
  int end = -1;
  const int begin = s.kind == StatementAst::Kind::row     ? s.left.where.begin
                    : s.kind == StatementAst::Kind::bound ? s.relation_where.begin
                                                          : s.declared.value->where.begin;
  for (int i = s.first_token; i < s.end_token; ++i) {
    const Token& t = source.tokens.list[static_cast<std::size_t>(i)];
    if (t.where.begin < begin || t.kind == TokenKind::newline) continue;
    if (end >= 0 && t.where.begin > end) out += ' ';
    end = t.where.end;
    const std::string word(t.text);
    const int body = body_of_letter(word);
    if (const auto given = source.given.find(word); given != source.given.end()) out += given->second.text;
    else if (t.kind == TokenKind::name && names_.contains(source.prefix + word)) out += source.prefix + word;
    else if (t.kind == TokenKind::name && body >= 0 && body < static_cast<int>(source.bodies.size()))
      out += body_name(source.bodies[static_cast<std::size_t>(body)]);
    else out += word;
  }
  return out;
}

}  // namespace cdot::derive
