#include "runtime/step/leaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cdot/detail/drives.hpp>
#include <cdot/spaces.hpp>

#include "runtime/events/events.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/number/way.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/step/between.hpp"

namespace cdot {
namespace {

// A bound that rises and falls is seen at this many points of the way. More than `unseen` of its largest value, up and
// down again, and the stages of the step may have missed it.
constexpr int looks = 128;
constexpr double unseen = 0.2;

// True if functions of time move the end of the row, its rate or its bounds.
template <class S>
bool moves(const Batch<S>& batch, int i) {
  return batch.law->moving || (batch.driven() && !batch.drives_of(i).empty());
}

template <class S>
void go_to(Batch<S>& batch, int i, typename S::Scalar time) {
  batch.time = time;
  if (batch.driven()) follow(batch, i, i + 1, time);
}

// f(share) with C and the numbers in time at each point of the way, over a step of h that ends at `end`.
template <class S, class F>
void look_along(Batch<S>& batch, int i, const Way<typename S::Scalar>& way, typename S::Scalar end,
                typename S::Scalar h, F f) {
  using T = typename S::Scalar;
  const T C = batch.C[i];
  const bool in_time = moves(batch, i);
  for (int look = 0; look <= looks; ++look) {
    const T share = T(look) / T(looks);
    if (in_time) go_to(batch, i, end - h * (T(1) - share));
    batch.C[i] = way.at(share), f(share);
  }
  if (in_time) go_to(batch, i, end);
  batch.C[i] = C;
}

template <class S>
bool leaps_over_bound(Batch<S>& batch, int i, const Way<typename S::Scalar>& way, typename S::Scalar end,
                      typename S::Scalar h) {
  const bool up = batch.mode[i] == Mode::pushed;
  if (!moves(batch, i) || (!up && batch.mode[i] != Mode::pulled)) return false;
  double first = 0, last = 0, changes = 0, most = 0;
  bool any = false;
  look_along(batch, i, way, end, h, [&](typename S::Scalar) {
    Guard<typename S::Scalar> guard;
    batch.law->guard(batch, i, &guard);
    const double bound = double(up ? guard.upper : guard.lower);
    if (any) changes += std::abs(bound - last);
    else first = bound;
    any = true, last = bound, most = std::max(most, std::abs(bound));
  });
  return std::isfinite(most) && changes - std::abs(last - first) > unseen * most;
}

// The least margin on a way, and the largest at its ends. A way comes near an event if it leaves less than `close` of
// the dip between them. Cubics err by less than that.
constexpr double close = 0.5;
struct Dip {
  double ends = 0, least = 0;
  bool leaps(double threshold) const { return least < threshold; }
  bool comes_near(double threshold) const { return least - threshold < close * (ends - least); }
};

// f(batch, i, k) for each single row that may leap, the k-th of Flow::margins.
template <class S, class F>
void each_single_row(Island<S>& island, F f) {
  size_t k = 0;
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    const size_t first = std::exchange(k, k + static_cast<size_t>(batch.ops->rows));
    if (batch.ops->rows == 1 && batch.law->cone_rows == 0) f(batch, slot, first);
  });
}

// Only a way that turns back, or twice, comes back from an end that stands, or from the place of another event.
template <class S>
bool may_come_back(const Batch<S>& batch, int i, const Way<typename S::Scalar>& way) {
  return (batch.mode[i] == Mode::off || batch.law->distance) && (way.turns_back() || way.may_turn_twice());
}

template <class S>
bool slips(const Batch<S>& batch, int i) {
  return batch.mode[i] == Mode::pushed || batch.mode[i] == Mode::pulled;
}

// A row that slips comes to rest within the step and slips on in its end. Between them it may have stuck.
template <class S>
bool may_rest(const Batch<S>& batch, int i, const Way<typename S::Scalar>& way) {
  return slips(batch, i) && way.turn() > 0 && way.turn() < 1;
}

// An end that moves comes to meet a row and goes away within the step; a prescribed rate that moves is reached and runs
// ahead again. Where the step ends beyond the event, it is found as any other.
template <class S>
bool may_come_and_go(const Batch<S>& batch, int i, const Flow<S>& flow, size_t k) {
  const bool meets = batch.mode[i] == Mode::off || batch.law->distance || slips(batch, i);
  return meets && moves(batch, i) && double(flow.margins[k]) >= event_threshold(flow, k);
}

