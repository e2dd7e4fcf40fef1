// The lever of the body that carries a curve or surface, from that of the body which moves on it.
#include <algorithm>
#include <cmath>
#include <optional>

#include "derive/derivation/gradient.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {
namespace {

constexpr std::uint64_t samples = 4;
constexpr double round_off = 1e-9;

bool acts(const JacobianEntry& entry) { return !is_zero(entry.v) || !is_zero(entry.w); }

// The u of w = u × n; zero if w is.
std::optional<Expr> lever_of(Expr w, Expr n) {
  const Term force = split_coefficient(n), turn = split_coefficient(w);
  if (is_zero(w)) return zero_vector(*n->pool);
  if (turn.e->kind != Kind::cross) return {};
  const Rational factor = turn.coef / force.coef;
  const Expr u = turn.e->args[0], v = turn.e->args[1], opposite = -force.e;
  if (v == force.e || u == opposite) return v == force.e ? factor * u : factor * v;
  if (u == force.e || v == opposite) return u == force.e ? -factor * v : -factor * u;
  return {};
}

bool is_long(const JacobianEntry& entry) {
  const std::vector<Term> terms = terms_of(entry.w);
  return !is_zero(entry.v) && terms.size() > 1 &&
         !std::ranges::all_of(terms, [&](const Term& term) { return lever_of(term.e, entry.v).has_value(); });
}

bool equal_at_random_poses(Expr w, Expr other, const Joint& joint) {
  std::vector<Expr> both = components_of(w);
  const std::vector<Expr> components = components_of(other);
  const std::size_t size = both.size();
  both.insert(both.end(), components.begin(), components.end());
  for (std::uint64_t seed = 1; seed <= samples; ++seed) {
    const std::vector<double> values = values_at(both, random_sample(joint, both, seed));
    for (std::size_t i = 0; i < size; ++i)
      if (!(std::abs(values[i] - values[size + i]) <= round_off * (1 + std::abs(values[i])))) return false;
  }
  return true;
}

}  // namespace

bool has_long_lever(const ScalarRow& row) { return std::ranges::any_of(row.J, is_long); }

void shorten_lever_of_carrier(const Joint& joint, ScalarRow& row, const std::vector<JacobianEntry>& whole) {
  std::vector<std::size_t> bodies;
  for (std::size_t b = 0; b < whole.size(); ++b)
    if (acts(whole[b])) bodies.push_back(b);
  if (bodies.size() != 2) return;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t carrier = bodies[i], other = bodies[1 - i];
    Expr& w = row.J[carrier].w;
    if (is_zero(whole[other].v) || !is_long(row.J[carrier])) continue;
    const std::optional<Expr> u = lever_of(whole[other].w, whole[other].v);
    if (!u) continue;
    const Expr arm =
        body_symbols(joint, static_cast<int>(other)).x + *u - body_symbols(joint, static_cast<int>(carrier)).x;
    const Expr short_w = -cross(arm, whole[other].v);
    if (equal_at_random_poses(w, short_w, joint)) w = short_w;
  }
}

}  // namespace cdot::derive
