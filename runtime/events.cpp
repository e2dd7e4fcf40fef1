#include "runtime/events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/hold.hpp"
#include "runtime/spaces.hpp"

namespace cdot {
namespace {

// Of C [m, rad] and of rates [m/s, rad/s]: what is not told apart. Forces: this share of their size.
template <class T>
constexpr T slight = T(by_precision<T>(1e-4, 1e-9));
template <class T>
constexpr T infinite = std::numeric_limits<T>::infinity();

// f(batch, slot, row, index, guard) for every row that comes and goes, guards at the C at hand.
template <class S, class F>
void each_guarded_row(const Island<S>& island, F f) {
  using T = typename S::Scalar;
  Guard<T> guards[most_rows];
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->guard) continue;
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      batch.law->guard(batch, slot, guards);
      for (int r = 0; r < batch.ops->rows; ++r) f(batch, slot * batch.ops->rows + r, guards[r]);
    }
  }
}

// J v of every row under a law, into the batches' scratch.
template <class S>
void find_rates(WorldState<S>& world, Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    if (!segment.batch->law) continue;
    const auto* velocity = world.bodies.velocity.data();
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, velocity, segment.batch->scratch.data());
  }
}

template <class S>
void clear_laws(Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i)
      batch.softness[i] = batch.lower[i] = batch.upper[i] = 0;
  }
}

template <class S>
void solve(WorldState<S>& world, Island<S>& island) {
  island.factored = false;
  if (world.settings.solver == Solver::direct) return solve_direct(world, island);
  factorize_rows(world, island);
  solve_iterative(world, island, typename S::Scalar(0));
}

// Whatever closes where it touches stops, without rebound: J v >= 0 there, impulses >= 0. What has stopped is `held`: by
// sweeps its rate is not quite 0. A motor's force is nothing beside an impulse, unless it has no bound.
template <class S>
void stop_what_hits(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  bool hits = false;
  find_rates(world, island);
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    const T rate = batch.scratch[i] + batch.bias[i];
    hits |= guard.one_sided() && guard.gap() <= slight<T> && (guard.lower == T(0) ? rate : -rate) < -slight<T>;
  });
  if (!hits) return;
  clear_laws(island);
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    if (!guard.bilateral() && !(guard.one_sided() && guard.gap() <= slight<T>)) return;
    batch.lower[i] = guard.lower;
    batch.upper[i] = guard.upper;
    batch.bias[i] -= guard.rate;
  });
  solve(world, island);
  for (const Segment<S>& segment : island.segments)
    for (int i = segment.begin * segment.batch->ops->rows; i < segment.end * segment.batch->ops->rows; ++i)
      segment.batch->correction[i] += segment.batch->lambda[i];
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    if (!guard.bilateral() && !(guard.one_sided() && guard.gap() <= slight<T>)) return;
    batch.bias[i] += guard.rate;
    if (batch.lambda[i] != T(0)) batch.mode[i] = Mode::held;
  });
}

// What each row may do, as bounds of its force. True if for some it depends on the forces.
template <class S>
bool offer_bounds(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  bool open = false;
  find_rates(world, island);
  clear_laws(island);
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    const T missing = guard.rate - (batch.scratch[i] + batch.bias[i]);
    const bool slow = std::abs(missing) <= T(4) * slight<T> || batch.mode[i] == Mode::held;
    batch.mode[i] = Mode::held;
    batch.lower[i] = guard.lower;
    batch.upper[i] = guard.upper;
    if (guard.bilateral()) return;
    open = true;
    if (guard.one_sided() && !(slow && guard.gap() <= slight<T>)) {
      batch.mode[i] = Mode::off;
      batch.lower[i] = batch.upper[i] = 0;
    } else if (!guard.one_sided() && !slow) {
      batch.mode[i] = Mode::pushed;
      batch.lower[i] = batch.upper[i] = missing > T(0) ? guard.upper : guard.lower;
    }
  });
  return open;
}

// Forces and accelerations are complementary: what might hold does, as far as its bounds allow. A force at a bound: the
// row lets go, or slips.
template <class S>
void decide_by_forces(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  ask_for_gamma(world, island, time);
  std::swap(world.bodies.velocity, world.bodies.velocity_rate);
  solve(world, island);
  std::swap(world.bodies.velocity, world.bodies.velocity_rate);
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    if (batch.mode[i] != Mode::held) return;
    const T force = batch.lambda[i];
    if (!guard.bilateral() && (force <= batch.lower[i] || force >= batch.upper[i])) {
      batch.mode[i] = guard.one_sided() ? Mode::off : Mode::pushed;
      batch.lower[i] = batch.upper[i] = force;
    } else {
      batch.lower[i] = -infinite<T>;
      batch.upper[i] = infinite<T>;
    }
  });
}

// Of one row; infinite where nothing can happen.
template <class S>
typename S::Scalar margin_of(const Batch<S>& batch, int i, const Guard<typename S::Scalar>& guard,
                             typename S::Scalar rate) {
  using T = typename S::Scalar;
  const T force = batch.lambda[i];
  switch (batch.mode[i]) {
    case Mode::off:
      return guard.gap() / slight<T>;
    case Mode::held:
      return std::min(force - guard.lower, guard.upper - force) / (slight<T> * (T(1) + std::abs(force)));
    case Mode::pushed:
      if (guard.lower == guard.upper) return infinite<T>;
      return (force == guard.upper ? guard.rate - rate : rate - guard.rate) / slight<T>;
    case Mode::bounded:
      break;
  }
  return infinite<T>;
}

}  // namespace

template <class S>
void count_guarded_rows(Island<S>& island) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  flow.guarded = 0;
  for (const Segment<S>& segment : island.segments)
    if (segment.batch->law && segment.batch->law->guard)
      flow.guarded += (segment.end - segment.begin) * segment.batch->ops->rows;
  for (auto* margins : {&flow.row_rates, &flow.margins, &flow.margins_chosen, &flow.low, &flow.high})
    margins->assign(static_cast<size_t>(flow.guarded), infinite<T>);
}

template <class S>
void choose_modes(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  if (island.flow.guarded > 0) {
    stop_what_hits(world, island);
    if (offer_bounds(world, island)) {
      decide_by_forces(world, island, time);
      evaluate_anew(world, island, time);
    }
  }
  hold_velocities(world, island);
  island.factored = world.settings.solver == Solver::direct;
  note_rates(world, island);
  accelerate(world, island, time);
  measure_margins(island);
  island.flow.margins_chosen = island.flow.margins;
}

template <class S>
void note_rates(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (island.flow.guarded == 0) return;
  find_rates(world, island);
  size_t k = 0;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>&) {
    island.flow.row_rates[k++] = batch.scratch[i] + batch.bias[i];
  });
}

template <class S>
void measure_margins(Island<S>& island) {
  using T = typename S::Scalar;
  size_t k = 0;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard) {
    island.flow.margins[k] = margin_of(batch, i, guard, island.flow.row_rates[k]);
    ++k;
  });
}

template <class S>
void drop_modes(Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) batch.mode[i] = Mode::bounded;
  }
}

#define CDOT_INSTANTIATE(S)                                          \
  template void count_guarded_rows(Island<S>&);                      \
  template void choose_modes(WorldState<S>&, Island<S>&, S::Scalar); \
  template void note_rates(WorldState<S>&, Island<S>&);              \
  template void measure_margins(Island<S>&);                         \
  template void drop_modes(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
