// One symbol for another: an arm halved or with the wrong sign, the arm of another body, another axis of a frame.
#include "derive/diff/slips/slips.hpp"

namespace cdot::derive {
namespace {

bool is_with(const Whole& whole, std::map<const Node*, Expr> named, Expr lever, Expr other) {
  named[&*lever] = other;
  const std::vector<Expr> entries = Whole::substituted(whole.mine, named);
  return whole.is([&](std::size_t i) { return values_at(entries, whole.samples()[i]); });
}

// An arm, a number, or a name that the spec gives to a vector, times 0, 1/2, 2 or -1; the inverse of a number.
std::optional<Slip> lever(const Whole& whole) {
  std::vector<std::pair<std::string, Expr>> levers;
  for (const Parameter& p : whole.entry.joint.parameters)
    if ((p.kind == ParameterKind::point && p.body >= 0) || p.kind == ParameterKind::scalar)
      levers.emplace_back(p.symbol->symbol, p.symbol);
  for (const Let& let : whole.entry.joint.lets)
    if (let.value->vector) levers.emplace_back(let.name, let.value);
  std::map<const Node*, Expr> named;  // stays as it is
  for (const Let& let : whole.entry.joint.lets) named.emplace(&*let.value, let.value);
  for (const auto& [name, lever] : levers) {
    if (!lever->vector && is_with(whole, named, lever, pow(lever, -1)))
      return Slip{"factor", fmt::format("1/{0} stands where {0} belongs", name)};
    if (lever->vector && whole.entry.joint.dimension == 2 &&
        (is_with(whole, named, lever, perp(lever)) || is_with(whole, named, lever, -perp(lever))))
      return Slip{"factor", fmt::format("{0} and perp({0}) are exchanged", name)};
    for (const auto& [factor, words] : {std::pair(Rational(1, 2), "half of {} stands where {} belongs"),
                                        std::pair(Rational(2), "twice {} stands where {} belongs"),
                                        std::pair(Rational(0), "the terms with {} are missing"),
                                        std::pair(Rational(-1), "-{} stands where {} belongs")})
      if (is_with(whole, named, lever, factor * lever))
        return Slip{factor.is_zero()         ? "missing term"
                    : factor == Rational(-1) ? "sign"
                                             : "factor",
                    fmt::format(fmt::runtime(words), name, name)};
  }
  return {};
}

// Undone in the published matrix, the exchange gives the generated one.
std::optional<Slip> other_body(const Whole& whole) {
  for (const Exchange& exchange : exchanges(whole.entry.joint)) {
    if (whole.is_right_with(exchange.replacements)) return Slip{"wrong body", exchange.words};
  }
  return {};
}

// Of K: in the terms of one body, the arm of another.
std::optional<Slip> lever_of_other_body(const Whole& whole) {
  if (whole.what != "K") return {};
  std::vector<Expr> arms;
  for (const Parameter& p : whole.entry.joint.parameters)
    if (p.kind == ParameterKind::point && p.body >= 0) arms.push_back(p.symbol);
  for (const std::string& body : whole.entry.joint.bodies)
    for (const Expr arm : arms)
      for (const Expr other : arms) {
        if (arm == other) continue;
        const std::vector<Expr> exchanged = whole.substituted(whole.mine, {{&*arm, other}});
        const auto expected = [&](std::size_t pose) {
          const Sample& sample = whole.samples()[pose];
          Sample without = sample;
          for (auto& [name, value] : without.scalars)
            if (name == "inv_m_" + body || name.starts_with("inv_I_" + body)) value = 0;
          List of = values_at(exchanged, sample);
          const List rest = values_at(exchanged, without), others = values_at(whole.mine.entries, without);
          for (std::size_t i = 0; i < of.size(); ++i) of[i] += others[i] - rest[i];
          return of;
        };
        if (whole.is(expected))
          return Slip{"wrong body", fmt::format("in the terms of body {}, {} stands where {} belongs", body,
                                                other->symbol, arm->symbol)};
      }
  return {};
}

// The directions, points, numbers and lets of the spec, by name.
std::vector<std::pair<std::string, Expr>> known_symbols(const Whole& whole) {
  std::vector<std::pair<std::string, Expr>> known;
  for (const Matrix* of : {&whole.hand, &whole.mine})
    for (const Expr leaf : leaves_of(of->entries))
      if (leaf->role == Role::parameter || leaf->role == Role::body_vector) known.emplace_back(text(leaf), leaf);
  for (const Let& let : whole.entry.joint.lets) known.emplace_back(let.name, let.value);
  std::ranges::sort(known, {}, [](const auto& one) { return one.first; });
  known.erase(std::unique(known.begin(), known.end()), known.end());
  return known;
}

// One in place of another, as fb.y for fb.z, or two exchanged.
std::optional<Slip> confused(const Whole& whole, bool both) {
  const auto known = known_symbols(whole);
  const std::vector<Expr> nodes = topological(whole.hand.entries);
  const auto is_there = [&](Expr e) { return std::ranges::find(nodes, e) != nodes.end(); };
  for (const auto& [name, stands] : known)
    for (const auto& [right, belongs] : known) {
      if (stands == belongs || stands->vector != belongs->vector || (both && right < name)) continue;
      std::map<const Node*, Expr> by = {{&*stands, belongs}};
      if (both && (!is_there(stands) || !is_there(belongs))) continue;
      if (both) by.emplace(&*belongs, stands);
      if (!whole.is_right_with(by)) continue;
      // Not by chance, as unit(u) for u where a length is divided out.
      const bool turned = whole.entry.joint.dimension == 2 && stands->vector && perp(stands) == belongs;
      std::map<const Node*, Expr> back = {{turned ? &*stands : &*belongs, turned ? -belongs : stands}};
      if (both) back = by;
      if (!whole.is_made_with(back)) continue;
      const char* const words = both ? "{} and {} are exchanged" : "{} stands where {} belongs";
      return Slip{"factor", in_names_of_spec(fmt::format(fmt::runtime(words), name, right), whole.entry.joint)};
    }
  return {};
}

}  // namespace

std::optional<Slip> slip_of_symbol(const Whole& whole) {
  return first_of({lever, other_body, lever_of_other_body, [](const Whole& of) { return confused(of, false); }}, whole);
}

std::optional<Slip> slip_of_exchange(const Whole& whole) { return confused(whole, true); }

}  // namespace cdot::derive
