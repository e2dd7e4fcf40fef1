// The energy that an island's joints gave to it in steps of Euler's by sweeps.
#include "runtime/sweeps/gain.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/momentum.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

// Of the bodies: the kinetic energy, and the energy that symplectic Euler keeps of a constant force F at the pose x,
// H + h/2 F v. In space the work of torques is booked.
struct Energies {
  double kinetic = 0, kept = 0;
};
template <class S>
Energies level_of(WorldData<S>& world, Island<S>& island, double h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](const auto& gyroscope, int i) { S::set_mass(gyroscope, all.mass[i]); });
  Energies level;
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

// Of the gaps of poses that were set.
template <class S>
double energy_of_gaps(WorldData<S>& world, Island<S>& island, double h) {
  evaluate_present(world, island);
  island.factored = false;
  double energy = 0;
  for (const auto& [batch, begin, end, whole] : island.segments)
    energy += energy_of_gaps(*batch, begin, end, world.bodies, h);
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

// Takes a gain from the motion of bodies against each other, or all that is there. Of its share s the energy T s^2 + c
// s is left, with c = h/2 F v.
template <class S>
void pay(WorldData<S>& world, Island<S>& island, double h, double gain) {
  const Bodies<S>& all = world.bodies;
  const double T = find_own_motion(world, island);
  double c = 0;
  for (int i : island.bodies) {
    const auto acceleration = S::has_gyroscopes ? S::damped(all.acceleration[i], 1, 0) : all.acceleration[i];
    c += 0.5 * h * S::dot(S::weighted(all.mass[i], acceleration), all.increment[i]);
  }
  const double square = c * c + 4 * T * (T + c - gain);
  const double share = (square > 0 ? std::sqrt(square) - c : -c) / (2 * T);
  keep_own_motion(world, island, T > 0 ? std::clamp(share, 0.0, 1.0) : 0);
}

// Adds `sign` times the energy of springs that time drives to what time put in.
template <class S>
void book_driven(WorldData<S>& world, const Island<S>& island, double sign) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int slot = begin; batch->explicit_time() && batch->law && batch->law->energy && slot < end; ++slot)
      put_in(world, static_cast<Source>(batch->source), sign * batch->law->energy(*batch, slot));
}

}  // namespace

template <class S>
double energy_of_gaps(Batch<S>& batch, int begin, int end, const Bodies<S>& bodies, double h) {
  const int rows = batch.ops->rows;
  if (batch.law && !batch.law->error) return 0;
  batch.ops->effective_mass(batch, begin, end, bodies);
  double energy = 0;
  typename S::Scalar error[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    if (batch.law) batch.law->error(batch, slot, error);
    else std::copy_n(batch.C.begin() + slot * rows, rows, error);
    for (int r = 0; r < rows; ++r) {
      const double K = batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r], speed = double(error[r]) / h;
      energy += 0.5 * speed * speed * inverse(K);
    }
  }
  return energy;
}

template <class S>
double stored(const WorldData<S>& world, const Island<S>& island) {
  double energy = world.accounts.taken - world.accounts.put_in;
  for (const Segment<S>& segment : island.segments)
    for (int slot = segment.begin; segment.batch->law && segment.batch->law->energy && slot < segment.end; ++slot)
      energy += segment.batch->law->energy(*segment.batch, slot);
  return energy;
}

template <class S>
double stored_at_start(WorldData<S>& world, Island<S>& island) {
  evaluate_present(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law && batch->law->energy) batch->ops->effective_mass(*batch, begin, end, world.bodies);
  return stored(world, island);
}

template <class S>
void open_level(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step) {
  const auto of_level = last_step > 0 ? typename S::Scalar(last_step) : h;
  if (!island.levelled) {
    if (!island.evaluated) island.gained = island.gained - energy_of_gaps(world, island, double(h));
    island.level = level_of(world, island, double(of_level)).kept;
    island.levelled = true;
  }
  if (of_level == h) return;
  // A step of another length keeps another energy. A debt that is due to h/2 F v pays for nothing.
  const double level = level_of(world, island, double(h)).kept;
  island.gained = island.gained + level - island.level, island.level = level;
}

template <class S>
bool take_gain(WorldData<S>& world, Island<S>& island, double h, double stored) {
  constexpr double noise = by_precision<typename S::Scalar>(1e-5, 1e-9);
  const Energies end = level_of(world, island, h);
  const double gain = end.kept - island.level + stored, gained = island.gained + gain;
  if (!moderate(world, island, h, gain, end.kinetic)) return false;
  const double debt = island.gained;
  island.gained = gained, island.level = end.kept;
  if (!(gained > 0)) return true;
  pay(world, island, h, gained);
  const Energies left = level_of(world, island, h);
  island.gained = gained + left.kept - end.kept, island.level = left.kept;
  return island.gained <= std::max(debt, noise * (left.kinetic + std::abs(left.kept)));
}

template <class S>
void move_slowly(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double speed, bool turning) {
  find_own_motion(world, island);
  keep_own_motion(world, island, speed);
  const auto momentum = island.floats ? momentum_of(world, island) : MomentumOf<S>{};
  if (turning) move_in_own_axes(world, island, h);
  else move_along(world, island, h);
  if constexpr (S::has_gyroscopes) set_inertias(world, island);
  if (island.floats) restore_momentum(world, island, momentum, typename S::Scalar(0));
  island.evaluated = island.factored = false;
}

template <class S>
Start keep_start(WorldData<S>& world, Island<S>& island) {
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

// True if the bodies stand at no more energy than they had. They turn with the island, unless `turning` is false.
template <class S>
bool try_to_stand(WorldData<S>& world, Island<S>& island, typename S::Scalar h, bool turning) {
  using T = typename S::Scalar;
  const double at_start = stored_at_start(world, island);
  book_driven(world, island, -1);
  apply_forces(world, island, h);
  move_slowly(world, island, h, 0, turning);
  evaluate_anew(world, island, T(world.time) + h);
  book_driven(world, island, 1);
  book_stiffness(world, island);
  factorize_rows(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments)
    std::fill(batch->lambda.begin() + begin * batch->ops->rows, batch->lambda.begin() + end * batch->ops->rows, T(0));
  const bool paid = take_gain(world, island, double(h), stored(world, island) - at_start);
  island.evaluated = true;
  island.factored = !island.solver->exact;
  return paid;
}

// Near a pose without direction the round-off of a common rotation turns the angle of a spring by radians.
template <class S>
void stand(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start) {
  for (const bool turning : {true, false}) {
    go_back(world, island, start);
    if (try_to_stand(world, island, h, turning)) return;
  }
}

#define CDOT_INSTANTIATE(S)                                                      \
  template double energy_of_gaps(Batch<S>&, int, int, const Bodies<S>&, double); \
  template double stored(const WorldData<S>&, const Island<S>&);                 \
  template double stored_at_start(WorldData<S>&, Island<S>&);                    \
  template void open_level(WorldData<S>&, Island<S>&, S::Scalar, double);        \
  template bool take_gain(WorldData<S>&, Island<S>&, double, double);            \
  template void move_slowly(WorldData<S>&, Island<S>&, S::Scalar, double, bool); \
  template Start keep_start(WorldData<S>&, Island<S>&);                          \
  template void go_back(WorldData<S>&, Island<S>&, const Start&);                \
  template void stand(WorldData<S>&, Island<S>&, S::Scalar, const Start&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
