// RATTLE: half a kick with impulses along J of the start, such that C = 0 after the drift. Then the drift. Then half a
// kick with impulses along J of the end, such that J v = -dC/dt there. Second order and symmetric, so energy errors do
// not accumulate. (H. C. Andersen, J. Comput. Phys. 52, 1983.) Dampers, motors and friction act at both ends of the
// step; where friction begins or ends within a step, that step is of first order. Limits act at the end.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/balance/parted.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/longest_move.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/state/gyroscopes.hpp"
#include "runtime/step/dampers.hpp"
#include "runtime/step/kick_drift.hpp"

namespace cdot {
namespace {

constexpr int most_in_vain = 4;  // rounds that do not reduce the error
// The goal of Newton, because a remaining C changes the velocities by C / h.
template <class T>
constexpr T round_off = T(by_precision<T>(1e-7, 1e-15));

// Long arms leave more round-off than Newton's goal; in units of Island::size.
template <class T>
constexpr T of_long_arms = T(by_precision<T>(5e-7, 4e-15));
// Share of the first error that is left where its round-off is larger than that of the poses, as on a curved surface.
// Floats are too coarse to tell.
template <class T>
constexpr T slight = T(by_precision<T>(0, 1e-9));

// velocity = flow.velocity + h dv/dt of all forces and of springs, at the velocities of the bodies. Dampers act at the
// ends of the step.
template <class S>
void kick(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  push_free_bodies(world, island);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!is_force(batch)) continue;
    find_forces_at_rest(batch, segment.begin, segment.end, batch.at_rest.data());
    batch.ops->apply(batch, segment.begin, segment.end, all, batch.at_rest.data(), all.velocity_rate.data());
    for (int slot = segment.begin; batch.law->stores_part && slot < segment.end; ++slot)
      batch.law->unstored(batch, slot, at_rest<T>, batch.unstored_at_rest.data() + slot * batch.ops->rows);
  }
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    all.velocity[i] = S::sum(island.flow.velocity[k], all.velocity_rate[i], h);
  }
}

// First guess: the joints' impulses at the end of the last step. Limits and ropes start from none, unless they share
// loads: the drift finds the impulses that hold them, but it cannot take back that of an impact, which would throw the
// bodies off again.
template <class S>
void guess_impulses(WorldData<S>& world, Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    const bool of_end = batch.law && (batch.law->error || is_force(batch));
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) {
      const bool acts = of_end ? holds_at_start(island, batch, i) : acts_at_start(island, batch, i);
      batch.correction[i] = batch.impulse[i] = acts ? share * batch.lambda[i] : T(0);
    }
    batch.ops->apply(batch, segment.begin, segment.end, world.bodies, batch.impulse.data(),
                     world.bodies.velocity.data());
  }
}

// An end that was passed in this half holds from then on, until it would pull. Otherwise the way of Newton's rounds
// would decide how far inside a body stops.
template <class S>
bool end_acts(const Batch<S>& batch, int i) {
  return has_ends(batch) && within_bounds(batch.mode[i]) && (batch.error[i] != 0 || batch.correction[i] != 0);
}

// The errors of ends that hold count inside, too. True if there are some.
template <class S>
bool hold_ends(System<S>& system, typename S::Scalar& worst) {
  bool some = false;
  system.each_row([&](int row, Batch<S>& batch, int i) {
    if (system.broken[row] || !end_acts(batch, i)) return;
    const auto guard = guard_of(batch, i);
    if (!guard.one_sided()) return;
    some = true, batch.error[i] = guard.off_by;
    worst = std::max(worst, std::abs(guard.off_by));
  });
  return some;
}

// Solves again without the ends that would pull: they give back their impulse of this half.
template <class S>
void let_go_of_pulling_ends(System<S>& system) {
  for (bool any = true; any;) {
    any = false;
    system.each_row([&](int row, const Batch<S>& batch, int i) {
      if (system.fixed[row] || system.broken[row] || !end_acts(batch, i)) return;
      const auto guard = guard_of(batch, i);
      const auto impulse = batch.correction[i] + system.lambda[row];
      if (!guard.one_sided() || (guard.lower == 0 ? impulse >= 0 : impulse <= 0)) return;
      system.fixed[row] = System<S>::at_lower, system.lambda[row] = -batch.correction[i];
      any = true;
    });
    if (any) system.factor(), system.solve();
  }
}

