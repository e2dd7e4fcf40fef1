// Newton's matrix has the stiffness G = -d(J^T lambda)/dq of tension, whose part between bodies stands as rows in the
// direct solver's system (runtime/solve/tension.hpp). With the rule's equations (midpoint.cpp),
//
//   (M + h G / 4) w - J^T y = M r,   J w = -C(q') / h,   y = (change of lambda) / 2,
//
// w being the change of v_m and r what it lacks.
#include "runtime/step/find_middle.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/loads.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/step/dampers.hpp"
#include "runtime/step/kick_drift.hpp"

namespace cdot {
namespace {

constexpr int most_newton_rounds = 25;
constexpr double slow = 0.2;  // share of the error that a round may leave without a new factor
// Goals of Newton: C, in units of Island::scale, and the change of a pose in units of Island::size and [rad].
template <class T>
constexpr T closed = T(by_precision<T>(1e-7, 1e-15));
template <class T>
constexpr T settled = T(by_precision<T>(1e-6, 1e-12));
// A larger change of a pose in one round means that the step is too long, in the same units.
template <class T>
constexpr T furthest = T(2);
// Round-off may stop Newton before its goals; this multiple of them is still small. In float 1e4 goals would be a
// hundredth of the size. Only turns at the joints of a chain of n bodies add up to n^2 times as much.
template <class T>
constexpr T nearly(size_t n) {
  const double squared = static_cast<double>(n) * static_cast<double>(n);
  return T(by_precision<T>(std::clamp(squared, 1e2, 1e4), 1e4));
}

// Motors and friction turn round with their coordinate where it has no direction, as a swing near 0: after so many
// rounds theirs stays, or Newton would never end.
constexpr int rounds_with_new_directions = 8;

// C, J and dC/dt at the middle of the step. Of springs, into Batch::impulse and Batch::softness: their impulse without
// dampers, and the softness of their rows of y. With u = h^2 k K, a spring acts at the share theta of the step,
//   lambda = -h k (C + (theta - 1/2) h dC/dt),   theta = max(1/2, 1 - 1/(2 u)),   softness = 2 / (theta h^2 k):
// in the middle, or near the end if it is too stiff for the step.
template <class S>
void look_at_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h, int round) {
  using T = typename S::Scalar;
  drift(world, island, h / 2);
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (round >= rounds_with_new_directions && is_bounded(batch) && !batch.law->error) {
      batch.ops->position(batch, begin, end, world.bodies, T(world.time) + h / 2);  // C says how large forces may be
      continue;
    }
    batch.ops->evaluate(batch, begin, end, world.bodies, T(world.time) + h / 2);
    if (!is_force(batch)) continue;
    find_forces_at_rest(batch, begin, end, batch.impulse.data());
    each_row(batch, begin, end, [&](int i) {
      batch.softness[i] = 0;
      batch.lower[i] = batch.upper[i] = batch.impulse[i] *= h;
    });
    batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
    each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
      if (!(spring.k > T(0))) return;
      const T stiff = h * h * spring.k, theta = std::max(T(0.5), T(1) - T(0.5) * inverse(stiff * K));
      batch.impulse[i] -= (theta - T(0.5)) * stiff * (batch.rate[i] + batch.bias[i]);
      batch.softness[i] = T(2) / (theta * stiff);
      batch.lower[i] = pulls_only(batch, i) ? T(0) : -std::numeric_limits<T>::infinity();
      batch.upper[i] = std::numeric_limits<T>::infinity();
    });
  }
}

// The angle w h by which rows turn in the step: its way bends by (w h)^2 / 8 of the radius, and the middle is off C = 0
// by that. So rows that are redundant at both ends miss a share w h of the errors in the middle. As contradictions, the
// row of a rope beside joints would get forces of no meaning for it, which add up from step to step.
template <class S>
typename S::Scalar turn_of_rows(const Island<S>& island) {
  using T = typename S::Scalar;
  T most = 0;
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (!batch->law)
      each_row(*batch, begin, end, [&, of = batch](int i) { most = std::max(most, std::abs(of->C[i])); });
  return std::sqrt(T(8) * most / island.size);
}

// Of ends that move: where they are at the end of the step says how far they moved.
template <class S>
void forget_rates_of_ends(Batch<S>& batch, int begin, int end) {
  Guard<typename S::Scalar> guard[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    batch.law->guard(batch, slot, guard);
    for (int r = 0; r < batch.ops->rows; ++r) batch.bias[slot * batch.ops->rows + r] += guard[r].rate;
  }
}

