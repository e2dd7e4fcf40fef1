#include "runtime/step/between.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/events/events.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/solve/projection.hpp"

namespace cdot {
namespace {

// f(lambda, forces, count) for every run of the island's rows; `forces` is their place in Flow::end_forces.
template <class S, class F>
void each_run_of_forces(Island<S>& island, F f) {
  auto* forces = island.flow.end_forces.data();
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows, count = (segment.end - segment.begin) * rows;
    f(segment.batch->lambda.data() + segment.begin * rows, forces, count);
    forces += count;
  }
}

// f_i = h sum_j between_ij k_j
template <class S>
void find_further_terms(Flow<S>& flow, const RungeKuttaOf<S>& method) {
  using T = typename S::Scalar;
  const size_t n = flow.now.size();
  std::fill(flow.further_terms.begin(), flow.further_terms.end(), T(0));
  for (int i = 0; i < method.further_terms; ++i) {
    T* term = flow.further_terms.data() + static_cast<size_t>(i) * n;
    for (int j = 0; j <= method.stages + method.further_stages; ++j) {
      const T weight = flow.length * T(method.between[i][j]), *rate = flow.rates.data() + static_cast<size_t>(j) * n;
      if (weight == T(0)) continue;
      for (size_t k = 0; k < n; ++k) term[k] += weight * rate[k];
    }
  }
}

template <class S>
void keep_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time) {
  Flow<S>& flow = island.flow;
  read_numbers(world, island, flow.end.data());
  each_run_of_forces(island, [](auto* lambda, auto* forces, int count) { std::copy_n(lambda, count, forces); });
  for (int stage = 1; stage <= method.further_stages; ++stage)
    take_stage(world, island, method, method.stages + stage, time - flow.length, flow.length);
  find_further_terms(flow, method);
  flow.end_kept = true;
}

// y(t + theta h) by the formula above RungeKutta::further_stages.
template <class S>
void interpolate(Flow<S>& flow, const RungeKuttaOf<S>& method) {
  using T = typename S::Scalar;
  const size_t n = flow.now.size();
  const T h = flow.length, theta = T(1) - flow.ahead / h;
  const T *first = flow.rates.data(), *last = first + static_cast<size_t>(method.stages) * n;
  const T* terms = flow.further_terms.data();
  for (size_t k = 0; k < n; ++k) {
    const T d = flow.end[k] - flow.start[k], r = (method.implicit ? terms[k] : h * first[k]) - d;
    const T s = d - (method.implicit ? terms[n + k] : h * last[k]) - r;
    T sum = 0;
    for (int i = method.implicit ? -1 : method.further_terms - 1; i >= 0; --i)
      sum = (i % 2 == 0 ? T(1) - theta : theta) * (terms[static_cast<size_t>(i) * n + k] + sum);
    sum = theta * (s + sum);
    flow.now[k] = flow.start[k] + theta * (d + (T(1) - theta) * (r + sum));
  }
}

// Thresholds for an event that was passed and just passed. In units of the resolution, relative to the margin at the
// choice of the mode: a row that creeps may have chosen its mode many steps ago.
constexpr double passed = -1, just_passed = -3;
constexpr int most_searches = 60;  // for one event

template <class T>
double furthest(const StateArray<T>& chosen, const StateArray<T>& now) {
  double worst = 0;
  for (size_t k = 0; k < now.size(); ++k) worst = std::min(worst, double(now[k]) - std::min(double(chosen[k]), 0.0));
  return worst;
}

// The point between `low` and `high`, from 0 to 1, at which the first row has just passed its event, by linear
// interpolation.
template <class S>
double first_event(const Flow<S>& flow) {
  const double aim = 0.5 * (passed + just_passed);
  double first = 1;
  for (size_t k = 0; k < flow.high.size(); ++k) {
    const double base = std::min(double(flow.margins_chosen[k]), 0.0) + aim;
    const double low = double(flow.low[k]) - base, high = double(flow.high[k]) - base;
    if (high < 0 && low > high) first = std::min(first, low / (low - high));
  }
  return first;
}

// The way of a row's C within a step, as the cubic with its values and rates at both ends.
template <class T>
struct Way {
  T from, to, rate_from, rate_to;  // rates times the length of the step
  T at(T share) const {
    const T rest = T(1) - share;
    return rest * rest * (from + share * (T(2) * from + rate_from)) +
           share * share * (to + rest * (T(2) * to - rate_to));
  }
  T bend() const { return rate_from + rate_to - T(2) * (to - from); }
  T rate_at(T share) const { return rate_from + share * (rate_to - rate_from - T(3) * bend() * (T(1) - share)); }
  // Where that rate turns back.
  T turn() const { return T(0.5) + (rate_from - rate_to) / (T(6) * bend()); }
};

// A bound that rises and falls is seen at this many points of the way. More than `unseen` of its largest value, up and
// down again, and the stages of the step may have missed it.
constexpr int looks = 128;
constexpr double unseen = 0.2;

// f() with C at each point of the way.
template <class S, class F>
void look_along(Batch<S>& batch, int i, const Way<typename S::Scalar>& way, F f) {
  using T = typename S::Scalar;
  const T C = batch.C[i];
  for (int look = 0; look <= looks; ++look) batch.C[i] = way.at(T(look) / T(looks)), f();
  batch.C[i] = C;
}

