// From C to J: the constraint, its derivative, the velocities isolated, the Jacobian read off, and gamma.
#include <algorithm>
#include <utility>

#include "derive/explain/lecture.hpp"

namespace cdot::derive {
namespace {

constexpr double most_terms = 500;  // of a gamma that is multiplied out

void head(Step& step, const Part& part, const Statement& s) {
  if (part.statements.size() > 1) step.say("Row `" + s.name + "`:");
}

// The factor of one velocity, summed up from the terms of Cdot.
void collect(Lecture& lecture, const std::vector<VelocityTerm>& terms, Expr coefficient, int body, bool spin,
             Step& step) {
  std::vector<SignedFormula> parts;
  for (const VelocityTerm& term : terms) {
    if (term.body != body || term.spin != spin || is_zero(term.coefficient)) continue;
    parts.push_back({false, lecture.notation.of(term.coefficient)});
  }
  if (parts.size() < 2) return;
  const BodySymbols symbols = body_symbols(lecture.joint, body);
  const Formula velocity = leaf(spin ? symbols.w : symbols.v);
  const Formula merged = lecture.notation.of(coefficient);
  const Formula listed = sum(positive_first(std::move(parts)));
  if (merged.shape == Shape::sum && merged.args.size() >= listed.args.size()) return;
  std::string rule = "like terms of " + velocity.name + " collected";
  if (merged == number(0)) rule = velocity.name + " cancels";
  step.show({listed, {{merged, std::move(rule)}}});
}

// Cdot as the sum of "entry of J times velocity", and dC/dt.
Formula isolated(const Lecture& lecture, const ScalarRow& row) {
  std::vector<SignedFormula> terms;
  for (std::size_t b = 0; b < row.J.size(); ++b) {
    const int body = static_cast<int>(b);
    const auto add = [&](Expr coefficient, bool spin) {
      if (is_zero(coefficient)) return;
      terms.push_back({false, multiplied(coefficient, body, spin, lecture.joint, lecture.notation)});
    };
    add(row.J[b].v, false);
    add(row.J[b].w, true);
  }
  if (!is_zero(row.C_t)) terms.push_back({false, lecture.notation.of(row.C_t)});
  return sum(std::move(terms));
}

void isolate_scalar(Lecture& lecture, const Part& part, const Statement& s, Step& step) {
  const ScalarRow& row = part.block.rows[s.first];
  const bool at_velocity_level = s.kind == RowKind::velocity;
  const std::optional<Formula> inserted = at_velocity_level ? std::nullopt : lecture.rates.inserted(s.C);
  if (!at_velocity_level && !inserted) {
    step.say("With all rates inserted there are too many terms to list. Through the names, each velocity collects:");
    return step.show({label("Cdot", s, row.Cdot), {{isolated(lecture, row), ""}}});
  }
  const Formula Cdot = at_velocity_level ? lecture.notation.definition(s.C) : *inserted;
  const std::vector<VelocityTerm> terms = isolate(Cdot, lecture.joint);
  for (const VelocityTerm& term : terms) {
    if (term.identity.empty()) continue;
    const Formula written = sum({{term.minus, term.written}});
    const Formula result =
        term.body < 0 ? number(0) : multiplied(term.coefficient, term.body, term.spin, lecture.joint, lecture.notation);
    step.show({written, {{result, term.identity}}});
  }
  for (const Expr n : row.gradients) {
    const char* rule =
        at_velocity_level ? "the vector that several terms share" : "the gradient of C, which several terms share";
    step.show({leaf(n), {{lecture.notation.definition(n), rule}}});
  }
  for (const Expr axis : row.axes) {
    step.show(
        {leaf(axis), {{lecture.notation.definition(axis), "the axis about which the bodies turn against each other"}}});
  }
  for (std::size_t b = 0; b < row.J.size(); ++b) {
    collect(lecture, terms, row.J[b].v, static_cast<int>(b), false, step);
    collect(lecture, terms, row.J[b].w, static_cast<int>(b), true, step);
  }
  const Formula result = isolated(lecture, row);
  if (same_terms(result, Cdot)) return step.say("Each velocity stands alone already.");
  step.show({label("Cdot", s, row.Cdot), {{result, ""}}});
}

// E v is written v.
Formula without_identity(Formula f) {
  if (f.shape == Shape::identity) return number(1);
  if (f.shape == Shape::product && f.args.back().shape == Shape::identity) {
    f.args.pop_back();
    return product(std::move(f.args));
  }
  return f;
}

const char* turning_by_skew(int dimension) {
  return dimension == 2 ? "w × r = S(r) w, with S(r) = perp(r) as a column" : "w × r = -S(r) w, with S(r) u = r × u";
}

// The factors of v and w of each body that are not 0, with that velocity.
std::vector<std::pair<Formula, Expr>> multiplied_velocities(const Lecture& lecture, const Statement& s) {
  std::vector<std::pair<Formula, Expr>> all;
  for (std::size_t b = 0; b < s.J.size(); ++b) {
    const BodySymbols body = body_symbols(lecture.joint, static_cast<int>(b));
    if (s.J[b].v != number(0)) all.emplace_back(s.J[b].v, body.v);
    if (s.J[b].w != number(0)) all.emplace_back(s.J[b].w, body.w);
  }
  return all;
}

void isolate_rows_together(Lecture& lecture, const Statement& s, Step& step) {
  std::vector<SignedFormula> terms;
  for (const auto& [block, velocity] : multiplied_velocities(lecture, s)) {
    for (const SignedFormula& term : terms_of(block)) {
      terms.push_back({term.minus, product({without_identity(term.formula), leaf(velocity)})});
    }
  }
  if (!is_zero(s.C_t)) terms.push_back({false, lecture.notation.of(s.C_t)});
  step.show({label("Cdot", s, s.Cdot), {{sum(std::move(terms)), turning_by_skew(lecture.joint.dimension)}}});
}

// The terms of e with products multiplied out; names are not opened.
double terms_if_expanded(Expr e) {
  if (e->kind != Kind::sum && e->kind != Kind::product && e->kind != Kind::scale) return 1;
  double terms = e->kind == Kind::sum ? 0 : 1;
  for (std::size_t i = 0; i < e->args.size() && terms < most_terms; ++i) {
    const bool opened = !Notation::has_name(e->args[i]) && (e->kind != Kind::product || e->exponents[i] == 1);
    const double of_part = opened ? terms_if_expanded(e->args[i]) : 1;
    terms = e->kind == Kind::sum ? terms + of_part : terms * of_part;
  }
  return terms;
}

// Products multiplied out, so that equal terms add up.
Expr expanded(Expr e) {
  Pool& pool = *e->pool;
  if (e->kind == Kind::sum) {
    std::vector<Term> terms;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const bool named = Notation::has_name(e->args[i]);
      terms.push_back({e->coefs[i], named ? e->args[i] : expanded(e->args[i])});
    }
    return sum(pool, terms, e->vector);
  }
  if (e->kind != Kind::product && e->kind != Kind::scale) return e;
  for (std::size_t i = 0; i < e->args.size(); ++i) {
    const Expr factor = e->args[i];
    const bool first_power = e->kind == Kind::scale || e->exponents[i] == 1;
    if (factor->kind != Kind::sum || Notation::has_name(factor) || !first_power) continue;
    Expr total = e->vector ? zero_vector(pool) : pool.number(0);
    for (const Term& term : terms_of(factor)) {
      std::vector<Expr> args = e->args;
      args[i] = term.coef * term.e;
      total = total + expanded(rebuild(e, args));
    }
    return total;
  }
  return e;
}

// True if it contains w × (w × r).
bool turns_twice(const Formula& f) {
  if (f.shape == Shape::cross && f.args[1].shape == Shape::cross) return true;
  return std::any_of(f.args.begin(), f.args.end(), turns_twice);
}

const char* kept_together(int dimension) {
  return dimension == 2 ? ". Two rows, x and y, written as one vector:"
                        : ". Three rows, x, y and z, written as one vector:";
}

// `keep 2` of n × m = 0, n an axis of a frame, selects the components along the other two axes.
void explain_kept(const Lecture& lecture, Expr product, Step& step) {
  const Pool& pool = *lecture.joint.pool;
  const bool first = pool.axis_of(product->args[0]).triad && product->args[0]->body >= 0;
  const Expr n = product->args[first ? 0 : 1], m = product->args[first ? 1 : 0];
  const Pool::Axis axis = pool.axis_of(n);
  const auto other = [&](int offset) { return (*axis.triad)[static_cast<std::size_t>((axis.index + offset) % 3)]; };
  const Expr y = other(1), z = other(2);
  const Notation& notation = lecture.notation;
  const Formula all = cross(leaf(n), notation.of(m));
  step.say(
      "`keep 2`: of the three rows of {} = 0 only two are independent, since {} · ({}) = 0 always. It selects the "
      "components along the other two axes of the frame:",
      {all, leaf(n), all});
  const std::string rule = "a · (b × c) = (a × b) · c";
  step.show({dot(leaf(z), all), {{dot(leaf(y), notation.of(m)), rule}}});
  step.show({dot(leaf(y), all), {{negative(dot(leaf(z), notation.of(m))), rule}}});
  step.say(
      "While both vanish, {} lies along {}, and {} and {} are as long as {} and orthogonal: these two rows stay "
      "independent wherever C = 0.",
      {notation.of(m), leaf(n), cross(leaf(y), notation.of(m)), cross(leaf(z), notation.of(m)), notation.of(m)});
}

// Cdot of a row with named axes, by these: their rates are fewer terms than those of all that they are made of.
Expr through_axes(const Joint& joint, const ScalarRow& row, Expr Cdot) {
  const bool kept = std::ranges::none_of(row.axes, [](Expr axis) { return axis->kind == Kind::scale; });
  if (row.axes.empty() || !kept) return Cdot;  // a product with a scaled vector opens it
  Expr total = row.C_t;
  for (std::size_t b = 0; b < row.J.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    total = total + dot(row.J[b].v, body.v) + dot(row.J[b].w, body.w);
  }
  return total;
}

}  // namespace

