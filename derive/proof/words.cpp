#include "derive/proof/words.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/ranges.h>

#include "derive/derivation/derivation.hpp"
#include "derive/expression/functions.hpp"
#include "derive/expression/shared.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

using Spelled = std::map<const Node*, Expr>;

void spell_axes(const std::vector<Expr>& axes, const std::string& name, Spelled& spelled) {
  for (std::size_t k = 0; k < axes.size(); ++k)
    if (axes[k]->kind == Kind::symbol)
      spelled.emplace(&*axes[k], axes[k]->pool->vector_symbol(name + "." + "xyz"[k], Role::given, -1, true));
}

// The point pa stands for x(a) + ra.
void spell_points(Expr sum, const Joint& joint, Spelled& spelled) {
  std::vector<Term> terms = terms_of(sum);
  const auto factor_of = [&](Expr e) -> Rational* {
    const auto found = std::ranges::find_if(terms, [&](const Term& t) { return t.e == e; });
    return found == terms.end() ? nullptr : &found->coef;
  };
  std::vector<Term> points;
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::point || p.body < 0) continue;
    Rational *const arm = factor_of(p.symbol), *const centre = factor_of(body_symbols(joint, p.body).x);
    if (!arm || !centre || *arm != *centre) continue;
    points.push_back({*arm, joint.pool->vector_symbol(p.name, Role::given)});
    *arm = *centre = Rational(0);
  }
  for (const Term& t : terms)
    if (!t.coef.is_zero()) points.push_back({t.coef, substitute(t.e, spelled)});
  spelled.emplace(&*sum, derive::sum(*joint.pool, points, true));
}

// `let u4 = unit(cross(v, w))` may be stored as -unit(cross(w, v)), whose part has no name.
void spell_lets(Expr root, const Joint& joint, Spelled& spelled) {
  for (const Let& let : joint.lets) {
    const Term term = split_coefficient(let.value);
    if (term.e == root || !term.e->name.empty() || term.e->args.empty() || abs(term.coef) != Rational(1)) continue;
    const Expr name = term.e->vector ? joint.pool->vector_symbol(let.name, Role::given, -1, term.e->unit_length)
                                     : joint.pool->symbol(let.name, Role::given);
    spelled.emplace(&*term.e, term.coef * name);
  }
}

struct AngleAbout {
  Expr from, to, axis;
};

// atan2(p · v, r · v), p and r being axes of one frame, as the angle from r to v about the third one.
std::optional<AngleAbout> angle_about_axis(Expr e) {
  const Term sine = split_coefficient(e->args[0]), cosine = split_coefficient(e->args[1]);
  if (cosine.e->kind != Kind::dot || cosine.coef != Rational(1) || abs(sine.coef) != Rational(1)) return {};
  const Pool& pool = *e->pool;
  for (const Expr p : sine.e->args) {
    for (const Expr r : cosine.e->args) {
      if (pool.axis_of(p).triad == nullptr || pool.axis_of(p).triad != pool.axis_of(r).triad || p == r) continue;
      const Expr v = cosine.e->args[cosine.e->args[0] == r ? 1 : 0];
      if (sine.e != dot(p, v)) continue;
      const Term axis = split_coefficient(cross(r, p));
      return axis.coef == sine.coef ? AngleAbout{r, v, axis.e} : AngleAbout{v, r, axis.e};
    }
  }
  return {};
}

// An arc tangent that is the angle between directions, as a person writes it; empty for others.
std::string angle_text(Expr e, const Joint& joint) {
  const auto of = [&](std::initializer_list<Expr> args) {
    std::vector<std::string> words;
    for (const Expr arg : args) words.push_back(spec_text(arg, joint));
    return fmt::format("angle({})", fmt::join(words, ", "));
  };
  if (const auto angle = angle_between(e)) return of({angle->from, angle->to});
  const Expr sine = split_coefficient(e->args[0]).e;
  if (sine->kind != Kind::dot) return "";
  if (const std::optional<AngleAbout> angle = angle_about_axis(e)) return of({angle->from, angle->to, angle->axis});
  for (const bool first : {true, false}) {
    const Expr turn = sine->args[first ? 0 : 1], n = sine->args[first ? 1 : 0];
    if (turn->kind != Kind::cross) continue;
    const Expr u = turn->args[0], v = turn->args[1];
    if (e->args[1] != dot(u, v) - dot(n, u) * dot(n, v)) continue;
    if (e->args[0] == dot(n, cross(u, v))) return of({u, v, n});
    if (e->args[0] == dot(n, cross(v, u))) return of({v, u, n});
  }
  return "";
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

}  // namespace

