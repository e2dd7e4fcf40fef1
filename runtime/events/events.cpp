#include "runtime/events/events.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/bonds.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/events/impacts.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/events/resolution.hpp"
#include "runtime/events/slackening.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/cones.hpp"
#include "runtime/solve/loads.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

template <class T>
constexpr T infinite = std::numeric_limits<T>::infinity();

// Those of all guarded rows at the present dv/dt. choose_modes() calls this without and with the joints' forces.
template <class S>
void find_resolution(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  auto* resolution = island.flow.resolution.data();
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    find_resolution(world, island, batch, slot, h, resolution);
    resolution += batch.ops->rows;
  });
}

// True if a row reaches a speed of its own by an impulse.
template <class S>
bool has_strong_motor(Island<S>& island) {
  using T = typename S::Scalar;
  bool any = false;
  each_guarded_row(island, [&](Batch<S>&, int, const Guard<T>& guard, const Resolution<T>&) {
    any |= guard.bilateral() && guard.rate != T(0);
  });
  return any;
}

// Sets the bounds of each row's force and a first mode. True if the forces must decide about some rows. A row that has
// just met its rate misses it by the resolution of the step before. Its own is found without the forces of effects and
// joints, and may be much finer.
template <class S>
bool offer_bounds(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  bool open = false;
  find_rates(world, island);
  clear_laws(island);
  auto way = island.flow.ways.begin();
  each_guarded_row(
      island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<typename S::Scalar>& resolution) {
        const T met = (way++)->met, rate = guard.one_sided() ? resolution.rate : std::max(met, resolution.rate);
        if (batch.law->cone_rows > 0) return;
        const T missing = missing_of(batch, i, guard);
        const bool hops = guard.one_sided() && missing * missing <= resolution.hop;
        const Mode noted = std::exchange(batch.mode[i], Mode::held);  // held: it has struck
        const bool slow = std::abs(missing) <= T(4) * rate || hops || noted == Mode::held;
        batch.lower[i] = guard.lower;
        batch.upper[i] = guard.upper;
        if (guard.one_sided() && !(slow && guard.gap() <= resolution.C)) {
          batch.mode[i] = Mode::off;
          batch.lower[i] = batch.upper[i] = 0;
        } else if (!guard.bilateral() && !guard.one_sided() && !slow) {
          batch.mode[i] = missing > T(0) ? Mode::pushed : Mode::pulled;
          batch.lower[i] = batch.upper[i] = missing > T(0) ? guard.upper : guard.lower;
        }
        if (noted == Mode::pressed) {  // it holds on both sides, whatever the forces are
          batch.mode[i] = noted, batch.lower[i] = -infinite<T>, batch.upper[i] = infinite<T>;
        } else if (guard.bilateral() && (noted == Mode::pushed || noted == Mode::pulled)) {  // a motor that ends stop
          batch.mode[i] = noted, batch.lower[i] = batch.upper[i] = 0;
        }
        open |= !guard.bilateral();
      });
  return offer_bounds_to_cones(island) || open;
}

// Forces and accelerations are complementary: a row stays held if its force lies within the bounds. With a force at a
// bound the row lets go or slips.
template <class S>
void decide_by_forces(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  ask_for_gamma(world, island, time);
  solve(world, island, world.bodies.velocity_rate.data());
  if (let_go_of_slackening_rows(world, island, time)) {
    ask_for_gamma(world, island, time);
    solve(world, island, world.bodies.velocity_rate.data());
  }
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<typename S::Scalar>&) {
    if (batch.mode[i] != Mode::held || batch.law->cone_rows > 0) return;
    const T force = batch.lambda[i];
    if (!guard.bilateral() && (force <= batch.lower[i] || force >= batch.upper[i])) {
      batch.mode[i] = guard.one_sided() ? Mode::off : force >= batch.upper[i] ? Mode::pushed : Mode::pulled;
      batch.lower[i] = batch.upper[i] = force;
    } else {
      batch.lower[i] = -infinite<T>;
      batch.upper[i] = infinite<T>;
    }
  });
  decide_about_cones(island);
}