template <class S>
Dip dip_of_way(Batch<S>& batch, int i, const Way<typename S::Scalar>& way,
               const Resolution<typename S::Scalar>& resolution, typename S::Scalar end, typename S::Scalar h) {
  double first = 0, last = 0, least = 0;
  bool any = false;
  look_along(batch, i, way, end, h, [&](typename S::Scalar share) {
    last = double(margin_of_row(batch, i, resolution, way.rate_at(share) / h));
    if (!std::exchange(any, true)) first = least = last;
    least = std::min(least, last);
  });
  return {std::max(first, last), least};
}

template <class S>
Dip dip_of_rate(const Batch<S>& batch, int i, const Way<typename S::Scalar>& way,
                const Resolution<typename S::Scalar>& resolution, typename S::Scalar h) {
  const auto margin = [&](auto rate) { return double(margin_of_row(batch, i, resolution, rate / h)); };
  return {std::max(margin(way.rate_from), margin(way.rate_to)), margin(way.rate_at(way.turn()))};
}

// The stages of a step resolve a function of time that differs from the cubic with the values and rates at its ends by
// this share of its largest value: 1.5 rad of a sine where forces may make events happen, 3 rad where they work.
constexpr double resolved_events = 0.013, resolved_work = 0.2;

// True if the stages of a step from `time` over h may miss how this number moves.
bool is_unresolved(const Drive& drive, const ProfileSpan& span, double time, double h, double resolved) {
  constexpr int points = 16;
  const ProfileValue start = drive.profile.at(time, span), end = drive.profile.at(time + h, span);
  const Way<double> way{start.value, end.value - start.value, h * start.rate, h * end.rate};
  double differs = 0, most = std::max(std::abs(start.value), std::abs(end.value));
  for (int point = 1; point < points; ++point) {
    const double share = double(point) / points, value = drive.profile.at(time + share * h, span).value;
    differs = std::max(differs, std::abs(value - way.at(share))), most = std::max(most, std::abs(value));
  }
  return differs > resolved * most;
}

// True if the stages of a step may miss how the numbers in time of the island's rows move.
template <class S>
bool leaps_over_functions(const Island<S>& island, double time, double h, double resolved) {
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    for (int slot = segment.begin; batch.driven() && slot < segment.end; ++slot) {
      const ProfileSpan span{batch.spans[2 * static_cast<size_t>(slot)],
                             batch.spans[2 * static_cast<size_t>(slot) + 1]};
      for (const Drive& drive : batch.drives_of(slot))
        if (is_unresolved(drive, span, time, h, resolved)) return true;
    }
  }
  return false;
}

// The state between is looked at in the points between so many parts of the step.
constexpr int looks_between = 32;

// A row of velocities: only its rates within the step tell whether it came to rest.
template <class S>
bool slips_without_place(const Batch<S>& batch, int i) {
  return batch.ops->lacks_position && slips(batch, i);
}

// A row whose events the stages tell, that is before them at the end: one that is held by a bounded force, or slips.
template <class S>
bool is_told_by_stages(const Batch<S>& batch, int i, const Flow<S>& flow, size_t k) {
  const double margin = double(flow.margins[k]);
  const bool told = batch.mode[i] == Mode::held || slips_without_place(batch, i);
  return told && margin >= event_threshold(flow, k) && std::isfinite(margin);
}

// The stage nearest to this share of a step.
template <class Real>
int stage_near(const RungeKutta<Real>& method, double share) {
  int nearest = 0;
  for (int stage = 1; stage < method.stages; ++stage)
    if (std::abs(double(method.c[stage]) - share) < std::abs(double(method.c[nearest]) - share)) nearest = stage;
  return nearest;
}

// Values at the stages differ from the cubic through four of these by `differs` at most, and values between the stages
// by no more than a few times that.
constexpr double times_between = 3;
constexpr int least_stages = 8;  // that leave some to compare with

// True if so many values are known.
template <class Real>
bool knows_stages(const RungeKutta<Real>& method) {
  return !method.implicit && method.stages >= least_stages;
}