// The error of bounded rows in the step, as a rate into Batch::impulse, and the bounds of their impulse. Motors and
// friction (`of_rate`) are asked at the middle: the mean velocity has the speed of a motor. Limits are asked at the
// end, which must not pass theirs.
template <class S>
void find_misses_of_bounded(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool of_rate) {
  using T = typename S::Scalar;
  for (const auto& [segment, begin, end, whole] : island.segments) {
    Batch<S>& batch = *segment;
    if (!is_bounded(batch) || of_rate != !batch.law->error) continue;
    each_row(batch, begin, end, [&](int i) {
      batch.impulse[i] = batch.bias[i];
      if (!of_rate) batch.bias[i] = 0;
    });
    batch.law->fill(batch, begin, end, h, world.settings);
    if (!of_rate && batch.driven()) forget_rates_of_ends(batch, begin, end);
    each_row(batch, begin, end, [&](int i) {
      std::swap(batch.impulse[i], batch.bias[i]);
      if (of_rate) batch.impulse[i] += batch.rate[i];
      else if (batch.error[i] != T(0)) batch.impulse[i] = batch.error[i] / h;
    });
  }
}

// Velocity rows have no C. Their error is what the mean velocity misses, as a displacement. The velocities themselves
// belong to the inertia tensors of the start: in them the impulses would do work of order h^2 in every step.
template <class S>
void find_errors_of_rates(Island<S>& island, typename S::Scalar h) {
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!has_velocity_rows(*batch)) continue;
    each_row(*batch, begin, end, [&, of = batch](int i) {
      if (of->kinds[static_cast<size_t>(i % of->ops->rows)] != RowKind::velocity) return;
      of->error[i] = h * (of->rate[i] + of->bias[i]);
      island.residual = std::max<typename S::Scalar>(island.residual, std::abs(of->error[i]));
    });
  }
}

// A spring whose force changes with C is solved with the joints. Others (a slack rope, a constant force) take their
// present force.
template <class S>
bool is_soft(const Batch<S>& batch, int i) {
  return is_force(batch) && batch.softness[i] > 0;
}

// r = (v + h a / 2 + M^-1 J^T lambda / 2) - v_m, as (M + h G / 4)^-1 M r, into Bodies::increment; J r into Batch::rate.
template <class S>
void find_lack(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto wanted = S::sum(island.flow.velocity[k], all.acceleration[i], h / 2);
    const auto lack = S::sum(wanted, all.velocity[i], T(-1));
    all.increment[i] = S::weighted(all.effective_mass[i], S::force(all.inverse_mass[i], lack));
  }
  for (const auto& [batch, begin, end, whole] : island.segments) {
    each_row(*batch, begin, end, [of = batch](int i) { of->rate[i] = T(0.5) * of->correction[i]; });
    batch->ops->apply(*batch, begin, end, all, batch->rate.data(), all.increment.data());
  }
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->velocity(*batch, begin, end, all.increment.data(), batch->rate.data());
}

// Adds w to v_m. Returns the largest change of a pose.
template <class S>
typename S::Scalar move_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  T largest = 0;
  for (int i : island.bodies) {
    T w[S::freedom];
    S::write(all.increment[i], w);
    for (int c = 0; c < S::freedom; ++c)
      largest = std::max(largest, std::abs(h * w[c]) / (c < S::lengths ? T(island.size) : T(1)));
    all.velocity[i] = S::sum(all.velocity[i], all.increment[i], T(1));
    all.increment[i] = {};
  }
  return largest;
}

// Softness and bounds of y, for rows under a law: the bounds of lambda = present lambda + 2 y.
template <class S>
void bound_changes(Island<S>& island) {
  using T = typename S::Scalar;
  island.at_work().load_laws();
  island.at_work().each_row([&](int row, const Batch<S>& batch, int i) {
    if (!batch.law) return;
    island.at_work().lower[row] = T(0.5) * (batch.lower[i] - batch.correction[i]);
    island.at_work().upper[row] = T(0.5) * (batch.upper[i] - batch.correction[i]);
  });
}