// The margin of one row from its own bounds; infinite if no event is possible, or if the row shares its bound with
// others of a cone.
template <class S>
typename S::Scalar margin_within(const Batch<S>& batch, int i, const Guard<typename S::Scalar>& guard,
                                 const Resolution<typename S::Scalar>& resolution, typename S::Scalar rate) {
  using T = typename S::Scalar;
  const T force = batch.lambda[i];
  if (batch.law->cone_rows > 0) return infinite<T>;
  switch (batch.mode[i]) {
    case Mode::off:  // ends that have met since: there was no way between them
      return (guard.bilateral() ? -std::abs(guard.off_by) : guard.gap()) / resolution.C;
    case Mode::held:
      return std::min(force - guard.lower, guard.upper - force) / (resolution.force + slight<T> * std::abs(force));
    case Mode::pushed:
    case Mode::pulled:
      if (guard.lower == guard.upper) return infinite<T>;
      return (batch.mode[i] == Mode::pushed ? guard.rate - rate : rate - guard.rate) / resolution.rate;
    case Mode::pressed:
    case Mode::gripped:
    case Mode::bounded: break;
  }
  return infinite<T>;
}

// The same, or from an event of the row that has not happened.
template <class S>
typename S::Scalar margin_of(const Batch<S>& batch, int i, const Guard<typename S::Scalar>& guard,
                             const Resolution<typename S::Scalar>& resolution, typename S::Scalar rate) {
  using T = typename S::Scalar;
  T margin = margin_within(batch, i, guard, resolution, rate), from[2];
  if (!batch.law->distance) return margin;
  batch.law->distance(batch, i, rate, batch.lambda[i], from);
  const int happened = static_cast<int>(batch.happened[i]);
  for (const int which : {0, 1})
    if (!(happened & (1 << which))) margin = std::min(margin, from[which] / at_event<T>);
  return margin;
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
  const auto rows = static_cast<size_t>(flow.guarded);
  // Sweeps share the load among redundant joints only where asked (RowSolver::share): bonds wait for the step's end.
  const size_t bonds = island.solver->exact ? island.bonds.size() : 0;
  flow.row_rates.assign(rows, infinite<T>);
  for (auto* margins : {&flow.margins, &flow.margins_chosen}) margins->assign(rows + bonds, infinite<T>);
  for (auto* margins : {&flow.low, &flow.high}) margins->assign(rows + bonds, infinite<T>);
  flow.ways.assign(rows, {});
  flow.resolution.assign(rows, Resolution<T>{});
}

namespace {

// A row that forces decided to hold lets go where it lacks some of them, in units of its resolution; events are found
// up to 3 late. Where joints nearly imply the row, the solver made it slightly soft to decide. True if any row lets go.
template <class S>
bool let_go_of_overloaded(Island<S>& island) {
  using T = typename S::Scalar;
  constexpr double overloaded = -5;
  bool any = false;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<T>& resolution) {
    if (batch.mode[i] != Mode::held || guard.bilateral() || guard.one_sided() || batch.law->cone_rows > 0) return;
    if (!(double(margin_within(batch, i, guard, resolution, T(0))) < overloaded)) return;
    batch.mode[i] = batch.lambda[i] > guard.upper ? Mode::pushed : Mode::pulled;
    batch.lower[i] = batch.upper[i] = batch.mode[i] == Mode::pushed ? guard.upper : guard.lower;
    any = true;
  });
  return any;
}

