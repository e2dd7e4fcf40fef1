// One slip on every diagonal entry of K: masses that are added before they are inverted, softness that is subtracted.
#include "derive/diff/slips/slips.hpp"
#include "derive/diff/terms.hpp"

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
    const bool found = whole.at_changed([&](Sample& sample) {
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

}  // namespace

std::optional<Slip> slip_of_diagonal(const Whole& whole) {
  if (whole.what != "K" || whole.mine.rows < 2) return {};
  return first_of({reduced_masses, subtracted_softness}, whole);
}

}  // namespace cdot::derive