// The cubic through the values at four stages, at this share of a step.
template <class Real, class T>
double cubic_through_stages(const RungeKutta<Real>& method, const T* value, double share) {
  const int nodes[] = {0, stage_near(method, 1.0 / 3), stage_near(method, 2.0 / 3), stage_near(method, 1)};
  double cubic = 0;
  for (const int node : nodes) {
    double weight = double(value[node]);
    for (const int other : nodes)
      if (other != node) weight *= (share - double(method.c[other])) / double(method.c[node] - method.c[other]);
    cubic += weight;
  }
  return cubic;
}

// True if the force of a held row may be further between the stages than what is left of its bounds.
template <class S>
bool is_unresolved(const Flow<S>& flow, const RungeKuttaOf<S>& method, size_t k) {
  using T = typename S::Scalar;
  if (!knows_stages(method)) return false;
  const T* const force = flow.at_stages.data() + k * most_stages;
  double differs = 0, most = 0;
  for (int stage = 0; stage < method.stages; ++stage) {
    const double cubic = cubic_through_stages(method, force, double(method.c[stage]));
    differs = std::max(differs, std::abs(double(force[stage]) - cubic));
    most = std::max(most, std::abs(double(force[stage])));
  }
  return flow.ways[k].least * (double(flow.resolution[k].force) + double(slight<T>) * most) < times_between * differs;
}

// The way of a row within a step of h. That of a row of velocities is the integral of its rates at the stages, by
// Simpson's rule, where these are known.
template <class S>
Way<typename S::Scalar> way_of(const Batch<S>& batch, int i, const Flow<S>& flow, const RungeKuttaOf<S>& method,
                               size_t k, typename S::Scalar h) {
  using T = typename S::Scalar;
  const auto& start = flow.ways[k];
  Way<T> way{start.C, batch.C[i] - start.C, h * start.rate, h * flow.row_rates[k]};
  if (!batch.ops->lacks_position) return way.known_to(flow.resolution[k].C);
  if (!slips(batch, i) || !knows_stages(method)) return way.known_to(std::numeric_limits<T>::infinity());
  const double middle = cubic_through_stages(method, flow.at_stages.data() + k * most_stages, 0.5);
  way.change = (way.rate_from + T(4) * h * T(middle) + way.rate_to) / T(6);
  return way;
}

// At the present poses and velocities, with the force of the last solution.
template <class S>
typename S::Scalar margin_now(const WorldData<S>& world, Batch<S>& batch, int i,
                              const Resolution<typename S::Scalar>& resolution, typename S::Scalar time) {
  const auto C = batch.C[i];
  batch.ops->evaluate(batch, i, i + 1, world.bodies, time);  // dC/dt, which gamma has replaced
  batch.ops->velocity(batch, i, i + 1, world.bodies.velocity.data(), batch.rate.data());
  const auto margin = margin_of_row(batch, i, resolution, batch.rate[i] + batch.bias[i]);
  batch.C[i] = C;
  return margin;
}

// Round-off decides how redundant rows share a load. Sweeps factor no K.
template <class S>
bool shares_loads(const Island<S>& island) {
  const System<S>& system = island.at_work();
  if (!island.solver->exact) return false;
  for (int r = 0; r < system.rows(); ++r)
    if (system.dependent(r)) return true;
  return false;
}

// True if a row has passed its event at one of the looks 1, 2, ... before the last, at a time of at(look) after the
// start: one that stages tell of, by its force, otherwise one that comes near. Leaves the end as it was.
template <class S, class F>
bool passes_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                    typename S::Scalar h, bool by_force, int last, F at) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const auto take_turns_of_end = [&] { std::swap(flow.start_turns, flow.end_turns); };
  take_turns_of_end(), keep_turns(island), take_turns_of_end();
  bool any = false;
  flow.length = h;
  look_between(world, island, method, time + h, T(0));
  restore_turns(island);
  for (int look = 1; look < last && !any; ++look) {
    look_between(world, island, method, time + h, h - at(look));
    if (by_force) {
      evaluate_anew(world, island, time + at(look));
      island.factored = false;
      accelerate(world, island, time + at(look));
    }
    each_single_row(island, [&](Batch<S>& batch, int i, size_t k) {
      if (by_force ? !is_told_by_stages(batch, i, flow, k) : !flow.ways[k].near) return;
      any |= double(margin_now(world, batch, i, flow.resolution[k], time + at(look))) < event_threshold(flow, k);
    });
  }
  take_turns_of_end(), restore_turns(island), take_turns_of_end();
  go_to_end(world, island, method, time + h);
  flow.end_kept = false;  // the step may still end at an event
  return any;
}

}  // namespace

