// The implicit midpoint rule with joints: the forces of the joints and of springs act with the directions of the middle
// of the step, so that stiffness from tension and stiff springs is stable at every step. With the middle pose q_m,
//
//   M (v_m - v) = (h f + J(q_m)^T lambda) / 2,   q' = q + h v_m,   C(q') = 0,   v' = 2 v_m - v,
//
// then v' is projected onto J(q') v' = -dC/dt. find_middle.hpp solves it by Newton. The rule is of second order and
// exact in the work of constant forces; the projection alone takes energy, by the fifth power of the angle turned in a
// step. (E. Hairer, C. Lubich, G. Wanner, "Geometric Numerical Integration", 2006, II.1 and IV.4.) Limits, motors and
// friction act at the ends of the step.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/guarded.hpp"
#include "runtime/motion/momentum.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/motion/vectors.hpp"
#include "runtime/solve/loads.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/dampers.hpp"
#include "runtime/step/find_middle.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/step/kick_drift.hpp"
#include "runtime/step/work_in_part.hpp"

namespace cdot {

namespace {

template <class T>
constexpr int most_parts = static_cast<int>(by_precision<T>(8, 64));  // of a step
constexpr double small_turn = 0.25, most_turning_parts = 64;          // of step_midpoint_from() [rad]

// `correction` becomes the first guess of lambda, from the last step scaled by `share`; `lambda` the impulses of
// dampers at the start. Of an end and of an unlimited motor that drives against it, the impulses have no size of their
// own. As guesses they would add up from step to step, and hold the bodies at the end until they are undone.
template <class S>
void push_at_start(WorldData<S>& world, Island<S>& island, typename S::Scalar h, typename S::Scalar share) {
  using T = typename S::Scalar;
  const bool adds_up = has_unlimited_motor_beside_ends(island);
  each_row(island, [&](Batch<S>& batch, int i) {
    batch.correction[i] = adds_up && is_bounded(batch) ? T(0) : share * (batch.lambda[i] + batch.correction[i]);
    batch.lambda[i] = 0;
  });
  weigh_springs(world, island);
  push_dampers(world, island, h);
}

// v = exp(-d h) v of bodies with drag: exact for drag alone.
template <class S>
void drag(WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  for (const Drag<S>& drag : island.drags) {
    auto& v = world.bodies.velocity[drag.body];
    const auto energy = [&] { return 0.5 * S::dot(S::force(world.bodies.inverse_mass[drag.body], v), v); };
    const double before = energy();
    v = S::damped(v, std::exp(-h * drag.linear), std::exp(-h * drag.angular));
    take(world, Source::damping, before - energy());
  }
}

template <class S>
void leave_middle(WorldData<S>& world, Island<S>& island) {
  restore_masses(world, island);
  island.at_work().forgive(0, 0);
  island.at_work().slacken();
  island.factored = false;
}

// f() sees the mean spins of bodies whose inertia tensor turns: theirs belong to the tensor of the start.
template <class S, class F>
void with_mean_spins(WorldData<S>& world, Island<S>& island, typename S::Scalar h, F f) {
  if constexpr (S::has_gyroscopes) {
    Bodies<S>& all = world.bodies;
    const auto swap_poses = [&] {
      for (size_t k = 0; k < island.bodies.size(); ++k) std::swap(all.pose[island.bodies[k]], island.flow.pose[k]);
    };
    swap_poses();
    for_each_gyroscope(world, island,
                       [&](auto& gyroscope, int i) { S::lend_mean_spin(gyroscope, all.pose[i], all.velocity[i], h); });
    swap_poses();
    f();
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) { S::restore_spin(gyroscope, all.velocity[i]); });
  } else {
    f();
  }
}

// Books the forces of the middle, to whose poses C and dC/dt belong.
template <class S>
void book_middle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  if (!works_now(world, island)) return;
  const bool evaluates = has_effects(island) || island.restless;
  if (evaluates) {
    drift(world, island, h / 2);
    look_at_effects(world, island, typename S::Scalar(world.time) + h / 2);
  }
  with_mean_spins(world, island, h, [&] { book_kick(world, island, Impulses::middle, h); });
  if (evaluates) drift(world, island, h);
}