template <class S>
bool leaps_over_bound(Batch<S>& batch, int i, const Way<typename S::Scalar>& way) {
  const bool up = batch.mode[i] == Mode::pushed;
  if (!batch.law->moving || (!up && batch.mode[i] != Mode::pulled)) return false;
  double first = 0, last = 0, changes = 0, most = 0;
  bool any = false;
  look_along(batch, i, way, [&] {
    Guard<typename S::Scalar> guard;
    batch.law->guard(batch, i, &guard);
    const double bound = double(up ? guard.upper : guard.lower);
    if (any) changes += std::abs(bound - last);
    else first = bound;
    any = true, last = bound, most = std::max(most, std::abs(bound));
  });
  return std::isfinite(most) && changes - std::abs(last - first) > unseen * most;
}

// Only a way that turns back comes back from an end, or from the place of another event.
template <class S>
bool leaps_over_end(Batch<S>& batch, int i, const Way<typename S::Scalar>& way,
                    const Resolution<typename S::Scalar>& resolution, double least, typename S::Scalar rate) {
  if ((batch.mode[i] != Mode::off && !batch.law->distance) || !(way.rate_from * way.rate_to < 0)) return false;
  bool any = false;
  look_along(batch, i, way, [&] { any |= double(margin_of_row(batch, i, resolution, rate)) < least; });
  return any;
}

// A row that slips comes to rest within the step and slips on in its end. Between them it may have stuck.
template <class S>
bool leaps_over_rest(const Batch<S>& batch, int i, const Way<typename S::Scalar>& way,
                     const Resolution<typename S::Scalar>& resolution, double least, typename S::Scalar h) {
  if (batch.mode[i] != Mode::pushed && batch.mode[i] != Mode::pulled) return false;
  const auto turn = way.turn();
  return turn > 0 && turn < 1 && double(margin_of_row(batch, i, resolution, way.rate_at(turn) / h)) < least;
}

// Takes a step of h again and projects its end. If an implicit method finds none, stays at the start.
template <class S>
bool go_to(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
           typename S::Scalar h) {
  go_back(world, island);
  const bool found = take_stages(world, island, method, time, h);
  if (found) project_end(world, island, method, time + h);
  else go_back(world, island);
  return found;
}

}  // namespace

template <class S>
bool passed_event(const Flow<S>& flow) {
  return !flow.margins.empty() && furthest(flow.margins_chosen, flow.margins) < passed;
}

template <class S>
void note_ways(const WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  size_t k = 0;
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    const auto first = batch.C.begin() + slot * batch.ops->rows;
    T C[most_rows];
    std::copy_n(first, batch.ops->rows, C);
    batch.ops->position(batch, slot, slot + 1, world.bodies, time);
    for (int r = 0; r < batch.ops->rows; ++r, ++k) island.flow.ways[k] = {first[r], island.flow.row_rates[k]};
    std::copy_n(C, batch.ops->rows, first);
  });
}

template <class S>
bool leaps(Island<S>& island, typename S::Scalar h) {
  bool any = false;
  size_t k = 0;
  each_guarded_slot(island, [&](Batch<S>& batch, int slot) {
    const size_t first = k;
    k += static_cast<size_t>(batch.ops->rows);
    if (any || batch.ops->rows > 1 || batch.law->cone_rows > 0) return;
    const auto& [C, rate] = island.flow.ways[first];
    const double least = std::min(double(island.flow.margins_chosen[first]), 0.0) + passed;
    const Way<typename S::Scalar> way{C, batch.C[slot], h * rate, h * island.flow.row_rates[first]};
    any = leaps_over_bound(batch, slot, way) ||
          leaps_over_end(batch, slot, way, island.flow.resolution[first], least, island.flow.row_rates[first]) ||
          leaps_over_rest(batch, slot, way, island.flow.resolution[first], least, h);
  });
  return any;
}

template <class S>
typename S::Scalar go_to_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                               typename S::Scalar time, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  flow.high.assign(flow.margins.begin(), flow.margins.end());
  T low = 0, high = h;
  for (int search = 0; search < most_searches; ++search) {
    // Every third round bisects, in case linear interpolation stalls.
    const double share = search % 3 == 2 ? 0.5 : std::clamp(first_event(flow), 0.001, 0.999);
    const T at = low + T(share) * (high - low);
    if (!(at > low && at < high)) break;
    if (!go_to(world, island, method, time, at)) return T(0);
    const double margin = furthest(flow.margins_chosen, flow.margins);
    if (margin < passed) {
      high = at;
      flow.high.assign(flow.margins.begin(), flow.margins.end());
      if (margin >= just_passed) return at;
    } else {
      low = at;
      flow.low.assign(flow.margins.begin(), flow.margins.end());
    }
  }
  return go_to(world, island, method, time, high) ? high : T(0);
}

template <class S>
void go_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time) {
  Flow<S>& flow = island.flow;
  if (!flow.end_kept) keep_end(world, island, method, time);
  interpolate(flow, method);
  set_numbers(world, island, flow.now.data());
  project(world, island, time - flow.ahead, true);
}

template <class S>
void go_to_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time) {
  Flow<S>& flow = island.flow;
  set_numbers(world, island, flow.end.data());
  evaluate_anew(world, island, time);
  island.factored = false;
  each_run_of_forces(island, [](auto* lambda, const auto* forces, int count) { std::copy_n(forces, count, lambda); });
  const auto* rate = flow.rates.data() + static_cast<size_t>(method.stages) * flow.end.size();
  for (int i : island.bodies) {
    world.bodies.velocity_rate[i] = S::read_velocity(rate + S::pose_numbers);
    rate += numbers_per_body<S>;
  }
}

#define CDOT_INSTANTIATE(S)                                                                                \
  template bool passed_event(const Flow<S>&);                                                              \
  template void note_ways(const WorldData<S>&, Island<S>&, S::Scalar);                                     \
  template bool leaps(Island<S>&, S::Scalar);                                                              \
  template S::Scalar go_to_event(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar); \
  template void go_between(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);                  \
  template void go_to_end(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