// True if the half step reversed velocities: 2 |change| > |v| in the metric of the masses.
template <class S>
bool turned_round(const WorldData<S>& world, const Island<S>& island) {
  double change = 0, before = 0;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto& m = world.bodies.inverse_mass[i];
    const auto& start = island.flow.velocity[k];
    const auto d = S::sum(world.bodies.velocity[i], start, typename S::Scalar(-1));
    change += S::dot(S::force(m, d), d);
    before += S::dot(S::force(m, start), start);
  }
  return 4 * change > before;
}

// True if one more round would move no body by more than the round-off of its pose. The C of a long rod, u u - l^2,
// rounds by more than its ends.
template <class S>
bool closed_to_round_off(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  auto& moves = world.bodies.increment;
  load_errors(system, T(-1));
  if (system.lawful()) factor_rows_with_errors(system, Rates::free, Factor::kept);
  system.solve();
  system.store([](Batch<S>& batch, int i, auto lambda) { batch.impulse[i] = T(lambda); });
  exert(world, island, system, &BatchWorkspace<S>::impulse, moves.data());
  const double way = longest_move<S>(island, moves).way;
  for (int i : island.bodies) moves[i] = {};
  for (int r = 0; r < system.rows(); ++r)
    if (system.unmet(r) != 0) return false;  // rows contradict each other
  return way <= double(round_off_of(world, island));
}

// Near a loss of rank, round-off in C asks for a motion that leaves a larger C: the last round ends before it.
template <class S>
void take_back_last_round(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  System<S>& system = island.at_work();
  for (auto& lambda : system.lambda) lambda = -lambda;
  exert_correction(world, island, system, world.bodies.velocity.data());
  drift(world, island, h);
  island.residual = find_errors(world, island, typename S::Scalar(world.time) + h);
  note_errors(island);
}

template <class S>
void begin_search(Island<S>& island) {
  island.flow.search.begin([&](size_t row) { return island.at_work().diagonal(static_cast<int>(row)); });
}

// The rows that close C. Velocity rows have none: they repeat their impulse of the last half, and their rates are free.
// If these were kept, an error of that impulse would grow by 1 / (1 - c^2) in each step. There c is the correlation of
// such a row with one of C, and 1 at a loss of rank.
template <class S>
void choose_rows_of_drift(System<S>& system, bool rolling, int round) {
  if (system.lawful() || rolling)
    factor_rows_with_errors(system, Rates::free, round == 0 ? Factor::anew : Factor::kept);
}

// Repeats K lambda = -C / h with the factor of the start and Broyden's updates, velocity += M^-1 J^T lambda, and the
// drift. False if the error does not shrink because the step is too long. False also if the solution reverses the
// bodies' velocities. That happens where a joint's direction reverses, as that of a rope whose length passes through 0.
template <class S>
bool drift_onto_joints(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  const T near = std::max(converged<T> * island.scale, of_long_arms<T> * T(island.size));
  const T goal = std::max(round_off<T> * island.scale, T(world.enough));
  begin_search(island);
  T least = std::numeric_limits<T>::infinity(), at_first = 0;
  bool astray = false;
  for (int round = 0, vain = 0;; ++round) {
    drift(world, island, h);
    T error = find_errors(world, island, T(world.time) + h);
    if (round == 0 && stays_misfit(world, island, error, h)) return true;
    island.residual = error, note_errors(island);
    const bool at_ends = system.lawful() && hold_ends(system, error);
    if (round == 0) at_first = error;
    island.residual = error;
    const bool smaller = error < T(0.7) * least, rounded = std::min(least, error) <= near;
    if (!smaller && rounded && error > least) take_back_last_round(world, island, h);
    if (!(island.residual > goal) ||
        (!smaller && (rounded || closed_to_round_off(world, island))))  // round-off may end them early
      return !astray || !turned_round(world, island);
    if (smaller) least = error, vain = 0;
    else if (++vain > most_in_vain)
      return island.residual <= std::max({T(10) * converged<T> * island.scale, near,
                                          std::min(slight<T> * at_first, foreign<T> * island.scale)});
    astray |= vain > 0;
    load_errors(system, T(-1) / h);
    choose_rows_of_drift(system, round == 0 && rolls(island), round);
    system.solve();
    if (at_ends) {  // updates would not know which ends hold
      let_go_of_pulling_ends(system);
      begin_search(island);
    } else if (!island.flow.search.next(system.lambda.data())) {
      return false;
    }
    exert_correction(world, island, system, world.bodies.velocity.data());
  }
}