Formula row_of_J(const Statement& s) {
  std::vector<Formula> blocks;
  for (const VelocityBlocks& of_body : s.J) blocks.insert(blocks.end(), {of_body.v, of_body.w});
  const int columns = static_cast<int>(blocks.size());
  return matrix(columns, std::move(blocks));
}

void state_constraint(Lecture& lecture, const Part& part) {
  Step& step = lecture.section("Position constraint");
  if (part.statements.empty()) {
    step.say(lecture.joint.law
                 ? lecture.joint.law->on_joint ? "The effect adds no row to those of the joint."
                                               : "The effect constrains nothing: it acts along its coordinates."
                 : "The joint has no row of its own: it only names coordinates, on which effects may act.");
  }
  if (!lecture.joint.lets.empty()) step.say("Names:");
  for (const Let& let : lecture.joint.lets) {
    step.show({leaf(let.value, let.name), {{lecture.notation.definition(let.value), ""}}});
  }
  for (const Statement& s : part.statements) {
    std::string as_written = "Row `" + s.row->name + "`: `" + s.row->text + "`";
    if (!s.row->from.empty()) as_written += ", from the included joint " + s.row->from;
    step.say(as_written + (s.vector() ? kept_together(lecture.joint.dimension) : ":"));
    const Formula C = lecture.notation.definition(s.C);
    if (s.kind == RowKind::velocity) {
      step.show({label("Cdot", s, s.C), {{C, ""}}});
      step.say("The row is written at velocity level: it has no position form, and C is 0.");
    } else {
      step.show({label("C", s, s.C), {{C, ""}}});
    }
    const bool last = &s == &part.statements.back() || (&s)[1].row->kept != s.row->kept;
    if (s.row->kept && last) explain_kept(lecture, s.row->kept, step);
    if (s.kind == RowKind::inequality) {
      step.say("An inequality: {} ≥ 0, and its impulse may only push C up (lambda ≥ 0).", {label("C", s, s.C)});
    }
  }
}

