// Euler's step with soft rows (Drift::soft), for sweeps. Before the poses move, each exact row is a damped spring that
// the step resolves. Afterwards sweeps without C take from the velocities what the springs gave them. (E. Catto,
// Solver2D, 2024: soft constraints with relaxation.)
//
// One sweep leaves impulses that do not belong to the poses. Where they would raise the island's energy, its bodies
// lose as much of their motion against each other. If they have less, the step goes back to its start and does without
// the springs of its rows, then with slower bodies.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/momentum.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/integrators.hpp"

namespace cdot {
namespace {

// Of the springs: w h, a third of a turn in the longest of the last steps, and the damping ratio. Above 2.1 the sweeps
// gain energy (25 x 25 grid).
constexpr double turn = 2, damping_ratio = 1;
// Steps that vary keep the stiffness; it follows them within some hundred steps.
constexpr double fading = 0.995;

// An implicit Euler step of a spring of frequency w and damping ratio zeta on one row:
//   rate = w / (2 zeta + w h),   share = 1 / (w h (2 zeta + w h))
template <class T>
SoftSweep<T> soft_sweep(T h, double longest) {
  const double wh = turn * double(h) / longest, divisor = 2 * damping_ratio + wh;
  return {T(wh / divisor) / h, T(1 / (wh * divisor))};
}

// Tension makes the rotation of a body stiff: u = h^2 k / I. Euler's steps are unstable from u = 4 on, and sweeps
// suffer before. Islands below are looked at again after some steps.
constexpr double stiff = 0.5;
constexpr int slack_steps = 8;

// The largest u, from the masses with their stiffness.
template <class S>
double largest_stiffening(const WorldData<S>& world, const Island<S>& island) {
  const Bodies<S>& all = world.bodies;
  double most = 0;
  for (int c = S::lengths; c < S::freedom; ++c) {
    typename S::Scalar numbers[S::freedom] = {};
    numbers[c] = 1;
    const auto torque = S::read_velocity(numbers);
    for (int i : island.bodies) {
      const double stiffened = S::dot(S::weighted(all.effective_mass[i], torque), torque);
      if (stiffened > 0)
        most = std::max(most, S::dot(S::weighted(all.inverse_mass[i], torque), torque) / stiffened - 1);
    }
  }
  return most;
}

template <class S>
void relieve(WorldData<S>& world, Island<S>& island) {
  restore_masses(world, island);
  island.stiffened = island.factored = false;
}

// Makes the step linearly implicit where tension makes rotations stiff. J must be that of the present poses.
template <class S>
void stiffen(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  if (last_step == 0 || island.solver->exact || island.slack-- > 0) return;
  stiffen_masses(world, island, h * (h / typename S::Scalar(last_step)));
  island.stiffened = largest_stiffening(world, island) > stiff;
  if (island.stiffened) return hold_back(world, island);
  island.slack = slack_steps;
  relieve(world, island);
  island.factored = true;  // K has not changed
}

// Limits, ropes and locks, where they are beyond their ends: spring_row() of the same spring. Motors stay rigid.
template <class S>
void fill_laws(WorldData<S>& world, Island<S>& island, typename S::Scalar h, SoftSweep<typename S::Scalar> soft) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    if (batch.law->is_of_effect())
      batch.ops->velocity(batch, segment.begin, segment.end, world.bodies.velocity.data(), batch.rate.data());
    batch.law->fill(batch, segment.begin, segment.end, h, world.settings);
    if (!batch.law->error) continue;
    const int rows = batch.ops->rows;
    T error[most_rows];
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      batch.law->error(batch, slot, error);
      for (int r = 0; r < rows; ++r) {
        const int i = slot * rows + r;
        const bool one_sided = batch.lower[i] == T(0) || batch.upper[i] == T(0), rigid = one_sided && error[r] == T(0);
        const T K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r];
        batch.softness[i] = rigid ? T(0) : K * soft.share;
        batch.bias[i] += soft.rate * error[r];
      }
    }
  }
}

