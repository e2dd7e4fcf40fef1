#include "runtime/events/impacts.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/bonds.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/projection.hpp"

namespace cdot {
namespace {

// True if a row stops or drives its bodies by an impulse: an end that is met, a latch that closes, or a clutch of
// unlimited force that meets a rate beyond its own. `missing` is what the row lacks to its rate; has_events: it may be
// a latch, which from its event on holds its bodies on both sides.
template <class T>
bool strikes(const Guard<T>& guard, const Resolution<T>& resolution, T missing, bool has_events) {
  const T bound = missing > T(0) ? guard.upper : guard.lower;
  const bool may_act = guard.one_sided() ? guard.gap() <= resolution.C
                       : guard.of_rate   ? !guard.bilateral()
                                         : has_events;
  return may_act && std::isinf(bound) && std::abs(missing) > resolution.rate;
}

// True if an impact at another row may call for an impulse of this one.
template <class T>
bool may_strike(const Guard<T>& guard, const Resolution<T>& resolution, bool loaded) {
  if (loaded) return true;
  if (guard.one_sided()) return guard.gap() <= resolution.C;
  return guard.bilateral() || (guard.of_rate && (std::isinf(guard.lower) || std::isinf(guard.upper)));
}

// The row that strikes hardest, in units of its resolution.
template <class S>
Blow what_hits(Island<S>& island) {
  using T = typename S::Scalar;
  T hardest = 0;
  Blow blow;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    const T missing = guard.rate - (batch.rate[i] + batch.bias[i]), share = std::abs(missing) / resolution.rate;
    if (!strikes(guard, resolution, missing, batch.law->distance && island.kinked < 0) || !(share > hardest)) return;
    hardest = share, blow.source = static_cast<int>(batch.source);
  });
  return blow;
}

// Bounds of impulses: rows at their ends only push; motors with a bounded force do not act.
template <class S>
void offer_impulses(Island<S>& island) {
  using T = typename S::Scalar;
  clear_laws(island);
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (!may_strike(guard, resolution, batch.law->by_load != nullptr)) return;
    batch.lower[i] = std::isinf(guard.lower) ? guard.lower : T(0);
    batch.upper[i] = std::isinf(guard.upper) ? guard.upper : T(0);
    batch.bias[i] -= guard.rate;
  });
}

// Rows that have struck are `held`, because sweeps leave a rate that is not exactly 0.
template <class S>
void hold_what_struck(Island<S>& island) {
  using T = typename S::Scalar;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (!may_strike(guard, resolution, batch.law->by_load != nullptr)) return;
    batch.bias[i] += guard.rate;
    const bool slips = batch.law->by_load && !(batch.lower[i] < batch.lambda[i] && batch.lambda[i] < batch.upper[i]);
    if (batch.lambda[i] != T(0) && !slips) batch.mode[i] = Mode::held;
  });
}

// Adds the impulses to those of the step.
template <class S>
void count_impulses(const Island<S>& island) {
  for (const Segment<S>& segment : island.segments)
    for (int i = segment.begin * segment.batch->ops->rows; i < segment.end * segment.batch->ops->rows; ++i)
      segment.batch->correction[i] += segment.batch->lambda[i];
}

}  // namespace

template <class S>
bool stop_what_hits(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h, Blow& blow) {
  find_rates(world, island);
  const Blow now = what_hits(island);
  if (now.source < 0) return false;
  blow = now, blow.left = kinetic_energy(world, island);
  offer_impulses(island);
  solve(world, island, world.bodies.velocity.data());
  hold_what_struck(island);
  end_blow(world, island, blow);
  count_impulses(island);
  if (!island.flow.locates) return false;
  const auto lasts = world.settings.local_error > 0 ? typename S::Scalar(impact_time) : h;
  find_rates(world, island);
  const bool latched = latch_by_lambda(island, lasts), broken = break_by_lambda(world, island, time, lasts);
  if (latched || broken) fill_lambda(island, typename S::Scalar(0));  // no forces
  return latched || broken;
}

template <class S>
void end_blow(WorldData<S>& world, const Island<S>& island, Blow& blow) {
  const double left = kinetic_energy(world, island), lost = blow.left - left;
  blow.left = left;
  if (lost >= 0) take(world, static_cast<Source>(blow.source), lost);
  else put_in(world, static_cast<Source>(blow.source), -lost);  // by an end that moves
}

#define CDOT_INSTANTIATE(S)                                                             \
  template bool stop_what_hits(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar, Blow&); \
  template void end_blow(WorldData<S>&, const Island<S>&, Blow&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