template <class S>
void note_ways(const WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  size_t k = 0;
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    const auto first = batch.C.begin() + slot * batch.ops->rows;
    T C[most_rows];
    std::copy_n(first, batch.ops->rows, C);
    batch.ops->position(batch, slot, slot + 1, world.bodies, time);
    for (int r = 0; r < batch.ops->rows; ++r, ++k) {
      island.flow.ways[k] = {first[r], island.flow.row_rates[k]};
      const int i = slot * batch.ops->rows + r;
      island.flow.at_stages[k * most_stages] =
          slips_without_place(batch, i) ? island.flow.row_rates[k] : batch.lambda[i];
    }
    std::copy_n(C, batch.ops->rows, first);
  });
}

template <class S>
void note_forces(const WorldData<S>& world, Island<S>& island, int stage, typename S::Scalar time, double share) {
  Flow<S>& flow = island.flow;
  each_single_row(island, [&](Batch<S>& batch, int i, size_t k) {
    auto& way = flow.ways[k];
    if (stage == 1) way.past = 1;
    const bool slips = slips_without_place(batch, i);
    if (batch.mode[i] != Mode::held && !slips) return;
    const auto& resolution = flow.resolution[k];
    const double margin = double(slips ? margin_now(world, batch, i, resolution, time)
                                       : margin_of_row(batch, i, resolution, typename S::Scalar(0)));
    way.least = stage == 1 ? margin : std::min(way.least, margin);
    flow.at_stages[k * most_stages + static_cast<size_t>(stage)] =
        slips ? batch.rate[i] + batch.bias[i] : batch.lambda[i];
    if (margin < event_threshold(flow, k)) way.past = std::min(way.past, share);
  });
}

template <class S>
double earliest_passed_stage(const Flow<S>& flow) {
  double earliest = 1;
  for (const auto& way : flow.ways) earliest = std::min(earliest, way.past);
  return earliest;
}

template <class S>
bool leaps(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
           typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  bool any = false, near = false, by_stages = false;
  const bool shares = shares_loads(island);
  each_single_row(island, [&](Batch<S>& batch, int i, size_t k) {
    auto& start = flow.ways[k];
    const Way<T> way = way_of(batch, i, flow, method, k, h);
    start.near = slips_without_place(batch, i) && !knows_stages(method);
    const auto look = [&](const Dip& dip) {
      any |= dip.leaps(event_threshold(flow, k)), start.near |= dip.comes_near(event_threshold(flow, k));
    };
    any |= leaps_over_bound(batch, i, way, time + h, h);
    const bool told = is_told_by_stages(batch, i, flow, k), unsure = batch.mode[i] == Mode::held && !shares;
    any |= told && (start.least < event_threshold(flow, k) || (unsure && is_unresolved(flow, method, k)));
    if (may_come_back(batch, i, way) || may_come_and_go(batch, i, flow, k))
      look(dip_of_way(batch, i, way, flow.resolution[k], time + h, h));
    else if (may_rest(batch, i, way)) look(dip_of_rate(batch, i, way, flow.resolution[k], h));
    near |= start.near;
    by_stages |= told;
  });
  const double resolved = by_stages ? resolved_events : resolved_work;
  if (any || (world.driven && leaps_over_functions(island, double(time), double(h), resolved))) return true;
  const auto at_stage = [&](int stage) { return h * T(method.c[stage]); };
  if (by_stages && method.implicit && passes_between(world, island, method, time, h, true, method.stages - 1, at_stage))
    return true;
  const auto at_part = [&](int look) { return h * T(look) / T(looks_between); };
  return near && method.further_terms > 0 &&
         passes_between(world, island, method, time, h, false, looks_between, at_part);
}

#define CDOT_INSTANTIATE(S)                                                           \
  template void note_forces(const WorldData<S>&, Island<S>&, int, S::Scalar, double); \
  template double earliest_passed_stage(const Flow<S>&);                              \
  template void note_ways(const WorldData<S>&, Island<S>&, S::Scalar);                \
  template bool leaps(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