// The relaxation of the last step has evaluated the rows, but changed dC/dt in the bias of laws.
template <class S>
void restore_rates(WorldData<S>& world, Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (island.evaluated && !batch.law) continue;
    if (island.evaluated) restore_drift(world, island, segment);
    else batch.ops->evaluate(batch, segment.begin, segment.end, world.bodies, island.evaluated_at);
  }
}

template <class S>
void evaluate(WorldData<S>& world, Island<S>& island) {
  if (!island.evaluated) island.evaluated_at = typename S::Scalar(world.time);
  restore_rates(world, island);
  island.evaluated = true;
  if (!island.factored) factorize_rows(world, island);
  island.factored = !island.solver->exact;
}

// Of the bodies: the kinetic energy, and the energy that symplectic Euler keeps of a constant force F at the pose x,
// H + h/2 F v. In space the work of torques is booked.
struct Level {
  double kinetic = 0, kept = 0;
};
template <class S>
Level level_of(WorldData<S>& world, Island<S>& island, double h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](const auto& gyroscope, int i) { S::set_mass(gyroscope, all.mass[i]); });
  Level level;
  T x[S::pose_numbers];
  for (int i : island.bodies) {
    const auto& v = all.velocity[i];
    const auto acceleration = S::has_gyroscopes ? S::damped(all.acceleration[i], 1, 0) : all.acceleration[i];
    S::write(all.pose[i], x);
    level.kinetic += 0.5 * S::dot(S::weighted(all.mass[i], v), v);
    level.kept += S::dot(S::weighted(all.mass[i], acceleration), S::sum(S::read_velocity(x), v, T(-0.5 * h)));
  }
  level.kept = level.kinetic - level.kept;
  return level;
}

// The energy of springs, less what was put in and plus what was taken.
template <class S>
double stored(const WorldData<S>& world, const Island<S>& island) {
  double energy = world.accounts.taken - world.accounts.put_in;
  for (const Segment<S>& segment : island.segments)
    for (int slot = segment.begin; segment.batch->law && segment.batch->law->energy && slot < segment.end; ++slot)
      energy += segment.batch->law->energy(*segment.batch, slot);
  return energy;
}

// Impulses of the relaxation alone, into Batch::correction: `sign` -1 before it, 1 after it, 0 to end.
template <class S>
void part_impulses(const Island<S>& island, int sign) {
  if (!island.rows_work) return;
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int i = begin * batch->ops->rows; i < end * batch->ops->rows; ++i)
      batch->correction[i] = sign == 0 ? 0 : sign > 0 ? batch->lambda[i] - batch->correction[i] : batch->lambda[i];
}

template <class S>
void relax(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  part_impulses(island, -1);
  begin_kick(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law || batch->law->force) continue;
    batch->law->fill(*batch, begin, end, h, world.settings);
    std::fill(batch->softness.begin() + begin * batch->ops->rows, batch->softness.begin() + end * batch->ops->rows,
              typename S::Scalar(0));
  }
  island.solver->relax(world, island);
  part_impulses(island, 1);
  book_kick(world, island, Impulses::relaxed, h);
  part_impulses(island, 0);
}

// Of the gaps of poses that were set: the kinetic energy of closing each in a step, (C / h)^2 / 2 K.
template <class S>
double energy_of_gaps(WorldData<S>& world, Island<S>& island, double h) {
  evaluate(world, island);
  double energy = 0;
  typename S::Scalar error[most_rows];
  for (const auto& [batch, begin, end, whole] : island.segments) {
    const int rows = batch->ops->rows;
    if (batch->law && !batch->law->error) continue;
    for (int slot = begin; slot < end; ++slot) {
      if (batch->law) batch->law->error(*batch, slot, error);
      else std::copy_n(batch->C.begin() + slot * rows, rows, error);
      for (int r = 0; r < rows; ++r) {
        const double K = batch->factor[slot * batch->triangle() + r * (r + 1) / 2 + r], speed = double(error[r]) / h;
        energy += 0.5 * speed * speed * inverse(K);
      }
    }
  }
  return energy;
}

