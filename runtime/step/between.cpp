#include "runtime/step/between.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/events/events.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/step/leaps.hpp"

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

// In these units an event was just passed.
constexpr double just_passed = -3;
constexpr double aim = 0.5 * (passed + just_passed);
constexpr int most_searches = 60;  // for one event
// A step of h misses its event by d. Along the rates of its end it gets there but for (d / h)^2 of the change of these
// rates; this share of the local error at most.
constexpr double share_of_move = 0.01;
constexpr int most_corrections = 8;

template <class T>
double furthest(const StateArray<T>& chosen, const StateArray<T>& now) {
  double worst = 0;
  for (size_t k = 0; k < now.size(); ++k) worst = std::min(worst, double(now[k]) - std::min(double(chosen[k]), 0.0));
  return worst;
}

template <class S>
bool lies_at_event(const Flow<S>& flow) {
  const double margin = furthest(flow.margins_chosen, flow.margins);
  return margin < passed && margin >= just_passed;
}

// furthest() of the rows that have passed at Flow::high, before their events as well.
template <class S>
double nearest(const Flow<S>& flow) {
  double least = std::numeric_limits<double>::infinity();
  for (size_t k = 0; k < flow.high.size(); ++k) {
    const double base = std::min(double(flow.margins_chosen[k]), 0.0);
    if (double(flow.high[k]) - base < passed) least = std::min(least, double(flow.margins[k]) - base);
  }
  return least;
}

// The point between `low` and `high`, from 0 to 1, at which the first row has just passed its event, by linear
// interpolation.
template <class S>
double first_event(const Flow<S>& flow) {
  double first = 1;
  for (size_t k = 0; k < flow.high.size(); ++k) {
    const double base = std::min(double(flow.margins_chosen[k]), 0.0) + aim;
    const double low = double(flow.low[k]) - base, high = double(flow.high[k]) - base;
    if (high < 0 && low > high) first = std::min(first, low / (low - high));
  }
  return first;
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

// Where an event was found.
template <class T>
struct Sight {
  T at;          // [s] from the start of the step; 0: nowhere
  double slope;  // of nearest() over the last two looks [1/s]
};

// Looks for the first event within a step of h, of which Flow::low and Flow::margins have the margins at the ends.
// go(at) finds the margins at a time after its start, or returns false.
template <class S, class F>
Sight<typename S::Scalar> search_event(Flow<S>& flow, typename S::Scalar h, F go) {
  using T = typename S::Scalar;
  flow.high.assign(flow.margins.begin(), flow.margins.end());
  T low = 0, high = h, last = h;
  double margin = nearest(flow), slope = 0;
  for (int search = 0; search < most_searches; ++search) {
    // Every third round bisects, in case linear interpolation stalls.
    const double share = search % 3 == 2 ? 0.5 : std::clamp(first_event(flow), 0.001, 0.999);
    const T at = low + T(share) * (high - low);
    if (!(at > low && at < high)) break;
    if (!go(at)) return {T(0), 0};
    const double before = std::exchange(margin, nearest(flow));
    slope = (margin - before) / double(at - std::exchange(last, at));
    if (lies_at_event(flow)) return {at, slope};
    const bool is_past = passed_event(flow);
    (is_past ? high : low) = at;
    (is_past ? flow.high : flow.low).assign(flow.margins.begin(), flow.margins.end());
  }
  return {go(high) ? high : T(0), slope};
}

// Moves the end of a step along its rates, for a time so short that they hardly change.
template <class S>
void move_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar end,
              typename S::Scalar further) {
  Flow<S>& flow = island.flow;
  const auto* rate = flow.rates.data() + static_cast<size_t>(method.stages) * flow.now.size();
  read_numbers(world, island, flow.now.data());
  for (size_t k = 0; k < flow.now.size(); ++k) flow.now[k] += further * rate[k];
  set_numbers(world, island, flow.now.data());
  project_end(world, island, method, end + further);
}

// A step to the event that looks at the interpolant find, each for one evaluation where a step costs many. Gaps there
// are open by more than events resolve, so the step misses the event by a little and is moved. 0 if that fails.
template <class S>
typename S::Scalar go_to_sighted_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                       typename S::Scalar time, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const Sight<T> sight = search_event(flow, h, [&](T at) {
    look_between(world, island, method, time + h, h - at);
    evaluate_anew(world, island, time + at);
    island.factored = false;
    note_rates(world, island);
    accelerate(world, island, time + at);
    measure_margins(world, island, time + at);
    return true;
  });
  flow.end_kept = false;  // the step ends at the event
  const T slight = T(std::sqrt(share_of_move * world.settings.local_error)) * h;
  T at = sight.at, moved = 0;
  double slope = sight.slope;
  if (!go_to(world, island, method, time, at)) return T(0);
  for (int correction = 0; correction < most_corrections; ++correction) {
    const double margin = nearest(flow);
    if (lies_at_event(flow)) return at;
    const T further = T((aim - margin) / slope);
    if (!(slope < 0) || !(at + further > T(0) && at + further < h)) break;
    if (std::abs(moved += further) <= slight) move_end(world, island, method, time + at, further);
    else if (!go_to(world, island, method, time, at + further)) return T(0);
    else moved = T(0);
    slope = (nearest(flow) - margin) / double(further);
    at += further;
  }
  return T(0);
}

