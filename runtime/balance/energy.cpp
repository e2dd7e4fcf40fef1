// The energy of a state.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/state/gyroscopes.hpp"
#include "runtime/state/one_slot.hpp"

namespace cdot {
namespace {

// M^-1 of a body at another pose, to which its inertia tensor turns with it.
template <class S>
typename S::InverseMass inverse_mass_at(const WorldData<S>& world, int body, const typename S::Pose& pose) {
  auto m = world.bodies.inverse_mass[body];
  if constexpr (S::has_gyroscopes)
    with_gyroscope(world, body, [&](auto gyroscope) { S::set_inertia(gyroscope, pose, m, {}); });
  return m;
}

// The way from the start along which the force works. A rotation in space is dear, and without a torque it is none.
template <class S>
typename S::Velocity moved_along(const Bodies<S>& all, int body, const typename S::Velocity& force) {
  const auto &now = all.pose[body], &start = all.start[body];
  if constexpr (S::has_gyroscopes)
    if (force.wx == 0 && force.wy == 0 && force.wz == 0)
      return {now.x - start.x, now.y - start.y, now.z - start.z, 0, 0, 0};
  return S::difference(now, start);
}

// The largest force of a row in the last step [N], [N m].
template <class S>
double largest_force(const WorldData<S>& world, const Island<S>& island) {
  double largest = 0;
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i)
      largest = std::max(largest, std::abs(double(segment.batch->lambda[i])));
  }
  return world.last_step > 0 ? largest / world.last_step : 0;
}

// The speeds that a run by this local error may have where it should rest, as beside stiff springs [sizes/s].
double idle_speed(double local_error) {
  constexpr double of_local_error = 1000, most = 0.1;
  return std::min(of_local_error * local_error, most);
}

}  // namespace

template <class S>
double potential_of(const WorldData<S>& world, const Batch<S>& batch, int slot, double time, Batch<S>& one_slot) {
  if (!batch.law || !batch.law->energy) return 0;
  copy_slot(batch, slot, one_slot);
  batch.ops->evaluate(one_slot, 0, 1, world.bodies, typename S::Scalar(time));
  batch.ops->effective_mass(one_slot, 0, 1, world.bodies);
  return batch.law->energy(one_slot, 0);
}

template <class S>
double power_of_stiffness(const WorldData<S>& world, const Batch<S>& batch, int slot, const Along<S>& motion,
                          Batch<S>& one_slot, Bodies<S>& few) {
  using T = typename S::Scalar;
  const auto& [time, epsilon, v] = motion;
  const int bodies = batch.ops->bodies, rows = batch.ops->rows;
  copy_slot(batch, slot, one_slot);
  batch.ops->evaluate(one_slot, 0, 1, world.bodies, time);
  T C[most_rows];
  std::copy_n(one_slot.C.data(), rows, C);
  double energy[2];
  for (int side : {0, 1}) {
    for (int k = 0; k < bodies; ++k) {
      const int body = batch.body[slot * bodies + k];
      one_slot.body[k] = k;
      few.pose[k] = S::moved(world.bodies.pose[body], S::sum({}, v[body], side ? epsilon : -epsilon));
      few.effective_mass[k] = inverse_mass_at(world, body, few.pose[k]);
    }
    batch.ops->evaluate(one_slot, 0, 1, few, side ? time + epsilon : time - epsilon);
    batch.ops->effective_mass(one_slot, 0, 1, few);
    std::copy_n(C, rows, one_slot.C.data());
    energy[side] = batch.law->energy(one_slot, 0);
  }
  return (energy[1] - energy[0]) / (2 * double(epsilon));
}

template <class S>
void reserve(const WorldData<S>& world, Batch<S>& one_slot) {
  for (const auto& batch : world.batches)
    if (batch->law && batch->law->energy && batch->count() > 0)
      for (int slot = 0; slot < (batch->driven() ? batch->count() : 1); ++slot) copy_slot(*batch, slot, one_slot);
}

template <class S>
double potential_of(const WorldData<S>& world, const JointRecord& joint, double time, Batch<S>& one_slot) {
  double energy = 0;
  for (const Place& place : joint.places)
    energy += potential_of(world, *world.batches[place.batch], slot_of(world, place), time, one_slot);
  return energy;
}

template <class S>
double kinetic_energy(const WorldData<S>& world, const Island<S>& island) {
  const Bodies<S>& all = world.bodies;
  double energy = 0;
  for (int i : island.bodies) energy += 0.5 * S::dot(S::force(all.inverse_mass[i], all.velocity[i]), all.velocity[i]);
  return energy;
}

template <class S>
double small_energy(const WorldData<S>& world) {
  using T = typename S::Scalar;
  constexpr double motion = by_precision<T>(1e-3, 1e-6), of_weight = 0.1, way_of_forces = by_precision<T>(1e-5, 1e-12);
  const double speed = std::max(motion, idle_speed(world.settings.local_error));
  const Bodies<S>& all = world.bodies;
  double small = 0;
  for (const Island<S>& island : world.islands) {
    double weight = 0, mass = 0;
    for (int i : island.bodies) {
      const auto linear = S::damped(all.acceleration[i], 1, 0);
      const double m = 1 / double(all.inverse_mass[i].m);
      weight += m * std::sqrt(S::dot(linear, linear)), mass += m;
    }
    const double size = double(island.size), force = largest_force(world, island);
    small += (of_weight * weight + way_of_forces * force) * size + 0.5 * mass * speed * speed * size * size;
  }
  return small;
}

template <class S>
Energy energy_of(const WorldData<S>& world, Batch<S>& one_slot) {
  const Bodies<S>& all = world.bodies;
  Energy energy;
  for (const auto& batch : world.batches) {
    if (!batch->law || !batch->law->energy) continue;
    for (int slot = 0; slot < batch->count(); ++slot)
      if (!world.joints[batch->joint[slot]].broken)
        energy.potential += potential_of(world, *batch, slot, world.time, one_slot);
  }
  for (int i = 0; i < all.count(); ++i) {
    if (all.immovable(i)) continue;
    const auto mass = S::inverted(all.inverse_mass[i]);
    energy.kinetic += 0.5 * S::dot(S::weighted(mass, all.velocity[i]), all.velocity[i]);
    const auto force = S::weighted(mass, all.acceleration[i]), moved = moved_along(all, i, force);
    energy.potential -= S::dot(force, moved);
    if constexpr (S::has_gyroscopes) {
      const double by_torque = S::dot(force, S::damped(moved, 0, 1));
      energy.potential += by_torque, energy.of_torques -= by_torque;
    }
  }
  return energy;
}

#define CDOT_INSTANTIATE(S)                                                                                 \
  template double power_of_stiffness(const WorldData<S>&, const Batch<S>&, int, const Along<S>&, Batch<S>&, \
                                     Bodies<S>&);                                                           \
  template void reserve(const WorldData<S>&, Batch<S>&);                                                    \
  template double potential_of(const WorldData<S>&, const Batch<S>&, int, double, Batch<S>&);               \
  template double potential_of(const WorldData<S>&, const JointRecord&, double, Batch<S>&);                 \
  template double small_energy(const WorldData<S>&);                                                        \
  template double kinetic_energy(const WorldData<S>&, const Island<S>&);                                    \
  template Energy energy_of(const WorldData<S>&, Batch<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
