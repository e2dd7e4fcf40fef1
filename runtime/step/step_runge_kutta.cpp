// step(h) by a Runge-Kutta method: fixed or adaptive steps, shortened at events. The last adaptive step may end beyond
// h.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <cdot/spaces.hpp>

#include "runtime/events/events.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/pieces.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/pace.hpp"
#include "runtime/step/between.hpp"
#include "runtime/step/collocation.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/step/leaps.hpp"
#include "runtime/step/rank_loss.hpp"
#include "runtime/step/runge_kutta.hpp"

namespace cdot {
namespace {

// Limits on events in one step(h), beside one for each row that has events, and on consecutive slivers. More of them
// mean chatter or jamming; fall_back() then finishes the step. Fifteen joints of a hand settle one after the other.
constexpr int most_events = 32, most_slivers = 1000;
// The same for steps of one step(h). An error below round-off, or a force too stiff for explicit steps, asks for more.
// After a step(h) that took them all, the next one may take an eighth, so that a run of such steps ends.
constexpr int most_steps = 20000, fewest_steps = 100;
int most_steps_after(int exhausted) { return std::max(fewest_steps, most_steps >> std::min(3 * exhausted, 24)); }
constexpr double sliver = 1e-4;      // share of the longest step so far
constexpr int most_rejections = 30;  // in a row
// The same for attempts whose end cannot be projected, or only by a correction that undoes the motion. If steps that
// are hundreds of times shorter fail too, the cause is not the length but contradicting velocities, as of two motors.
constexpr int most_astray = 5;
// Of the longest step: a shorter one is not looked at for events that it leaps over. In such a step behind an impact,
// ways are round-off and what Newton leaves.
constexpr double shortest_leap = 1e-3;
// Where a joint jams, Euler's step finds the impulse. Its order is 1, so it takes this share of step(h), and so many
// times as much where the joint still jams.
constexpr double shortest_jam = 1e-9, longer_jam = 1000;
// In units of Island::size and [rad]: a step with a larger estimated error is meaningless, for example if tension makes
// a chain too stiff for the step.
constexpr double absurd = 0.3;
// The same near a loss of rank, where motions are quick, as long as parts of the step can reach it.
constexpr double careful = 1e-6;
// The shortest part of a fixed step. If its error is too large, fall_back() finishes the step.
constexpr double smallest_part = 1.0 / 16;
template <class S>
constexpr auto slight_displacement = typename S::Scalar(1e-6);  // in units of Island::size, and [rad]
// Steps of an implicit method cost the cube of the bodies. Larger islands that lose rank again and again, as a slack
// bridge does, are damped there by Euler's method.
constexpr int most_to_carry_on = 20;
constexpr int furthest_reach = 64;  // of an adaptive step, in units of h

// The length of the next step: near `best`, with `left` to the end of step(h), at most `reach`. A step that ends at
// `left` saves the interpolation, if it is only a little shorter or longer than `best`.
template <class T>
T length_of_step(T best, T left, T reach) {
  if (!(best > T(0)) || (best > T(0.95) * left && best < T(1.6) * left)) return std::min(left, reach);
  if (reach > left) return std::min(best, reach);
  return std::min(best < left ? left / std::ceil(left / best) : left, reach);  // equal parts leave no sliver
}

// True if the projection at the end of the step undid the motion. The step then passed a pose where a joint's direction
// reverses, as that of a rope whose length passes through 0.
template <class S>
bool went_astray(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  const auto slight = [&](int i) {
    return S::slower(world.bodies.displacement[i], slight_displacement<S> * island.size);
  };
  if (std::all_of(island.bodies.begin(), island.bodies.end(), slight)) return false;
  return !correction_is_small(world, island, double(h));
}

// Takes a step of h and projects its end. Returns error_now(), the error in units of the allowed one. If that is above
// 1 or NaN, the state is invalid.
template <class S, class F>
double try_step(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                typename S::Scalar h, F error_now) {
  island.flow.astray = island.jams = false;
  const bool taken = take_stages(world, island, method, time, h);
  island.flow.astray = island.jams;
  if (island.jams) return std::numeric_limits<double>::infinity();
  if (!taken) return std::numeric_limits<double>::quiet_NaN();
  double error = method.error_at_end ? 0 : error_now();
  if (method.implicit && error > 1) {
    refine_error(world, island, method, time, h);
    error = error_now();
  }
  if (!(error <= 1)) return error;
  project_end(world, island, method, time + h);
  if (method.error_at_end) error = error_now();
  const bool left = left_the_joints(world, island, island.flow.start_residual);
  island.flow.astray = !left && went_astray(world, island, h);
  return left || island.flow.astray ? std::numeric_limits<double>::infinity() : error;
}

// Takes `left` of a fixed step of `whole`, or its largest half, quarter, ... with an allowed error. The parts share the
// allowed error `absurd` in proportion to their lengths. Returns the length, 0 if no part is short enough.
// Flow::margins are those of the end.
template <class S>
typename S::Scalar take_fixed_step(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                   typename S::Scalar time, typename S::Scalar left, typename S::Scalar whole,
                                   typename S::Scalar reach) {
  using T = typename S::Scalar;
  // Only a method with an interpolant may pass the end.
  const T longest = method.further_stages > 0 ? reach : left;
  double share = absurd, noise = 0;
  for (T h = left;;) {
    const double allowed = share * double(h / whole);
    const double error =
        try_step(world, island, method, time, h, [&] { return share_of_size(island, method, h) / allowed; });
    if (tries_with_care(world, island, method, time, longest, h, noise)) {
      if (!(h > T(0))) return h;
      share = careful;
      continue;
    }
    if (error <= 1) return h;
    reject_step(world, island);
    if (h >= T(2 * smallest_part) * whole) h /= 2;
    else if (share == careful) share = absurd;
    else return T(0);
  }
}

// The control of a step by the pace of an earlier run; nothing if there is none.
template <class S>
std::optional<PacedStep> paced_step(const WorldData<S>& world, const Island<S>& island, const RungeKuttaOf<S>& method,
                                    double safety, double time) {
  const Pace* const pace = world.paced_by ? world.paced_by->find(island.bodies.front()) : nullptr;
  if (!pace) return {};
  if (const auto next = double(island.flow.next_step); next > 0) return PacedStep(*pace, safety, time, next);
  const double share = world.settings.local_error / world.paced_by->local_error();
  return PacedStep::first(*pace, safety, time, std::pow(share, 1.0 / method.error_order));
}

// The next length after the attempt with this number, which was taken and proposes `next`. A shortened step does not
// reduce the proposed length. After a rejected step the length does not grow. An error allowed for its round-off
// (`noisy`) tells nothing about the next step.
template <class T>
T after_step(T next, T h, T proposed, int attempt, bool noisy) {
  if (attempt == 0 && h < proposed) next = std::max(next, proposed);
  if (attempt > 0) next = std::min(next, h);
  return noisy && proposed > T(0) ? std::min(next, proposed) : next;
}

// try_step() with the error that it estimates, in units of `allowed`. Of a step that leapt over an event: one that asks
// for half the length.
template <class S>
double try_adaptive_step(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                         typename S::Scalar h, double allowed, double safety) {
  using T = typename S::Scalar;
  const double error =
      try_step(world, island, method, time, h, [&] { return error_of_step(island, method, h, allowed); });
  const bool looks = error <= 1 && h >= T(shortest_leap) * island.flow.longest;
  return looks && leaps(world, island, method, time, h) ? std::max(2.0, std::pow(2 * safety, method.error_order))
                                                        : error;
}

// True if the attempt with this error needs another one, of a length h and with this noise: near a loss of rank, or in
// doubt of its noise.
template <class S>
bool tries_again(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                 typename S::Scalar reach, double error, Doubt<typename S::Scalar>& doubt, int& attempt,
                 typename S::Scalar& h, double& noise) {
  // Where Newton failed, stages tell nothing about the rank.
  const bool failed = method.implicit && std::isnan(error);
  if (!failed && tries_with_care(world, island, method, time, reach, h, noise)) {
    --attempt;  // its length says nothing about the error
    return true;
  }
  if (!doubt.asks(error, h, noise)) return false;
  go_back(world, island);
  return true;
}

// Takes a step as long as the error allows, at most `reach`. Returns like take_fixed_step().
template <class S>
typename S::Scalar take_adaptive_step(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                      typename S::Scalar time, typename S::Scalar left, typename S::Scalar reach) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const double safety = world.paces ? world.paces->safety() : usual_safety;
  std::optional<PacedStep> paced = paced_step(world, island, method, safety, double(time));
  const T proposed = paced ? T(paced->proposed()) : T(flow.next_step);
  T h = length_of_step(proposed, left, reach);
  int astray = 0;
  double noise = 0;
  Leap<S> leap;
  Doubt<T> doubt(proposed > T(0), world.settings.local_error, method.error_order);
  for (int attempt = 0; attempt <= most_rejections && astray < most_astray; ++attempt) {
    const double allowed = std::max(world.settings.local_error, noise);
    const double error = try_adaptive_step(world, island, method, time, h, allowed, safety);
    // A NaN counts as the largest error.
    const double factor = std::clamp(safety * std::pow(error, -1.0 / method.error_order), 0.2, 5.0);
    flow.next_step = h * T(error <= 1e300 ? factor : 0.2);
    if (tries_again(world, island, method, time, reach, error * allowed, doubt, attempt, h, noise)) {
      if (!(h > T(0))) break;
      continue;
    }
    const bool noisy = noise > world.settings.local_error, tells = !noisy && error <= 1e300;
    const double best = double(h) * factor / safety;
    if (paced && tells) paced->learn(double(h), best);
    if (error <= 1) {
      world.counts->crossed += leap.taken(), world.kinked += has_kink(flow, world.settings.local_error, error);
      if (world.paces && tells) world.paces->note(island.bodies.front(), double(time), double(h), best);
      flow.next_step =
          paced ? T(paced->next(double(time + h), best)) : after_step<T>(flow.next_step, h, proposed, attempt, noisy);
      return h;
    }
    if (paced) flow.next_step = std::min<T>(flow.next_step, T(paced->next(double(time), best)));
    const T next = length_of_step<T>(flow.next_step, left, reach);
    h = leap.after(world, island, method, h, error * allowed, next, reach, noise);
    reject_step(world, island);
    astray = std::isinf(error) ? astray + 1 : 0;
  }
  flow.next_step = proposed;
  return T(0);
}

// Projects the start state and computes modes and accelerations, unless they are known.
template <class S>
void begin(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h) {
  if (island.flow.known) return;
  drop_modes(island);
  island.acceleration_level = false;
  project_start(world, island, time);
  island.acceleration_level = true;
  evaluate_anew(world, island, time);
  island.jams = false;
  choose_modes(world, island, time, h);
  island.flow.known = true;
}

// Converts the joints' forces to impulses over h, and back.
template <class S>
void scale_forces(const Island<S>& island, typename S::Scalar by) {
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) segment.batch->lambda[i] *= by;
  }
}

