#include "runtime/events/latch.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/solve/misfits.hpp"

namespace cdot {
namespace {

template <class S>
bool has_events(const Segment<S>& segment) {
  return segment.batch->law && segment.batch->law->distance && segment.begin < segment.end;
}

// Notes the events of the island's rows with the load of row i by load(batch, i).
template <class S, class Load>
bool latch_events(Island<S>& island, Load load) {
  using T = typename S::Scalar;
  bool any = false;
  for (const Segment<S>& segment : island.segments) {
    if (!has_events(segment)) continue;
    Batch<S>& batch = *segment.batch;
    for (int i = segment.begin; i < segment.end; ++i) {  // a coordinate has one row
      T from[2];
      batch.law->distance(batch, i, batch.rate[i], load(batch, i), from);
      const int before = static_cast<int>(batch.happened[i]);
      const int now = before | (from[0] <= at_event<T> ? 1 : 0) | (from[1] <= at_event<T> ? 2 : 0);
      batch.happened[i] = static_cast<Event>(now);  // where a time is unlimited, `from` is NaN: no event
      any |= now != before;
    }
  }
  return any;
}

// How far the island's ends with events are passed, at most. What holds a coordinate on both sides stops it in a step.
template <class S>
typename S::Scalar passed_by(const Island<S>& island) {
  using T = typename S::Scalar;
  T worst = 0;
  for (const Segment<S>& segment : island.segments) {
    if (!has_events(segment) || !segment.batch->law->error) continue;
    for (int i = segment.begin; i < segment.end; ++i) {
      Guard<T> guard;
      segment.batch->law->guard(*segment.batch, i, &guard);
      if (guard.one_sided()) worst = std::max(worst, -guard.gap());
    }
  }
  return worst;
}

// The events at the end of a substep of h. Methods that locate events have found those of the step.
template <class S>
bool meet_events(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  if (island.flow.locates) return false;
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    if (!has_events(segment)) continue;
    Batch<S>& batch = *segment.batch;
    // C alone is rounded otherwise than beside J, which a state restored has.
    if (!island.evaluated) batch.ops->position(batch, segment.begin, segment.end, world.bodies, T(world.time) + h);
    batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity.data(), batch.rate.data());
  }
  return latch_by_impulses(island, h);
}

// A hook of Model::after_substep. An end that began to hold where it is passed is an error of the next start, whose
// projection moves the bodies there. A step that closed it on its way would throw them.
template <class S>
void latch_after_substep(WorldData<S>& world, typename S::Scalar h) {
  using T = typename S::Scalar;
  for (const int index : world.awake) {
    Island<S>& island = world.islands[index];
    island.latched = false;
    if (std::none_of(island.segments.begin(), island.segments.end(), has_events<S>)) continue;
    const bool any = island.latched = meet_events(world, island, h);
    const T by = passed_by(island);
    const bool passed = by > foreign<T> * island.scale;
    if (!any && !(island.flow.locates && passed)) continue;
    if (passed) island.residual = std::max<T>(island.residual, by);
    island.evaluated = island.factored = false;
    island.rested = 0.0;
    island.flow.forget();
  }
}

}  // namespace

template <class S>
bool latch_by_impulses(Island<S>& island, typename S::Scalar h) {
  return latch_events(island,
                      [h](const Batch<S>& batch, int i) { return (batch.lambda[i] + batch.correction[i]) / h; });
}

template <class S>
bool latch_by_lambda(Island<S>& island, typename S::Scalar over) {
  return latch_events(island, [over](const Batch<S>& batch, int i) { return batch.lambda[i] / over; });
}

template <class S>
bool changes_after_substeps(const WorldData<S>& world, const Island<S>& island) {
  return !world.after_substep.empty() && (!island.flow.locates || std::ranges::any_of(island.segments, has_events<S>));
}

template <class S>
bool ends_by_load(const Island<S>& island) {
  using T = typename S::Scalar;
  return std::ranges::any_of(island.segments, [](const Segment<S>& segment) {
    bool any = false;
    for (int i = segment.begin; has_events(segment) && i < segment.end; ++i) {
      T idle[2], loaded[2];
      segment.batch->law->distance(*segment.batch, i, T(0), T(0), idle);
      segment.batch->law->distance(*segment.batch, i, T(0), T(1), loaded);
      any |= std::abs(loaded[1] - idle[1]) > T(0);  // where a time is unlimited, both are NaN
    }
    return any;
  });
}

template <class S>
void watch_events(WorldData<S>& world) {
  const auto has_some = [](const auto& batch) { return batch->law && batch->law->distance; };
  auto& hooks = world.after_substep;
  if (std::ranges::any_of(world.batches, has_some) && std::ranges::find(hooks, &latch_after_substep<S>) == hooks.end())
    hooks.insert(hooks.begin(), latch_after_substep<S>);  // before joints break, whose loads change
  for (Island<S>& island : world.islands) {
    for (const Segment<S>& segment : island.segments) {
      if (!has_events(segment)) continue;
      Batch<S>& batch = *segment.batch;
      batch.ops->evaluate(batch, segment.begin, segment.end, world.bodies, typename S::Scalar(world.time));
      batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity.data(), batch.rate.data());
    }
    latch_by_lambda(island, typename S::Scalar(1));
  }
}

#define CDOT_INSTANTIATE(S)                                                    \
  template bool latch_by_impulses(Island<S>&, S::Scalar);                      \
  template bool latch_by_lambda(Island<S>&, S::Scalar);                        \
  template bool changes_after_substeps(const WorldData<S>&, const Island<S>&); \
  template bool ends_by_load(const Island<S>&);                                \
  template void watch_events(WorldData<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