// v' = 2 v_m - v
template <class S>
void double_middle(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    auto& v = world.bodies.velocity[island.bodies[k]];
    v = S::sum(S::sum({}, v, T(2)), island.flow.velocity[k], T(-1));
  }
  each_row(island, [](Batch<S>& batch, int i) { batch.correction[i] += batch.lambda[i]; });
}

// Softness and bounds of the rows under a law at the end of the step. The whole impulse of a limit, a motor or friction
// keeps its bounds, and a rope never pushes. Bounds of a force are those of the middle, but for loads: theirs is that
// of the whole impulses. If the end added friction for each of its own impulses, friction that makes its own load would
// jam.
template <class S>
void bound_end(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  unload(island);
  factorize_rows(world, island);
  find_rates_of_effects(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law) continue;
    if (is_bounded(*batch)) {
      const bool of_force = !batch->law->error;
      each_row(*batch, begin, end, [of = batch](int i) { of->impulse[i] = of->lower[i], of->error[i] = of->upper[i]; });
      batch->law->fill(*batch, begin, end, h, world.settings);
      if (batch->law->cone_rows > 0) continue;  // the solver knows the whole force
      each_row(*batch, begin, end, [=, of = batch](int i) {
        of->lower[i] = (of_force ? of->impulse[i] : of->lower[i]) - of->correction[i];
        of->upper[i] = (of_force ? of->error[i] : of->upper[i]) - of->correction[i];
      });
      continue;
    }
    const auto pulled = [](const Batch<S>& of, int i) { return of.correction[i]; };
    bound_dampers(*batch, begin, end, h, true, pulled);
  }
}

// Keeps impulses, poses, velocities and whole turns of the start of a part, and goes back to them.
template <class S>
void keep(WorldData<S>& world, Island<S>& island) {
  size_t k = 0;
  each_row(island, [&](const Batch<S>& batch, int i) {
    island.flow.kept[k++] = batch.lambda[i];
    island.flow.kept[k++] = batch.correction[i];
  });
  for (int i : island.bodies) world.bodies.displacement[i] = world.bodies.velocity[i];
  keep_turns(island);
}
template <class S>
void go_back_to_kept(WorldData<S>& world, Island<S>& island) {
  size_t k = 0;
  each_row(island, [&](Batch<S>& batch, int i) {
    batch.lambda[i] = island.flow.kept[k++];
    batch.correction[i] = island.flow.kept[k++];
  });
  for (size_t n = 0; n < island.bodies.size(); ++n) {
    const int i = island.bodies[n];
    world.bodies.pose[i] = island.flow.pose[n];
    world.bodies.velocity[i] = world.bodies.displacement[i];
    world.bodies.increment[i] = {};
  }
  restore_turns(island);
  halt_immovable_bodies(world, island);
  if constexpr (S::has_gyroscopes) set_inertias(world, island);
  restore_masses(world, island);
  island.evaluated = island.factored = false;
}

// Of the impulses mu of the joints at the end, mu (J v + dC/dt) / 2 [J].
struct WorkAtEnd {
  double taken = 0;       // less what they gave; 0 if a limit was hit, which takes energy by itself
  double given_back = 0;  // by joints that time does not drive
};

// The velocities at the end: J v = -dC/dt.
template <class S>
WorkAtEnd solve_end_of_part(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  auto* const v = world.bodies.velocity.data();
  for (const auto& [batch, begin, end, whole] : island.segments) {
    batch->ops->velocity(*batch, begin, end, v, batch->rate.data());
    each_row(*batch, begin, end, [of = batch](int i) { of->error[i] = of->rate[i] + of->bias[i]; });
  }
  island.at_work().forgive(0, std::max<T>(island.residual, round_off_of(world, island)) / h);
  island.corrections_in_cones = 1, island.solver->velocities(world, island, v, T(1)), island.corrections_in_cones = 0;
  island.at_work().forgive(0, 0);
  double loss = 0, given = 0;
  bool hit = false;
  each_row(island, [&](const Batch<S>& batch, int i) {
    const double work = 0.5 * double(batch.lambda[i]) * double(batch.error[i]);
    if (batch.law) hit |= batch.law->error && batch.correction[i] + batch.lambda[i] != T(0);
    else loss -= work;
    if (!batch.law && !batch.explicit_time()) given += work;
  });
  return {hit ? 0 : loss, std::max(given, 0.0)};
}