void differentiate(Lecture& lecture, const Part& part, Step& step) {
  for (const Statement& s : part.statements) {
    head(step, part, s);
    if (s.kind == RowKind::velocity) {
      step.say("The row contains velocities already: there is nothing to differentiate.");
      continue;
    }
    for (Chain& chain : lecture.rates.differentiate(s.C, label("Cdot", s, s.Cdot))) {
      step.show(std::move(chain));
    }
  }
}

void isolate_velocities(Lecture& lecture, const Part& part, Step& step) {
  for (const Statement& s : part.statements) {
    head(step, part, s);
    if (s.vector()) isolate_rows_together(lecture, s, step);
    else isolate_scalar(lecture, part, s, step);
  }
}

void read_jacobian(Lecture& lecture, const Part& part, Step& step) {
  std::vector<Formula> all;
  for (const Statement& s : part.statements) {
    head(step, part, s);
    for (const auto& [block, velocity] : multiplied_velocities(lecture, s)) {
      step.list("{} is multiplied by {}", {leaf(velocity), block});
    }
    if (!is_zero(s.C_t)) {
      step.list("without a velocity, so no part of J but dC/dt with the bodies at rest: {}",
                {lecture.notation.of(s.C_t)});
    }
    const Formula row = row_of_J(s);
    all.insert(all.end(), row.args.begin(), row.args.end());
    if (part.statements.size() == 1) step.show({label("J", s), {{row, ""}}});
  }
  if (part.statements.size() < 2) return;
  step.say("Row under row:");
  const int columns = static_cast<int>(2 * lecture.joint.bodies.size());
  step.show({leaf({}, "J"), {{matrix(columns, std::move(all)), ""}}});
}

void differentiate_again(Lecture& lecture, const Part& part, Step& step) {
  for (const Statement& s : part.statements) {
    head(step, part, s);
    const Expr Cdot = through_axes(lecture.joint, part.block.rows[s.first], s.Cdot);
    const Expr gamma = -time_derivative(Cdot, lecture.joint);
    const Formula name = label("gamma", s, gamma);
    const Formula simplified =
        lecture.notation.definition(terms_if_expanded(gamma) < most_terms ? expanded(gamma) : gamma);
    if (simplified == number(0)) {
      step.show({name, {{simplified, "J does not change"}}});
      continue;
    }
    for (Chain& chain : lecture.rates.differentiate(Cdot, negative(name))) {
      chain.links.resize(1);  // with its names, not with all of them inserted
      const bool shorter = lecture.joint.dimension == 2 && turns_twice(chain.links[0].formula);
      if (chain.left != negative(name) && shorter) {
        const Expr turned = value_of(chain.links[0].formula, *lecture.joint.pool);
        chain.links.push_back({lecture.notation.definition(turned), "w × (w × r) = -w^2 r"});
      }
      step.show(std::move(chain));
    }
    step.show({name, {{simplified, ""}}});
  }
}

}  // namespace cdot::derive