// Half a kick at the start, with the first guess of the joints' impulses. Angles go on from the start: rounds of the
// drift count no turns.
template <class S>
void start_half(WorldData<S>& world, Island<S>& island, typename S::Scalar h, typename S::Scalar share) {
  for (size_t k = 0; k < island.bodies.size(); ++k) world.bodies.velocity[island.bodies[k]] = island.flow.velocity[k];
  restore_turns(island);
  clear_correction(world, island);
  kick(world, island, h / 2);
  guess_impulses(world, island, share);
}

// For sweeps, and if the drift did not reach C = 0: projects the poses and renews J on the way. Unless the displacement
// is large, displacement / h is added to the velocities and its impulses are kept. Sweeps always add them, because the
// next step corrects the remaining error. In a shorter step, that of the last one, of order h^2, counts by its share.
template <class S>
void drift_with_renewed_directions(WorldData<S>& world, Island<S>& island, typename S::Scalar h,
                                   typename S::Scalar at_start, typename S::Scalar share) {
  using T = typename S::Scalar;
  drift(world, island, h);
  scale_corrections(island, h);
  const T time = T(world.time) + h, error = find_errors(world, island, time);
  island.solver->positions(world, island, time, false);
  fail_if_open(world, island, at_start);
  if (island.solver->exact) fail_if_moved_far(world, island, double(std::max(error, at_start)), double(h));
  const T kept = !island.solver->exact ? share * share : T(correction_is_small(world, island, double(h)));
  add_corrections(world, island, kept / h);
}

// Forces of the second kick are those at the end's velocity, to second order: 2 v_half - v_start. At the end, a body
// whose tensor turns has w = I^-1 L there, for L of the half and of the start.
template <class S>
void expect_end_velocities(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    auto &v = world.bodies.velocity[i], &start = island.flow.velocity[k];
    if constexpr (S::has_gyroscopes)
      if (!island.gyroscopes.empty())
        with_gyroscope(world, i, [&](auto gyroscope) {
          auto mass = world.bodies.inverse_mass[i];
          S::set_inertia(gyroscope, island.flow.pose[k], mass, start);
          S::turn(gyroscope, world.bodies.pose[i], mass, start);
        });
    const auto half = v;
    v = S::sum(S::sum({}, half, T(2)), start, T(-1));
    start = half;
  }
}

// Loads and reactions count the impulses of springs and constant forces, which act as forces: those of a kick of h, and
// at the start those of dampers in `lambda`.
template <class S>
void note_impulses_of_forces(Island<S>& island, typename S::Scalar h, bool at_start) {
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!is_force(*batch)) continue;
    const bool damps = at_start && batch->law->spring;
    for (int i = begin * batch->ops->rows; i < end * batch->ops->rows; ++i) {
      batch->correction[i] += h * batch->at_rest[i];
      if (damps) batch->correction[i] += batch->lambda[i];
    }
  }
}

// True if f(batch) is, of a force.
template <class S, class F>
bool any_force(const Island<S>& island, F f) {
  return std::any_of(island.segments.begin(), island.segments.end(),
                     [&](const Segment<S>& s) { return is_force(*s.batch) && f(*s.batch); });
}

// f(batch, i, guard) for the ends of rows.
template <class S, class F>
void each_end(const Island<S>& island, F f) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!has_ends(batch)) continue;
    each_row(batch, segment.begin, segment.end, [&](int i) {
      const auto guard = guard_of(batch, i);
      if (guard.one_sided()) f(batch, i, guard);
    });
  }
}