// The power [W] that passes through an effect at the present rates. 0 if it takes some of it, as a damper does; a
// magnetic field takes none.
template <class S>
double passing_power(const Batch<S>& batch, int slot) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows, first = slot * rows;
  T rate[most_rows] = {}, force[most_rows] = {};
  for (int r = 0; r < rows; ++r) rate[r] = batch.rate[first + r] + batch.bias[first + r];
  batch.law->unstored(batch, slot, rate, force);
  double sum = 0, size = 0;
  for (int r = 0; r < rows; ++r) {
    const double power = double(force[r]) * double(rate[r]);
    sum += power, size += std::abs(power);
  }
  constexpr double rounded = 16 * double(std::numeric_limits<T>::epsilon());
  return sum < -rounded * size ? 0 : size;
}

// Work of effects that take none, in proportion to the power that passes through them.
template <class S>
void give_by_effects(WorldData<S>& world, const Island<S>& island, double energy) {
  const auto each_power = [&](auto f) {
    for (const auto& [batch, begin, end, whole] : island.segments)
      for (int slot = begin; is_force(*batch) && batch->law->is_of_effect() && slot < end; ++slot)
        f(batch->source, passing_power(*batch, slot));
  };
  find_rates_of_effects(world, island);
  double all = 0;
  each_power([&](size_t, double power) { all += power; });
  if (!(all > 0)) return;
  each_power([&](size_t source, double power) { put_in(world, static_cast<Source>(source), energy * power / all); });
}

// Effects of rates act at both ends of a part, first on bodies without their joints. At the end the joints do work that
// is theirs: with v0 the velocities before and M v1 = M v0 + J^T mu, J v1 = 0, only effects make mu J v0 positive.
// Dampers have taken too much; effects that take nothing have given too little. Drives in time are joints.
template <class S>
void give_back(WorldData<S>& world, const Island<S>& island, double energy) {
  auto& now = world.accounts.by_source;
  auto& before = world.kept_by_source;
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (!batch->law && batch->explicit_time()) before[batch->source] = now[batch->source];
  double taken = 0;
  for (size_t k = 0; k < now.size(); ++k) taken += std::max(before[k] - now[k], 0.0);
  const double share = taken > 0 ? std::min(energy / taken, 1.0) : 0;
  for (size_t k = 0; k < now.size(); ++k) now[k] += share * std::max(before[k] - now[k], 0.0);
  world.accounts.taken -= share * taken;
  if (energy > share * taken) give_by_effects(world, island, energy - share * taken);
}

// One part of a step, of length h. False, with the state of its start, if it is too long: Newton fails, or the joints
// do work. A last part may lose energy.
template <class S>
bool take_part(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool last) {
  using T = typename S::Scalar;
  const T share = begin_kick_drift(world, island, h);
  const auto momentum = island.floats ? momentum_of(world, island) : MomentumOf<S>{};
  keep(world, island);
  const double put_in = world.accounts.put_in, taken = world.accounts.taken;
  std::copy(world.accounts.by_source.begin(), world.accounts.by_source.end(), world.kept_by_source.begin());
  const auto give_up = [&] {
    go_back_to_kept(world, island);
    world.accounts.put_in = put_in, world.accounts.taken = taken;
    std::copy(world.kept_by_source.begin(), world.kept_by_source.end(), world.accounts.by_source.begin());
    return false;
  };
  begin_kick(world, island);
  push_at_start(world, island, h, share);
  book_kick(world, island, Impulses::dampers, h);
  drag(world, island, h / 2);
  note_start(world, island);
  const bool found = find_middle(world, island, h);
  leave_middle(world, island);
  double given = 0;
  if (!found || !joints_fit(world, island, h, last, given)) return give_up();
  island.evaluated_at = T(world.time) + h / 2;
  book_middle(world, island, h);
  double_middle(world, island);
  evaluate_anew(world, island, T(world.time) + h);
  restore_masses(world, island);
  book_stiffness(world, island);
  if (island.floats) restore_momentum(world, island, momentum, h);
  drag(world, island, h / 2);
  bound_end(world, island, h);
  const double energy = moved_energy(world, island);
  begin_kick(world, island);
  const WorkAtEnd joints = solve_end_of_part(world, island, h);
  forget_dampers(world, island);
  if (!last && joints.taken > slight_work<T> * energy && !hardly_moves(world, island, h)) return give_up();
  without_calming(world, island, h, [&] { book_kick(world, island, Impulses::end, h); });
  give_back(world, island, given + joints.given_back);
  island.evaluated = true;
  return true;
}

