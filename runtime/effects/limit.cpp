// A limit on a coordinate: lower <= C <= upper. Equal ends make a lock.
#include <cmath>
#include <fmt/format.h>

#include "runtime/effects/effect.hpp"
#include "runtime/rows/laws.hpp"

namespace cdot {
namespace {

// --- limit: lower <= C <= upper. Constants: lower, upper. One row serves the nearer side.

template <class T>
bool nearer_to_lower(T C, const T* limits) {
  return C - limits[0] < limits[1] - C;
}

template <class S>
void fill_limit(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings& settings) {
  using T = typename S::Scalar;
  for (int i = begin; i < end; ++i) {
    const T* limits = batch.constants.data() + 2 * i;
    if (nearer_to_lower(batch.C[i], limits)) {
      batch.lower[i] = T(0);
      batch.upper[i] = T(unlimited);
      batch.bias[i] += unilateral_bias(batch.C[i] - limits[0], h, settings);
    } else {
      batch.lower[i] = -T(unlimited);
      batch.upper[i] = T(0);
      batch.bias[i] -= unilateral_bias(limits[1] - batch.C[i], h, settings);
    }
  }
}

template <class S>
void error_limit(const Batch<S>& batch, int slot, typename S::Scalar* error) {
  using T = typename S::Scalar;
  const T C = batch.C[slot], *limits = batch.constants.data() + 2 * slot;
  *error = nearer_to_lower(C, limits) ? std::fmin(C - limits[0], T(0)) : std::fmax(C - limits[1], T(0));
}

template <class S>
void guard_limit(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guard) {
  using T = typename S::Scalar;
  const T C = batch.C[slot], *limits = batch.constants.data() + 2 * slot;
  *guard = nearer_to_lower(C, limits) ? Guard<T>{C - limits[0], T(0), T(0), T(unlimited)}
                                      : Guard<T>{C - limits[1], T(0), -T(unlimited), T(0)};
}

// --- lock: C = at. Constants: at.

template <class S>
void fill_lock(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings& settings) {
  using T = typename S::Scalar;
  const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) / h : T(0);
  for (int i = begin; i < end; ++i) batch.bias[i] += share * (batch.C[i] - batch.constants[i]);
}

template <class S>
void error_lock(const Batch<S>& batch, int slot, typename S::Scalar* error) {
  *error = batch.C[slot] - batch.constants[slot];
}

template <class S>
void guard_lock(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guard) {
  using T = typename S::Scalar;
  *guard = {batch.C[slot] - batch.constants[slot], T(0), -T(unlimited), T(unlimited)};
}

template <class S>
constexpr Law<S> limit_law{2, false, fill_limit<S>, error_limit<S>, nullptr, nullptr, guard_limit<S>};
template <class S>
constexpr Law<S> lock_law{1, false, fill_lock<S>, error_lock<S>, nullptr, nullptr, guard_lock<S>};

}  // namespace

static std::array<double, 2> constants_of(const Limit& limit) {
  const double lower = limit.lower.value_or(-unlimited), upper = limit.upper.value_or(unlimited);
  if (!(lower <= upper))
    throw Error(fmt::format("a limit's lower end {} must not lie above its upper end {}", lower, upper));
  if (!limit.lower && !limit.upper) throw Error("a limit needs a lower or an upper end");
  return {lower, upper};
}

template <class S>
static NamedLaw<S> law_of(const Limit& limit) {
  const auto [lower, upper] = constants_of(limit);
  if (lower == upper) return {lock_law<S>, "lock (a limit that was added with equal ends)"};
  return {limit_law<S>, "limit with two ends"};
}

#define CDOT_INSTANTIATE(S) CDOT_INSTANTIATE_EFFECT(S, Limit)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

#ifndef CDOT_EXTENDED  // the keys of a scene are the same in every precision
namespace {

std::optional<EffectKind::Wrong> take_limit(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  if (!n[0].written && !n[1].written) return EffectKind::Wrong{"a limit without `lower` or `upper`", ""};
  const Limit limit{n[0].value, n[1].value};
  if (limit.lower || limit.upper) effects.limit = limit;
  if (!limit.lower || !limit.upper || *limit.lower <= *limit.upper) return {};
  return EffectKind::Wrong{
      fmt::format("the lower limit {:.6g} is above the upper limit {:.6g}", *limit.lower, *limit.upper), ""};
}

}  // namespace

const EffectKind limit_kind{"limit",
                            "[lower, upper], { lower = 0 } or { upper = 1 }",
                            "`[lower, upper]`, `{ lower = … }` or `{ upper = … }`; `[x, x]` locks the coordinate at x",
                            EffectKind::pair,
                            {{"lower", EffectNumber::as_coordinate}, {"upper", EffectNumber::as_coordinate}},
                            take_limit};
#endif

}  // namespace cdot