// Into Batch::rate of ends: their gaps at the start.
template <class S>
void note_gaps(const Island<S>& island) {
  each_end(island, [](Batch<S>& batch, int i, const auto& guard) { batch.rate[i] = guard.gap(); });
}

// True if the drift closed a gap that was open at the start, or half of it without loads: there the end slows a body.
template <class S>
bool is_struck(const Island<S>& island) {
  using T = typename S::Scalar;
  bool struck = false;
  each_end(island, [&](const Batch<S>& batch, int i, const auto& guard) {
    const T met = foreign<T> * island.scale, near = island.loads.empty() ? T(0.5) * batch.rate[i] : met;
    struck |= batch.rate[i] > met && guard.gap() <= near;
  });
  return struck;
}

// Books the first half: at the poses of its start, to which J belongs, where the books evaluate anything. Dampers act
// before the other impulses, but joints work against them: only along the mean of the whole half kick do joints do no
// work.
template <class S>
void book_start(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (!works_now(world, island)) return;
  const auto swap_poses = [&] {
    for (size_t k = 0; k < island.bodies.size(); ++k)
      std::swap(world.bodies.pose[island.bodies[k]], island.flow.pose[k]);
  };
  const bool in_time = any_force(island, [](const Batch<S>& batch) { return batch.explicit_time(); });
  const bool at_poses = in_time || island.by_mass;
  if (at_poses) swap_poses();
  if (in_time) look_at_effects(world, island, T(world.time));
  book_kick(world, island, Impulses::rattle_start, h);
  if (at_poses) swap_poses();
}

}  // namespace

template <class S>
void step_rattle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T share = begin_kick_drift(world, island, h), at_start = island.residual;
  const bool repeats = repeats_impulses(island), by_sweeps = !island.solver->exact;
  if (repeats) note_gaps(island);
  weigh_springs(world, island);
  begin_kick(world, island);
  push_dampers(world, island, h);
  note_start(world, island);
  keep_turns(island);
  island.flow.start_left.assign(island.left.begin(), island.left.end());
  start_half(world, island, h, share);
  if (by_sweeps || !drift_onto_joints(world, island, h)) {
    if (!by_sweeps && world.at_once) return void(island.trouble = StepProblem::joints_apart);
    if (!by_sweeps) {
      halt_immovable_bodies(world, island);
      start_half(world, island, h, share);
      island.residual = at_start, island.left = island.flow.start_left;
    }
    drift_with_renewed_directions(world, island, h, at_start, share);
  }
  const bool struck = repeats && is_struck(island), started = island.flow.motors_struck;
  book_start(world, island, h / 2);
  note_impulses_of_forces(island, h / 2, true);
  restore_turns(island);
  evaluate_anew(world, island, T(world.time) + h);
  expect_end_velocities(world, island);
  find_rates_of_effects(world, island);
  weigh_springs(world, island);
  if (island.by_mass || !island.drags.empty()) begin_kick(world, island);  // else the books of the end take no start
  kick(world, island, h / 2);
  note_impulses_of_forces(island, h / 2, false);
  if (repeats && !by_sweeps) island.at_work().choose([](const Batch<S>&, int) { return true; });  // rolling as well
  solve_end(world, island, h, struck ? EndLoads::whole : started ? EndLoads::of_end : EndLoads::half);
  book_kick(world, island, Impulses::rattle_end, h / 2);  // the mirror image of the start
  if (!island.loads.empty()) calm_sticking_rows(island);
  const bool anew = repeats && !by_sweeps && settle_clutches(island);
  island.evaluated = !struck && !started && !anew;  // the next step does not repeat friction's share of an impact
}

template <class S>
void prepare_rattle(Island<S>& island) {
  island.flow.pose.resize(island.bodies.size());
  island.flow.velocity.resize(island.bodies.size());
  prepare_turns(island);
  island.flow.start_left.assign(island.left.size(), 0);
  island.flow.search.reserve(static_cast<size_t>(std::max(island.system.rows(), island.rescue.rows())));
}

#define CDOT_INSTANTIATE(S)                                        \
  template void step_rattle(WorldData<S>&, Island<S>&, S::Scalar); \
  template void prepare_rattle(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