// Finishes the step from `time` on by the midpoint rule, or by linearly implicit Euler: for sweeps, and where a joint's
// direction reverses (`astray`), as that of a jammed rope, which no method should throw back. Computes the impulses
// that these methods need from the accelerations.
template <class S>
void fall_back(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h, bool astray) {
  using T = typename S::Scalar;
  ++world.counts->rescued;
  island.flow.locates = false;
  fill_lambda(island, T(0));
  evaluate_anew(world, island, time);
  island.factored = false;
  if (!island.jams) accelerate(world, island, time);
  island.jams = false;
  scale_forces(island, h);
  drop_modes(island);
  island.acceleration_level = island.evaluated = island.factored = false;
  // Rows that were off or held may miss their ends by the resolution of events, which may be far in a short step.
  if (island.flow.guarded > 0) island.residual = std::numeric_limits<T>::infinity();
  island.flow.forget();
  island.flow.slivers = 0;
  island.flow.projects_stages = false;
  if (island.rescue.built()) island.rescue.follow(island.system);
  island.stiffened = true;
  if (!astray && island.solver->exact && world.settings.drift == Drift::projection)
    step_midpoint_from(world, island, time, h);
  else step_euler(world, island, h, double(h));
  island.stiffened = false;
  restore_masses(world, island);
  scale_forces(island, 1 / h);
  island.evaluated = island.factored = false;
  island.acceleration_level = true;
}

