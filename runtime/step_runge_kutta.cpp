// A step of a Runge-Kutta method as the World asks for it: in one piece, or in as many as the error estimate wants, and
// cut at events.
#include <algorithm>
#include <cmath>

#include "runtime/events.hpp"
#include "runtime/hold.hpp"
#include "runtime/runge_kutta.hpp"
#include "runtime/spaces.hpp"

namespace cdot {
namespace {

constexpr int most_events = 32;      // in one step(); beyond them its rest is left to Euler's
constexpr int most_rejections = 60;  // in a row: then the step is taken as it is
constexpr int most_searches = 60;    // for one event

// In units of what is not told apart, from where a row stood: an event is behind us, and just behind us.
constexpr double passed = -1, just_passed = -3;

template <class T>
double furthest(const std::vector<T>& start, const std::vector<T>& now) {
  double worst = 0;
  for (size_t k = 0; k < now.size(); ++k) worst = std::min(worst, double(now[k]) - std::min(double(start[k]), 0.0));
  return worst;
}

// The share of the way from `low` to `high` at which the first row has just passed its event, by straight lines.
template <class S>
double first_event(const Flow<S>& flow) {
  const double aim = 0.5 * (passed + just_passed);
  double first = 1;
  for (size_t k = 0; k < flow.high.size(); ++k) {
    const double base = std::min(double(flow.margins_at_start[k]), 0.0) + aim;
    const double low = double(flow.low[k]) - base, high = double(flow.high[k]) - base;
    if (high < 0 && low > high) first = std::min(first, low / (low - high));
  }
  return first;
}

// The state at the first event of a step of h that was seen to pass one. Returns the time until there.
template <class S>
typename S::Scalar go_to_event(WorldState<S>& world, Island<S>& island, const RungeKutta& method,
                               typename S::Scalar time, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  flow.low = flow.margins_at_start;
  flow.high = flow.margins;
  T low = 0, high = h;
  for (int search = 0; search < most_searches; ++search) {
    // Every third time in the middle, where straight lines mislead.
    const double share = search % 3 == 2 ? 0.5 : std::clamp(first_event(flow), 0.001, 0.999);
    const T at = low + T(share) * (high - low);
    if (!(at > low && at < high)) break;
    go_back(world, island);
    take_stages(world, island, method, time, at);
    settle_end(world, island, method, time + at);
    const double margin = furthest(flow.margins_at_start, flow.margins);
    if (margin < passed) {
      high = at;
      flow.high = flow.margins;
      if (margin >= just_passed) return at;
    } else {
      low = at;
      flow.low = flow.margins;
    }
  }
  go_back(world, island);
  take_stages(world, island, method, time, high);
  settle_end(world, island, method, time + high);
  return high;
}

// Steps of h / n that fill what is left, so that no sliver remains.
template <class T>
T even_part(T left, T step) {
  return step > T(0) && step < left ? left / std::ceil(left / step) : left;
}

// One step of at most `left`, as long as the error allows. Returns its length; Flow::margins are those of its end.
template <class S>
typename S::Scalar take_step(WorldState<S>& world, Island<S>& island, const RungeKutta& method, typename S::Scalar time,
                             typename S::Scalar left) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const bool adaptive = world.settings.local_error > 0;
  T h = adaptive ? even_part(left, flow.next_step) : left;
  for (int attempt = 0;; ++attempt) {
    take_stages(world, island, method, time, h);
    double error = adaptive && !method.error_at_end ? error_of_step(world, island, method, h) : 0;
    const bool hopeless = attempt == most_rejections;
    if (error <= 1 || hopeless) {
      settle_end(world, island, method, time + h);
      if (adaptive && method.error_at_end) error = error_of_step(world, island, method, h);
    }
    if (!adaptive) return h;
    // 0.9 of the step that would just do; a NaN shrinks like the worst.
    const double factor = std::clamp(0.9 * std::pow(error, -1.0 / method.order), 0.2, 5.0);
    flow.next_step = h * T(error <= 1e300 ? factor : 0.2);
    if (error <= 1 || hopeless) return h;
    ++world.counts.rejected;
    h = even_part(left, flow.next_step);
    go_back(world, island);
  }
}

// The state as it was found, on its constraints, with the accelerations.
template <class S>
void begin(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  if (island.flow.known) return;
  drop_modes(island);
  island.continuous = false;
  settle_poses(world, island);
  island.continuous = true;
  evaluate_anew(world, island, time);
  choose_modes(world, island, time);
  island.flow.known = true;
}

// The forces of the joints as impulses over h, and back.
template <class S>
void scale_forces(const Island<S>& island, typename S::Scalar by) {
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) segment.batch->lambda[i] *= by;
  }
}

template <class S>
void leave_to_euler(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  ++world.counts.rescued;
  drop_modes(island);
  island.continuous = island.evaluated = island.factored = island.flow.known = false;
  step_euler(world, island, h);
  scale_forces(island, 1 / h);
  island.continuous = true;
}

template <class S>
void count_step(StepCounts& counts, typename S::Scalar h) {
  ++counts.taken;
  counts.shortest = std::min(counts.shortest, double(h));
  counts.longest = std::max(counts.longest, double(h));
}

}  // namespace

template <class S>
void step_runge_kutta(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const RungeKutta& method = runge_kutta(world.settings.integrator);
  Flow<S>& flow = island.flow;
  if (world.last_step > 0) scale_forces(island, T(1 / world.last_step));
  clear_correction(world, island);
  int events = 0;
  for (T done = 0; done < h;) {
    const T time = T(world.time) + done, left = h - done;
    begin(world, island, time);
    keep_start(world, island);
    flow.margins_at_start = flow.margins;
    T taken = take_step(world, island, method, time, left);
    if (flow.guarded > 0 && furthest(flow.margins_at_start, flow.margins) < passed) {
      taken = go_to_event(world, island, method, time, taken);
      ++world.counts.events;
      flow.known = false;
    }
    count_step<S>(world.counts, taken);
    if (taken >= left) break;
    done += taken;
    if (!flow.known && ++events > most_events) {
      leave_to_euler(world, island, h - done);
      break;
    }
  }
  scale_forces(island, h);
}

#define CDOT_INSTANTIATE(S) template void step_runge_kutta(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