std::string spec_text(Expr e, const Joint& joint) {
  if (!e->name.empty()) return e->name;
  Spelled spelled;
  spell_lets(e, joint, spelled);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    const std::string& name = joint.bodies[b];
    if (body.theta) spelled.emplace(&*body.theta, joint.pool->symbol("angle(" + name + ")", Role::given));
    spelled.emplace(&*body.x, joint.pool->vector_symbol("x(" + name + ")", Role::given));
  }
  for (const Parameter& p : joint.parameters) spell_axes(p.axes, p.name, spelled);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b)
    spell_axes(body_axes(*joint.pool, static_cast<int>(b)), joint.bodies[b], spelled);
  for (const Expr part : topological(std::span(&e, 1))) {
    if (part->kind == Kind::sum && part->vector && part->name.empty()) spell_points(part, joint, spelled);
    if (part->kind != Kind::function || part->fn != Fn::atan2) continue;
    if (const std::string angle = angle_text(part, joint); !angle.empty())
      spelled.emplace(&*part, joint.pool->symbol(angle, Role::given));
  }
  return text(substitute(e, spelled));
}

std::string brief_spec_text(Expr e, const Joint& joint) {
  constexpr double most_nodes = 1000;
  constexpr std::size_t most_letters = 90;
  if (!e->name.empty()) return e->name;
  const double nodes = written_size(e, [](Expr part) { return !part->name.empty(); });
  if (nodes > 1e6) return "an expression of over a million parts";
  if (nodes > most_nodes) return fmt::format("an expression of {:.0f} parts", nodes);
  std::string text = spec_text(e, joint);
  if (text.size() <= most_letters) return text;
  return text.substr(0, text.find_last_of(" *(", most_letters)) + " …";
}

std::string zero_text(Expr e, const Joint& joint) {
  e = split_coefficient(e).e;
  const bool alike =
      e->kind == Kind::sum && std::ranges::all_of(e->coefs, [&](Rational c) { return abs(c) == abs(e->coefs[0]); });
  if (alike && e->name.empty()) e = Rational(1) / abs(e->coefs[0]) * e;
  for (const Let& let : joint.lets)
    if (let.value == e || let.value == -e) return let.name;
  const std::string text = brief_spec_text(e, joint);
  return text.starts_with('-') ? brief_spec_text(-e, joint) : text;
}

std::string parallel(Expr u, Expr v, const Joint& joint) {
  const auto is_axis = [&](Expr e) { return joint.pool->axis_of(e).triad && e->body >= 0; };
  const auto may_become_one = [&](Expr e) {
    return std::ranges::any_of(joint.parameters, [&](const Parameter& p) {
      return p.kind == ParameterKind::unit && p.symbol == e && p.body >= 0;
    });
  };
  if (!is_axis(u) && (is_axis(v) || may_become_one(v))) std::swap(u, v);
  const std::string other = spec_text(v, joint) + ") = 0 keep 2";
  if (is_axis(u)) return "cross(" + spec_text(u, joint) + ", " + other;
  if (!may_become_one(u)) return "";
  const std::string& body = joint.bodies[static_cast<std::size_t>(u->body)];
  std::string f = "f";
  while (std::ranges::any_of(joint.parameters, [&](const Parameter& p) { return p.name == f; })) f += "f";
  return "cross(" + f + ".x, " + other + "` with `frame " + f + " on " + body + "` in place of `" + spec_text(u, joint);
}

std::string vanishing_vector(Expr u, const Joint& joint) {
  for (const Parameter& p : joint.parameters) {
    for (const Parameter& q : joint.parameters) {
      if (p.kind != ParameterKind::point || q.kind != ParameterKind::point) continue;
      if (p.value - q.value == u) return p.name + " = " + q.name;
    }
  }
  const std::string two = u->kind == Kind::cross && u->vector ? parallel(u->args[0], u->args[1], joint) : "";
  return two.empty() ? spec_text(u, joint) + " = 0" : two;
}

std::vector<Span> occurrences(const SourceFile& file, Span where, const std::set<std::string>& words) {
  const std::string& text = file.text;
  const auto end = std::min(static_cast<std::size_t>(where.end), text.size());
  std::vector<Span> spans;
  for (const std::string& word : words) {
    for (auto at = text.find(word, static_cast<std::size_t>(where.begin));
         at != std::string::npos && at + word.size() <= end; at = text.find(word, at + 1)) {
      const auto after = at + word.size();
      const bool begins = at == 0 || !is_word(text[at - 1]) || !is_word(word.front());
      const bool ends = after >= text.size() || !is_word(text[after]) || !is_word(word.back());
      if (begins && ends) spans.push_back({static_cast<int>(at), static_cast<int>(after)});
    }
  }
  std::sort(spans.begin(), spans.end(), [](Span a, Span b) { return a.begin < b.begin; });
  return spans;
}

}  // namespace cdot::derive