// False for a gain of a step by which springs throw bodies about: more energy than the bodies had, and more than
// moves all of them by a tenth of the island.
template <class S>
bool moderate(const WorldData<S>& world, const Island<S>& island, double h, double gain, double kinetic) {
  if (gain < 0.1 * kinetic || gain + island.gained <= 0) return true;
  const double speed = 0.1 * double(island.size) / h;
  double most = 0;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto& v = island.flow.velocity[k];
    most += 0.5 *
            (S::dot(S::weighted(world.bodies.mass[i], v), v) + speed * speed / double(world.bodies.inverse_mass[i].m));
  }
  return gain <= most;
}

// Books the energy that the joints gave to the island, or took, and takes out a gain since the start of the run. False
// if the bodies cannot pay for it: then the poses or the momentum hold energy that the joints made up.
template <class S>
bool take_gain(WorldData<S>& world, Island<S>& island, double h, double stored) {
  constexpr double noise = by_precision<typename S::Scalar>(1e-5, 1e-9);
  const Level end = level_of(world, island, h);
  const double gain = end.kept - island.level + stored, gained = island.gained + gain;
  if (!moderate(world, island, h, gain, end.kinetic)) return false;
  island.gained = gained, island.level = end.kept;
  if (!(gained > 0)) return true;
  calm(world, island, gained);
  const Level calmed = level_of(world, island, h);
  const double unpaid = gained - (end.kinetic - calmed.kinetic);
  island.gained = unpaid > 0 ? 0.0 : gained + calmed.kept - end.kept;
  island.level = calmed.kept;
  return unpaid <= noise * (calmed.kinetic + std::abs(calmed.kept));
}

// How a step is tried.
template <class T>
struct Try {
  SoftSweep<T> rows = {};  // springs of the rows; none: the sweeps begin without impulses, and only take energy
  double last_step = 0;    // [s] of the present impulses
  double speed = 1;        // of the bodies against each other while the poses move, as a share
};

// The poses at the end of the step, where `speed` is left of the motion of bodies against each other.
template <class S>
void move_slowly(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double speed) {
  slow_down(world, island, speed);
  const auto momentum = island.floats ? momentum_of(world, island) : MomentumOf<S>{};
  move_in_own_axes(world, island, h);
  if constexpr (S::has_gyroscopes) set_inertias(world, island);
  if (island.floats) restore_momentum(world, island, momentum, typename S::Scalar(0));
  island.evaluated = island.factored = false;
}

// False if the energy rises; then the state is to be restored.
template <class S>
bool try_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Try<typename S::Scalar>& by) {
  using T = typename S::Scalar;
  evaluate(world, island);
  begin_kick(world, island);
  const double stored_at_start = stored(world, island);
  stiffen(world, island, h, by.last_step);
  if (!island.factored) factorize_rows(world, island);
  fill_laws(world, island, h, by.rows);
  apply_forces(world, island, h);
  island.solver->soften(world, island, by.rows, by.last_step > 0 ? h / T(by.last_step) : T(0));
  book_kick(world, island, Impulses::soft, h);
  if (island.stiffened) relieve(world, island);
  if (by.rows.share > 0) integrate(world, island, h);
  else move_slowly(world, island, h, by.speed);
  evaluate_anew(world, island, T(world.time) + h);
  book_stiffness(world, island);
  factorize_rows(world, island);
  relax(world, island, h);
  const bool paid = take_gain(world, island, double(h), stored(world, island) - stored_at_start);
  island.evaluated = true;
  island.factored = !island.solver->exact;
  return paid;
}

// Adds `sign` times the energy of springs that time drives to what time put in.
template <class S>
void book_driven(WorldData<S>& world, const Island<S>& island, double sign) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int slot = begin; batch->explicit_time() && batch->law && batch->law->energy && slot < end; ++slot)
      put_in(world, static_cast<Source>(batch->source), sign * batch->law->energy(*batch, slot));
}

