// Euler's step with soft rows (Drift::soft), for sweeps. Before the poses move, each exact row is a damped spring that
// the step resolves. Afterwards sweeps without C take from the velocities what the springs gave them. (E. Catto,
// Solver2D, 2024: soft constraints with relaxation.)
//
// One sweep leaves impulses that do not belong to the poses. Where they would raise the island's energy, its bodies
// lose as much of their motion against each other.
#include <algorithm>

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

// Books the energy that the joints gave to the island, or took, and takes out a gain since the start of the run. A gain
// that lies in the poses alone stays.
template <class S>
void take_gain(WorldData<S>& world, Island<S>& island, double h, double stored) {
  const Level end = level_of(world, island, h);
  island.gained += end.kept - island.level + stored;
  island.level = end.kept;
  if (!(island.gained > 0)) return;
  calm(world, island, island.gained);
  const Level calmed = level_of(world, island, h);
  const bool at_rest = end.kinetic - calmed.kinetic < 0.999 * island.gained;
  island.gained = at_rest ? 0.0 : double(island.gained) + calmed.kept - end.kept;
  island.level = calmed.kept;
}

}  // namespace

template <class S>
void step_soft(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  using T = typename S::Scalar;
  island.flow.longest = std::max(h, T(fading) * island.flow.longest);
  const SoftSweep<T> rows = soft_sweep(h, double(island.flow.longest));
  evaluate(world, island);
  begin_kick(world, island);
  if (!island.levelled) island.level = level_of(world, island, double(last_step > 0 ? T(last_step) : h)).kept;
  island.levelled = true;
  const double stored_at_start = stored(world, island);
  stiffen(world, island, h, last_step);
  if (!island.factored) factorize_rows(world, island);
  fill_laws(world, island, h, rows);
  apply_forces(world, island, h);
  island.solver->soften(world, island, rows, last_step > 0 ? h / T(last_step) : T(0));
  book_kick(world, island, Impulses::soft, h);
  if (island.stiffened) relieve(world, island);
  integrate(world, island, h);
  evaluate_anew(world, island, T(world.time) + h);
  factorize_rows(world, island);
  relax(world, island, h);
  book_stiffness(world, island);
  take_gain(world, island, double(h), stored(world, island) - stored_at_start);
  island.evaluated = true;
  island.factored = !island.solver->exact;
}

#define CDOT_INSTANTIATE(S) template void step_soft(WorldData<S>&, Island<S>&, S::Scalar, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
