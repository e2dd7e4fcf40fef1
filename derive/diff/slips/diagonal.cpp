// One slip on every diagonal entry of K: masses that are added before they are inverted, softness that is subtracted,
// squares of whole arms.
#include "derive/diff/slips/slips.hpp"
#include "derive/diff/terms.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

// The sum of two inverse masses (or inertias) as something else; what each entry of K reads is their sum.
std::optional<Slip> reduced(const Whole& whole, const std::string& kind, const std::string& a, const std::string& b) {
  const std::string first = fmt::format("inv_{}_{}", kind, a), second = fmt::format("inv_{}_{}", kind, b);
  struct Total {
    double (*value)(double m, double n);
    const char* words;
  };
  constexpr Total totals[] = {{[](double m, double n) { return 1 / (m + n); }, "1/({0}({1}) + {0}({2}))"},
                              {[](double m, double n) { return m * n / (m + n); },
                               "the reduced {0}, {0}({1})*{0}({2})/({0}({1}) + {0}({2})),"}};
  for (const auto& [value, words] : totals) {
    const bool found = whole.at_changed([&, value = value](Sample& sample) {
      const auto m = sample.scalars.find(first), n = sample.scalars.find(second);
      if (m == sample.scalars.end() || n == sample.scalars.end()) return;
      m->second = value(1 / m->second, 1 / n->second), n->second = 0;
    });
    if (!found) continue;
    return Slip{"inverse", fmt::format("{} stands where 1/{}({}) + 1/{}({}) belongs",
                                       fmt::format(fmt::runtime(words), kind, a, b), kind, a, kind, b)};
  }
  return {};
}

std::optional<Slip> reduced_masses(const Whole& whole) {
  const auto& bodies = whole.entry.joint.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j)
      for (const char* kind : {"m", "I"})
        if (std::optional<Slip> slip = reduced(whole, kind, bodies[i], bodies[j])) return slip;
  return {};
}

// K - softness in place of K + softness.
std::optional<Slip> subtracted_softness(const Whole& whole) {
  const Expr added = difference_of(whole.hand.at(0, 0), whole.mine.at(0, 0), whole.entry.joint);
  if (free_symbols(added).empty()) return {};
  const bool same = whole.is([&](std::size_t i) {
    List K = whole.generated[i];
    const double softness = values_at({added}, whole.samples()[i])[0];
    for (int r = 0; r < whole.mine.rows; ++r) K[whole.at(r, r)] += softness < 0 ? softness : std::nan("");
    return K;
  });
  if (!same) return {};
  const std::string right = in_names_of_spec(brief_text(-added, whole.entry.joint), whole.entry.joint);
  return Slip{"sign", fmt::format("softness makes K larger: the diagonal has -{0} where +{0} belongs", right)};
}

// In the plane: |r|^2/I in place of perp(r) perp(r)'/I, as if a pull along the arm turned the body; r r'/I too much.
std::optional<Slip> whole_arms(const Whole& whole) {
  const Joint& joint = whole.entry.joint;
  if (joint.dimension != 2 || whole.mine.rows != 2) return {};
  std::vector<const Parameter*> arms;
  for (const Parameter& p : joint.parameters)
    if (p.kind == ParameterKind::point && p.body >= 0) arms.push_back(&p);
  const auto is_with = [&](const std::vector<const Parameter*>& some) {
    return whole.is([&](std::size_t i) {
      List K = whole.generated[i];
      for (const Parameter* arm : some) {
        const List r = values_at(components_of(arm->symbol), whole.samples()[i]);
        const double inverse = values_at({inverse_inertia(*joint.pool, arm->body)}, whole.samples()[i])[0];
        for (std::size_t k = 0; k < K.size(); ++k) K[k] += inverse * r[k / 2] * r[k % 2];
      }
      return K;
    });
  };
  const auto words = [](const std::string& of, const std::string& r) {
    return Slip{"factor", fmt::format("{0}|{1}|^2 E stands where perp({1}) perp({1})' belongs", of, r)};
  };
  if (arms.size() > 1 && is_with(arms)) return words("of all bodies, ", "r");
  for (const Parameter* arm : arms)
    if (is_with({arm})) return words("", arm->symbol->symbol);
  return {};
}

}  // namespace

std::optional<Slip> slip_of_diagonal(const Whole& whole) {
  if (whole.what != "K" || whole.mine.rows < 2) return {};
  return first_of({reduced_masses, subtracted_softness, whole_arms}, whole);
}

}  // namespace cdot::derive