// The margins at the ends of a step, for a search.
template <class S>
bool go_to_ends(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                typename S::Scalar h) {
  go_back(world, island);
  project(world, island, time, true);
  measure_margins(world, island, time);
  island.flow.low.assign(island.flow.margins.begin(), island.flow.margins.end());
  return go_to(world, island, method, time, h);
}

// A force that passes its bound, comes back and passes it again has its first event before the one that was found in a
// step of h. The stages of that step may tell: then goes there. Returns the length of the step.
template <class S>
typename S::Scalar go_to_earlier_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                       typename S::Scalar time, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T before = h * T(earliest_passed_stage(island.flow));
  if (!(before < h)) return h;
  island.flow.length = before;
  if (go_to_ends(world, island, method, time, before) && passed_event(island.flow))
    return go_to_event(world, island, method, time, before, before);
  island.flow.length = h;
  return go_to(world, island, method, time, h) ? h : T(0);  // stages are less exact than the end
}

// Goes to `at` by the interpolant of a step of h and projects. True if that changes no number by more than the local
// error: at the distance d from a loss of rank it magnifies the interpolant's error by 1 / d.
template <class S>
bool go_by_interpolant(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                       typename S::Scalar h, typename S::Scalar at) {
  Flow<S>& flow = island.flow;
  if (!go_to(world, island, method, time, h)) return false;
  flow.length = h;
  look_between(world, island, method, time + h, h - at);
  project(world, island, time + at, true);
  flow.end_kept = false;
  read_numbers(world, island, flow.end.data());
  for (size_t k = 0; k < flow.end.size() - flow.work.size(); ++k) {
    const double change = double(flow.end[k] - flow.now[k]), size = 1 + std::abs(double(flow.now[k]));
    if (!(std::abs(change) <= world.settings.local_error * size)) return false;
  }
  return true;
}

// The whole step of h led its stages away from a loss of rank. Those of the step to an event at `at` may lie near it,
// as where a rope lets go in the pose in which its force changes sign through a pole. Then goes there by the
// interpolant of the whole step; where that is not exact enough, half as far, so that the next step is shorter and it
// is. No further than `left`: no later step could go back between.
template <class S>
typename S::Scalar avoid_rank_loss(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                   typename S::Scalar time, typename S::Scalar h, typename S::Scalar at,
                                   typename S::Scalar left) {
  using T = typename S::Scalar;
  if (!island.flow.projects_stages || method.further_terms == 0 || !(at > T(0))) return at;
  if (error_of_step(island, method, at, world.settings.local_error) <= 1) return at;
  const T end = std::min(at, left), half = T(0.5) * end;
  if (go_by_interpolant(world, island, method, time, h, end)) return end;
  island.flow.next_step = end;
  return go_to(world, island, method, time, half) ? half : T(0);
}

}  // namespace

template <class S>
bool passed_event(const Flow<S>& flow) {
  return !flow.margins.empty() && furthest(flow.margins_chosen, flow.margins) < passed;
}

template <class S>
typename S::Scalar go_to_event(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                               typename S::Scalar time, typename S::Scalar h, typename S::Scalar left) {
  using T = typename S::Scalar;
  const auto search = [&] {
    return search_event(island.flow, h, [&](T at) { return go_to(world, island, method, time, at); }).at;
  };
  if (!(world.settings.local_error > 0)) return search();
  T at = go_to_sighted_event(world, island, method, time, h);
  if (at > T(0)) at = go_to_earlier_event(world, island, method, time, at);
  else if (go_to_ends(world, island, method, time, h)) at = search();
  return avoid_rank_loss(world, island, method, time, h, at, left);
}

template <class S>
void look_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                  typename S::Scalar ahead) {
  Flow<S>& flow = island.flow;
  if (!flow.end_kept) keep_end(world, island, method, time);
  const typename S::Scalar before = flow.ahead;  // a copy: another StateNumber may share its place
  flow.ahead = ahead;
  interpolate(flow, method);
  flow.ahead = before;
  set_numbers(world, island, flow.now.data());
}

template <class S>
void go_between(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time) {
  look_between(world, island, method, time, island.flow.ahead);
  project(world, island, time - island.flow.ahead, true);
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

#define CDOT_INSTANTIATE(S)                                                                                           \
  template bool passed_event(const Flow<S>&);                                                                         \
  template S::Scalar go_to_event(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar, S::Scalar); \
  template void look_between(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar);                \
  template void go_between(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);                             \
  template void go_to_end(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