template <class S>
void count_step(StepCounts& counts, typename S::Scalar h) {
  ++counts.taken;
  counts.shortest = std::min(counts.shortest, double(h));
  counts.longest = std::max(counts.longest, double(h));
}

// The way before a step that begins `done` after the start of step(h).
template <class T>
struct Way {
  T left;      // to the end of step(h), or to a time at which numbers in time jump
  T end;       // that end, from the start of step(h)
  T to_break;  // to that time
};

template <class S>
Way<typename S::Scalar> way_from(WorldData<S>& world, Island<S>& island, typename S::Scalar done,
                                 typename S::Scalar h) {
  using T = typename S::Scalar;
  if (!world.driven) return {h - done, h, std::numeric_limits<T>::infinity()};
  const double time = double(T(world.time) + done);
  const T to_break = T(begin_piece(world, island, time, double(h), 2) - time);
  return to_break < h - done ? Way<T>{to_break, done + to_break, to_break} : Way<T>{h - done, h, to_break};
}

// Takes a step as long as its error allows; its length goes to Flow::length. False if there is none: fall_back() has
// gone all the way, or `jam` of it where a joint jams.
template <class S>
bool take_step(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
               const Way<typename S::Scalar>& way, typename S::Scalar h, typename S::Scalar jam) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const bool goes_on = flow.known;
  begin(world, island, time, h);
  if (island.jams) {
    fall_back(world, island, time, flow.length = jam, true);
    return false;
  }
  keep_start(world, island, method, time, goes_on);
  flow.low.assign(flow.margins.begin(), flow.margins.end());
  if (world.settings.local_error > 0) note_ways(world, island, time);
  flow.end_kept = flow.projects_stages = false;
  // A hook after the substep may change the island, so no step may pass the end.
  const T furthest = world.paces ? std::min(furthest_reach * h, T(world.paces->longest())) : furthest_reach * h;
  const T reach = changes_after_substeps(world, island) ? way.left : std::min(furthest, way.to_break);
  flow.length = world.settings.local_error > 0 ? take_adaptive_step(world, island, method, time, way.left, reach)
                                               : take_fixed_step(world, island, method, time, way.left, h, reach);
  if (flow.length > T(0)) return true;
  const bool costly = method.implicit && std::ssize(island.bodies) > most_to_carry_on;
  fall_back(world, island, time, flow.length = way.left, flow.astray || costly);
  return false;
}