// No row acts: the bodies stand against each other.
template <class S>
void stand(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  evaluate(world, island);
  const double stored_at_start = stored(world, island);
  book_driven(world, island, -1);
  apply_forces(world, island, h);
  move_slowly(world, island, h, 0);
  evaluate_anew(world, island, T(world.time) + h);
  book_driven(world, island, 1);
  book_stiffness(world, island);
  factorize_rows(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments)
    std::fill(batch->lambda.begin() + begin * batch->ops->rows, batch->lambda.begin() + end * batch->ops->rows, T(0));
  take_gain(world, island, double(h), stored(world, island) - stored_at_start);
  island.evaluated = true;
  island.factored = !island.solver->exact;
}

// The start of a step: poses, velocities and whole turns in Flow, and the accounts.
struct Start {
  double put_in, taken, gained, level;
};
template <class S>
Start keep(WorldData<S>& world, Island<S>& island) {
  const Bodies<S>& all = world.bodies;
  const std::vector<int>& bodies = island.bodies;
  const auto count = static_cast<std::ptrdiff_t>(bodies.size());
  if (count > 0 && bodies.back() - bodies.front() == count - 1) {  // in a row, mostly
    std::copy_n(all.pose.begin() + bodies.front(), count, island.flow.pose.begin());
    std::copy_n(all.velocity.begin() + bodies.front(), count, island.flow.velocity.begin());
  } else
    for (size_t k = 0; k < bodies.size(); ++k)
      island.flow.pose[k] = all.pose[bodies[k]], island.flow.velocity[k] = all.velocity[bodies[k]];
  if (!island.flow.start_turns.empty()) keep_turns(island);
  std::copy(world.accounts.by_source.begin(), world.accounts.by_source.end(), world.kept_by_source.begin());
  return {world.accounts.put_in, world.accounts.taken, island.gained, island.level};
}
template <class S>
void go_back(WorldData<S>& world, Island<S>& island, const Start& start) {
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    world.bodies.pose[island.bodies[k]] = island.flow.pose[k];
    world.bodies.velocity[island.bodies[k]] = island.flow.velocity[k];
  }
  restore_turns(island);
  halt_immovable_bodies(world, island);
  if constexpr (S::has_gyroscopes) set_inertias(world, island);
  restore_masses(world, island);
  island.evaluated = island.factored = false;
  std::copy(world.kept_by_source.begin(), world.kept_by_source.end(), world.accounts.by_source.begin());
  world.accounts.put_in = start.put_in, world.accounts.taken = start.taken;
  island.gained = start.gained, island.level = start.level;
}

// Without springs sweeps take energy only, the more the slower bodies move into the springs of joints and coordinates.
template <class S>
void step_without_gain(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start) {
  for (const double speed : {1.0, 0.25, 0.0625, 0.015625}) {
    go_back(world, island, start);
    if (try_step(world, island, h, {.speed = speed})) return;
  }
  go_back(world, island, start);
  stand(world, island, h);
}

}  // namespace

template <class S>
void step_soft(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  using T = typename S::Scalar;
  island.flow.longest = std::max(h, T(fading) * island.flow.longest);
  if (!island.levelled) {
    if (!island.evaluated) island.gained = island.gained - energy_of_gaps(world, island, double(h));
    island.level = level_of(world, island, double(last_step > 0 ? T(last_step) : h)).kept;
    island.levelled = true;
  }
  const Start start = keep(world, island);
  const Try<T> usual{soft_sweep(h, double(island.flow.longest)), last_step};
  if (!try_step(world, island, h, usual) && std::isfinite(start.level)) step_without_gain(world, island, h, start);
}

#define CDOT_INSTANTIATE(S) template void step_soft(WorldData<S>&, Island<S>&, S::Scalar, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