// False if a blow ended a joint or a row, or another one follows: choose again.
template <class S>
bool choose_modes_once(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h,
                       Blow& blow) {
  using T = typename S::Scalar;
  if (island.flow.guarded > 0) {
    std::fill(island.flow.resolution.begin(), island.flow.resolution.end(), Resolution<typename S::Scalar>{});
    find_rates(world, island);
    latch_by_lambda(island, T(1));
    free_accelerations(world, island);
    find_resolution(world, island, h);
    find_pressed_ends(world, island);
    if (stop_what_hits(world, island, time, h, blow)) return false;
    if (start_motors(world, island, time, h)) return false;
    if (offer_bounds(world, island)) {
      decide_by_forces(world, island, time);
      evaluate_anew(world, island, time);
    }
  }
  const bool is_kinked = island.kinked >= 0, starts_motor = !is_kinked && has_strong_motor(island);
  const double before = starts_motor ? kinetic_energy(world, island) : 0;
  project_velocities_at_start(world, island);
  if (starts_motor) put_in(world, Source::motor, kinetic_energy(world, island) - before);
  else if (blow.source >= 0 && !is_kinked) end_blow(world, island, blow);
  note_rates(world, island);
  if (another_follows(island, blow)) return false;
  accelerate(world, island, time);
  find_resolution(world, island, h);
  while (let_go_of_overloaded(island)) {
    island.factored = false;
    accelerate(world, island, time);
    find_resolution(world, island, h);
  }
  return true;
}

// Of rows that have passed their events at the end of the last step.
template <class S>
void note_met_rates(Island<S>& island) {
  Flow<S>& flow = island.flow;
  for (size_t k = 0; k < flow.ways.size(); ++k)
    flow.ways[k].met = double(flow.margins[k]) < event_threshold(flow, k) ? flow.resolution[k].rate : 0;
}

// True if forces at the present state make events happen: a pin that is too weak from the start.
template <class S>
bool forces_make_events(WorldData<S>& world, Island<S>& island) {
  bool any = false;
  each_guarded_slot(island, [&](Batch<S>& batch, int) { any |= batch.law->distance != nullptr; });
  if (!any) return false;
  find_rates(world, island);
  return latch_by_lambda(island, typename S::Scalar(1));
}

}  // namespace

template <class S>
void choose_modes(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h) {
  Blow blow;
  note_met_rates(island);
  while (!choose_modes_once(world, island, time, h, blow) ||
         (island.flow.guarded > 0 && forces_make_events(world, island)) ||
         break_by_lambda(world, island, time, typename S::Scalar(1))) {
  }
  measure_margins(world, island, time);
  island.flow.margins_chosen = island.flow.margins;
}

template <class S>
void note_rates(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (island.flow.guarded == 0) return;
  find_rates(world, island);
  size_t k = 0;
  each_guarded_row(island, [&](Batch<S>& batch, int i, const Guard<T>&, const Resolution<typename S::Scalar>&) {
    island.flow.row_rates[k++] = batch.rate[i] + batch.bias[i];
  });
}

template <class S>
void measure_margins(const WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  size_t k = 0;
  each_guarded_row(
      island, [&](Batch<S>& batch, int i, const Guard<T>& guard, const Resolution<typename S::Scalar>& resolution) {
        island.flow.margins[k] = margin_of(batch, i, guard, resolution, island.flow.row_rates[k]);
        ++k;
      });
  measure_margins_of_cones(island);
  measure_margins_of_bonds(world, island, double(time));
}

template <class S>
typename S::Scalar margin_of_row(const Batch<S>& batch, int i, const Resolution<typename S::Scalar>& resolution,
                                 typename S::Scalar rate) {
  Guard<typename S::Scalar> guard;  // a coordinate has one row
  batch.law->guard(batch, i, &guard);
  return margin_of(batch, i, guard, resolution, rate);
}

template <class S>
void drop_modes(Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) batch.mode[i] = Mode::bounded;
  }
}

#define CDOT_INSTANTIATE(S)                                                                        \
  template void count_guarded_rows(Island<S>&);                                                    \
  template void choose_modes(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar);                     \
  template void note_rates(WorldData<S>&, Island<S>&);                                             \
  template void measure_margins(const WorldData<S>&, Island<S>&, S::Scalar);                       \
  template S::Scalar margin_of_row(const Batch<S>&, int, const Resolution<S::Scalar>&, S::Scalar); \
  template void drop_modes(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
