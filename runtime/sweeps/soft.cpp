// Euler's step with soft rows (Drift::soft), for sweeps. Before the poses move, each exact row is a damped spring that
// the step resolves. Afterwards sweeps without C take from the velocities what the springs gave them. (E. Catto,
// Solver2D, 2024: soft constraints with relaxation.)
//
// A step that its bodies cannot pay for (sweeps/gain.hpp) does without the springs of its rows, then with slower
// bodies.
#include "runtime/sweeps/soft.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/sweeps/gain.hpp"

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
  for (const Segment<S>& segment : island.segments)
    if (segment.batch->law) restore_drift(world, island, segment);
}

template <class S>
void evaluate(WorldData<S>& world, Island<S>& island) {
  if (island.evaluated) restore_rates(world, island);
  evaluate_present(world, island);
  if (!island.factored) factorize_rows(world, island);
  island.factored = !island.solver->exact;
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

// How a step is tried.
template <class T>
struct Try {
  SoftSweep<T> rows = {};  // springs of the rows; none: the sweeps begin without impulses, and only take energy
  double last_step = 0;    // [s] of the present impulses
  double speed = 1;        // of the bodies against each other while the poses move, as a share
};

// False if the energy rises; then the state is to be restored.
template <class S>
bool try_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Try<typename S::Scalar>& by) {
  using T = typename S::Scalar;
  evaluate(world, island);
  begin_kick(world, island);
  const double at_start = stored(world, island);
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
  const bool paid = take_gain(world, island, double(h), stored(world, island) - at_start);
  island.evaluated = true;
  island.factored = !island.solver->exact;
  return paid;
}

// Without springs sweeps take energy only, the more the slower bodies move into the springs of joints and coordinates.
template <class S>
void step_without_gain(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start) {
  for (const double speed : {1.0, 0.25, 0.0625, 0.015625}) {
    go_back(world, island, start);
    if (try_step(world, island, h, {.speed = speed})) return;
  }
  stand(world, island, h, start);
}

}  // namespace

template <class S>
void step_soft(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  using T = typename S::Scalar;
  island.flow.longest = std::max(h, T(fading) * island.flow.longest);
  open_level(world, island, h, last_step);
  const Start start = keep_start(world, island);
  const Try<T> usual{soft_sweep(h, double(island.flow.longest)), last_step};
  if (!try_step(world, island, h, usual) && std::isfinite(start.level)) step_without_gain(world, island, h, start);
}

#define CDOT_INSTANTIATE(S) template void step_soft(WorldData<S>&, Island<S>&, S::Scalar, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