// Linearly implicit Euler, which takes every step.
template <class S>
void fall_back(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  step_euler(world, island, h, 0);
  restore_masses(world, island);
  island.factored = false;
}

// Impulses over `from` become those of the same forces over `to`.
template <class S>
void stretch_impulses(const Island<S>& island, typename S::Scalar from, typename S::Scalar to) {
  each_row(island, [by = to / from](Batch<S>& batch, int i) {
    batch.lambda[i] *= by;
    batch.correction[i] *= by;
  });
}

// The largest angle [rad] by which a body turns in h.
template <class S>
double turn_of(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  double spin = 0;
  for (int i : island.bodies) {
    const auto w = twist<double>(world.bodies.velocity[i]).angular;
    spin = std::max(spin, std::hypot(w.x, w.y, w.z));
  }
  return double(h) * spin;
}

}  // namespace

// A step that is too long is taken in parts. Joints that contradict each other have no middle: Euler's step solves them
// by least squares.
template <class S>
void step_midpoint(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  begin_kick_drift(world, island, h);
  if (left_misfits(world, island)) return step_rattle(world, island, h);
  const double start = world.time, before = world.last_step;
  // Whole numbers: a sum of parts may miss h by round-off, and one part too many would follow.
  int done = 0, parts = 1;
  while (done < parts) {
    const T part = h / T(parts);
    const bool last = 2 * parts > most_parts<T>;
    const bool taken = take_part(world, island, part, last);
    if (island.trouble != StepProblem::none) break;
    if (!taken && !last) {
      done *= 2, parts *= 2;
      continue;
    }
    if (!taken) {
      ++world.counts->rescued;
      fall_back(world, island, part);
    }
    ++done;
    world.last_step = double(part);
    world.time = start + double(h) * done / parts;
  }
  world.time = start, world.last_step = before;
  if (parts > 1) stretch_impulses(island, h / T(parts), h);
}

template <class S>
void step_midpoint_from(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h) {
  using T = typename S::Scalar;
  const double start = world.time, last_step = world.last_step;
  const auto rescued = world.counts->rescued;
  for (T done = 0; done < h && island.trouble == StepProblem::none;) {
    const T left = h - done;
    const double parts =
        std::min(std::ceil(turn_of(world, island, left) / small_turn), most_turning_parts * double(left / h));
    T part = left / T(std::max(parts, 1.0));
    if (part > T(0.99) * left) part = left;  // no sliver is left
    world.time = double(time + done);
    step_midpoint(world, island, part);
    world.last_step = double(part);
    done = part == left ? h : done + part;
  }
  world.counts->rescued = rescued;  // the step counts once
  world.time = start, world.last_step = last_step;
  each_row(island, [](Batch<S>& batch, int i) {
    batch.lambda[i] += batch.correction[i];
    batch.correction[i] = 0;
  });
}

template <class S>
void prepare_midpoint(Island<S>& island) {
  prepare_rattle(island);
  island.flow.kept.assign(2 * static_cast<size_t>(island.system.rows()), typename S::Scalar(0));
}

#define CDOT_INSTANTIATE(S)                                                          \
  template void step_midpoint(WorldData<S>&, Island<S>&, S::Scalar);                 \
  template void step_midpoint_from(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar); \
  template void prepare_midpoint(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