// Takes steps from `done` on until h is reached or passed. Returns the end.
template <class S>
typename S::Scalar take_steps(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                              typename S::Scalar done, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const int most = most_steps_after(flow.exhausted), most_now = most_events + flow.guarded;
  int steps = 0;
  T jam = world.settings.local_error > 0 ? T(shortest_jam) * h : h;
  for (int events = 0; done < h; ++steps) {
    const T time = T(world.time) + done;
    const Way<T> way = way_from(world, island, done, h);
    const bool spent = static_cast<double>(world.counts->evaluations) > world.most_evaluations;
    const bool chatters = spent || events > most_now || flow.slivers > most_slivers || steps >= most;
    if (chatters) fall_back(world, island, time, way.left, false);
    if (chatters || !take_step(world, island, method, time, way, h, std::min(jam, way.left))) {
      done = chatters || flow.length == way.left ? way.end : done + flow.length;
      jam *= T(longer_jam);
      continue;
    }
    flow.longest = std::max<T>(flow.longest, flow.length);
    keep_largest_diagonals(island);
    flow.slivers = flow.length < T(sliver) * flow.longest ? flow.slivers + 1 : 0;
    if (passed_event(flow)) {
      flow.length = go_to_event(world, island, method, time, flow.length, way.left);
      ++world.counts->events;
      events = flow.length > T(0) ? events + 1 : most_now + 1;
      flow.known = false;
    }
    if (flow.length > T(0)) count_step<S>(world.counts, flow.length);
    done = flow.length == way.left ? way.end : done + flow.length;
  }
  flow.exhausted = std::max(0, flow.exhausted + (steps > most ? 1 : -1));
  return done;
}

}  // namespace

template <class S>
void step_runge_kutta(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  if (method.implicit && !fits_collocation(island)) {
    island.trouble = StepProblem::too_large;
    return;
  }
  if (world.last_step > 0) scale_forces(island, T(1 / world.last_step));
  clear_correction(world, island);
  flow.projects_stages = false;         // of the last call
  flow.locates = island.solver->exact;  // sweeps have not shared loads among redundant joints
  flow.fixed_step = world.settings.local_error > 0 ? T(0) : h;
  T end = flow.ahead;
  if (end > T(0) && end <= h) go_to_end(world, island, method, T(world.time) + end);
  end = take_steps(world, island, method, end, h);
  flow.ahead = end - h;
  if (flow.ahead > T(0)) go_between(world, island, method, T(world.time) + end);
  scale_forces(island, h);
}

#define CDOT_INSTANTIATE(S) \
  template void step_runge_kutta(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