// Solves for y and w; adds 2 y to lambda. `renew`: with a new factor. Returns the largest change of a pose.
template <class S>
typename S::Scalar improve(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool renew) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  find_lack(world, island, h);
  system.load([&](const Batch<S>& batch, int i) {
    const T missed = is_soft(batch, i) ? T(0.5) * batch.softness[i] * (batch.correction[i] - batch.impulse[i])
                     : batch.law       ? batch.impulse[i]
                                       : batch.error[i] / h;
    return -(batch.rate[i] + missed);
  });
  system.load_tensions(world.bodies.increment.data());
  if (renew) system.assemble(world.bodies);
  system.add_to([](const Batch<S>& batch, int i) { return T(0.5) * batch.correction[i]; });
  if (!island.loads.empty()) {
    begin_loads(world, island);
    std::ranges::fill(system.lambda, typename System<S>::Real(0));  // loads start from the present impulses
    const auto solve = [&] {
      bound_changes(island);
      solve_bounded(world, island, system);
      system.find_excess();
    };
    const auto impulse = [&](const Batch<S>& batch, int i, int row) {
      return batch.correction[i] + T(2) * T(system.lambda[row]);
    };
    const auto solution = [&](const LoadedRow<S>& row) {
      const int r = system.blocks[static_cast<size_t>(row.block)].first;
      return RowSolution<T>{impulse(*row.batch, row.place(), r), T(system.excess(r)), T(system.diagonal(r))};
    };
    if (!settle_loads(island, solve, impulse, solution)) island.trouble = StepProblem::jams;
  } else if (system.lawful()) {
    bound_changes(island);
    solve_bounded(world, island, system);
  } else {
    if (renew) {
      system.choose([](const Batch<S>&, int) { return true; });
      island.redundant_rows = system.factor();
      ++world.solves;
    }
    system.solve();
  }
  system.forget_before();
  system.store([&](Batch<S>& batch, int i, auto y) {
    batch.rate[i] = T(y);
    batch.correction[i] += T(2 * y);
  });
  exert(world, island, system, &BatchWorkspace<S>::rate, world.bodies.increment.data());
  return move_middle(world, island, h);
}

// Into Island::residual, and as the error to remove: 0 where misfitting joints keep theirs (`at_start`). Floats would
// creep.
template <class S>
typename S::Scalar find_errors_but_misfits(WorldData<S>& world, Island<S>& island, typename S::Scalar time,
                                           typename S::Scalar at_start, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T error = find_errors(world, island, time);
  island.residual = at_start;
  if (!stays_misfit(world, island, error, h)) return island.residual = error;
  for (const auto& [batch, begin, end, whole] : island.segments)
    each_row(*batch, begin, end, [of = batch](int i) { of->error[i] = T(0); });
  return T(0);
}

// The error that contradicting rows keep, as a motor and the limit it runs into.
template <class S>
typename S::Scalar shared_error(const Island<S>& island, typename S::Scalar at_start) {
  using T = typename S::Scalar;
  T shared = std::isfinite(at_start) ? at_start : T(0);
  for (int r = 0; r < island.at_work().rows(); ++r) shared = std::max(shared, T(std::abs(island.at_work().unmet(r))));
  return T(2) * shared;
}

}  // namespace

// Joints that fitted at the start get back rows that were redundant there before they share an error.
template <class S>
bool find_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T time = T(world.time) + h;
  const T goal = std::max(closed<T> * island.scale, T(0.01) * round_off_of(world, island));
  const T at_start = island.residual, still_small = nearly<T>(island.bodies.size());
  T before = std::numeric_limits<T>::infinity();
  T turn = 0;
  bool renew = true, fitted = left_round_off(world, island);
  for (int round = 0; round < most_newton_rounds; ++round) {
    look_at_middle(world, island, h, round);
    if (renew) turn = turn_of_rows(island), stiffen_masses(world, island, h / 4);
    drift_with_rates(world, island, h);
    find_misses_of_bounded(world, island, h, true);
    const T misfit = find_errors_but_misfits(world, island, time, at_start, h) == T(0) ? T(island.residual) : T(0);
    find_errors_of_rates(island, h);
    if (!std::isfinite(double(island.residual))) return false;
    find_misses_of_bounded(world, island, h, false);
    island.at_work().forgive(turn, (turn * island.residual + round_off_of(world, island)) / h);
    const T change = improve(world, island, h, renew),
            miss = std::max(change / settled<T>, (island.residual - misfit) / goal);
    if (!(change < furthest<T>) || island.trouble != StepProblem::none) return false;
    const bool stays = change <= settled<T> && island.residual <= shared_error(island, at_start);
    if (stays && miss > T(1) && fitted && island.at_work().doubt_missed_rows()) {
      fitted = false, renew = true;
      continue;
    }
    if (miss <= T(1) || (stays && may_contradict(island, at_start)) ||
        (miss <= still_small && miss > T(0.5) * before)) {
      if (misfit == T(0)) note_errors(island);
      drift_with_rates(world, island, h);
      return true;
    }
    renew = !(miss < T(slow) * before);
    before = miss;
  }
  return false;
}

#define CDOT_INSTANTIATE(S) template bool find_middle(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
