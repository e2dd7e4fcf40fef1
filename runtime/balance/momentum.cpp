// The momentum of islands that nothing holds.
#include <array>
#include <cmath>
#include <vector>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/number/arbitrary.hpp"

namespace cdot {
namespace {

using Three = std::array<double, 3>;

Three cross(const Three& a, const Three& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Three plus(const Three& a, const Three& b, double scale) {
  return {a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]};
}
double norm(const Three& a) { return std::hypot(a[0], a[1], a[2]); }

// The linear and the angular part of a velocity, force or impulse.
template <class S>
void split(const typename S::Velocity& v, Three& linear, Three& angular) {
  typename S::Scalar numbers[S::freedom];
  S::write(v, numbers);
  linear = {double(numbers[0]), double(numbers[1]), 0}, angular = {0, 0, 0};
  if constexpr (S::lengths == 3) linear[2] = double(numbers[2]);
  if constexpr (S::lengths == 3) angular = {double(numbers[3]), double(numbers[4]), double(numbers[5])};
  else angular[2] = double(numbers[2]);
}

template <class S>
Three position(const typename S::Pose& pose) {
  typename S::Scalar numbers[S::pose_numbers];
  S::write(pose, numbers);
  return {double(numbers[0]), double(numbers[1]), S::lengths == 3 ? double(numbers[2]) : 0};
}

struct Motion {
  Three linear{}, angular{};                 // momentum, the angular one about the centre of mass
  Three force{}, torque{};                   // constant ones
  double linear_size = 0, angular_size = 0;  // sums of the bodies' |momentum|
};

// L = sum (x - X) x m (v - V) + I w
template <class S>
Motion motion_of(const WorldData<S>& world, const Island<S>& island) {
  const Bodies<S>& all = world.bodies;
  Motion motion;
  double mass = 0;
  Three centre{};
  for (int i : island.bodies) {
    const double m = 1 / double(all.inverse_mass[i].m);
    Three p, spin, force, torque;
    split<S>(S::force(all.inverse_mass[i], all.velocity[i]), p, spin);
    split<S>(S::force(all.inverse_mass[i], all.acceleration[i]), force, torque);
    mass += m, centre = plus(centre, position<S>(all.pose[i]), m);
    motion.linear = plus(motion.linear, p, 1), motion.linear_size += norm(p);
    motion.force = plus(motion.force, force, 1), motion.torque = plus(motion.torque, torque, 1);
  }
  const Three X = plus({}, centre, 1 / mass), V = plus({}, motion.linear, 1 / mass);
  for (int i : island.bodies) {
    Three p, spin;
    split<S>(S::force(all.inverse_mass[i], all.velocity[i]), p, spin);
    const Three orbit = cross(plus(position<S>(all.pose[i]), X, -1), plus(p, V, -1 / double(all.inverse_mass[i].m)));
    motion.angular = plus(plus(motion.angular, orbit, 1), spin, 1);
    motion.angular_size += norm(orbit) + norm(spin);
  }
  return motion;
}

template <class S>
bool pushed(const WorldData<S>& world, const Island<S>& island) {
  for (int i : island.bodies) {
    Three force, torque;
    split<S>(world.bodies.force[i], force, torque);
    if (norm(force) > 0) return true;
  }
  return false;
}

// A rigid motion of all bodies: along or about the axis `c`.
template <class S>
typename S::Velocity rigid_motion(const typename S::Pose& pose, int c) {
  typename S::Scalar v[S::freedom] = {};
  v[c] = 1;
  if (c >= S::lengths) {
    Three axis{}, x = position<S>(pose);
    axis[S::lengths == 3 ? static_cast<size_t>(c - S::lengths) : 2] = 1;
    const Three arm = cross(axis, x);
    for (int k = 0; k < S::lengths; ++k) v[k] = typename S::Scalar(arm[static_cast<size_t>(k)]);
  }
  return S::read_velocity(v);
}

// True if no row of the slot resists rigid motions along, or about, the axes [first, last). Displacements are tried at
// generic poses, where no direction vanishes by chance. Rotations turn C with the bodies, so they leave it alone only
// where C = 0.
template <class S>
bool lets_move(const Batch<S>& batch, int slot, const Bodies<S>& at, typename S::Scalar time, int first, int last) {
  using Real = ExactNumber<typename S::Scalar>;
  const int rows = batch.ops->rows, bodies = batch.ops->bodies, width = S::freedom * bodies;
  Batch<S> one;
  one.ops = batch.ops;
  one.parameters.assign(batch.parameters.begin() + slot * batch.ops->parameter_size,
                        batch.parameters.begin() + (slot + 1) * batch.ops->parameter_size);
  one.counters.assign(static_cast<size_t>(batch.ops->counters), 0);
  one.body.assign(batch.body.begin() + slot * bodies, batch.body.begin() + (slot + 1) * bodies);
  one.jacobian.resize(static_cast<size_t>(batch.ops->jacobian_size));
  one.C.resize(static_cast<size_t>(rows)), one.bias.resize(static_cast<size_t>(rows));
  batch.ops->evaluate(one, 0, 1, at, time);
  std::vector<Real> J(static_cast<size_t>(rows * width)), weighted(J);
  Real K[most_rows * most_rows];
  batch.ops->dense(one, 0, at, J.data(), weighted.data(), K, most_rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = first; c < last; ++c) {
      double sum = 0, size = 0;
      for (int k = 0; k < bodies; ++k) {
        typename S::Scalar v[S::freedom];
        S::write(rigid_motion<S>(at.pose[one.body[k]], c), v);
        for (int i = 0; i < S::freedom; ++i) {
          const double term = double(J[static_cast<size_t>(r * width + S::freedom * k + i)]) * double(v[i]);
          sum += term, size += std::abs(term);
        }
      }
      if (std::abs(sum) > by_precision<typename S::Scalar>(1e-3, 1e-7) * size) return false;
    }
  }
  return true;
}

// Every body of the island at another pose; the bodies keep their masses.
template <class S>
void scatter(const Island<S>& island, Bodies<S>& at) {
  using T = typename S::Scalar;
  Arbitrary arbitrary;
  for (int i : island.bodies) {
    T numbers[S::freedom];
    for (int k = 0; k < S::freedom; ++k) numbers[k] = T(4 * arbitrary() - 2) * (k < S::lengths ? T(island.size) : T(1));
    at.pose[i] = S::moved(at.pose[i], S::read_velocity(numbers));
  }
}

template <class S>
bool touches_the_world(const WorldData<S>& world, const Island<S>& island) {
  const auto immovable = [&](int body) { return world.bodies.immovable(body); };
  if (!island.drags.empty()) return true;
  for (const Segment<S>& segment : island.segments) {
    const auto body = segment.batch->body.begin();
    const int bodies = segment.batch->ops->bodies;
    if (std::any_of(body + segment.begin * bodies, body + segment.end * bodies, immovable)) return true;
  }
  return false;
}

}  // namespace

template <class S>
void find_free_motions(const WorldData<S>& world, Island<S>& island, Bodies<S>& at) {
  using T = typename S::Scalar;
  island.floats = island.spins_freely = !touches_the_world(world, island);
  for (int i : island.bodies) {
    // A body that cannot turn absorbs torques.
    Three linear, angular;
    split<S>(S::weighted(world.bodies.inverse_mass[i], rigid_motion<S>(typename S::Pose{}, S::freedom - 1)), linear,
             angular);
    island.spins_freely = island.spins_freely && (norm(angular) > 0 || island.bodies.size() == 1);
  }
  if (!island.floats) return;
  scatter(island, at);
  for (const Segment<S>& segment : island.segments) {
    for (int slot = segment.begin; segment.batch->ops->rows > 0 && slot < segment.end; ++slot) {
      island.floats = island.floats && lets_move(*segment.batch, slot, at, T(world.time), 0, S::lengths);
      island.spins_freely =
          island.spins_freely && lets_move(*segment.batch, slot, world.bodies, T(world.time), S::lengths, S::freedom);
    }
  }
  for (int i : island.bodies) at.pose[i] = world.bodies.pose[i];
  island.spins_freely = island.spins_freely && island.floats;
}

template <class S>
void measure_momentum(const WorldData<S>& world, Island<S>& island) {
  const Motion motion = motion_of(world, island);
  std::copy(motion.linear.begin(), motion.linear.end(), island.momentum.begin());
  std::copy(motion.angular.begin(), motion.angular.end(), island.momentum.begin() + 3);
  island.momentum[6] = world.time;
}

template <class S>
void compare_momentum(const WorldData<S>& world, const Island<S>& island, Balance& balance) {
  if (island.momentum.empty() || island.momentum[6] < 0) return;
  const Motion now = motion_of(world, island);
  const double time = world.time - island.momentum[6];
  const auto compare = [&](const double* start, const Three& sum, const Three& given, double size,
                           Balance::Momentum& worst) {
    const Three change = plus(plus(sum, {start[0], start[1], start[2]}, -1), given, -time);
    const Balance::Momentum mine{norm(change), size, island.bodies.front()};
    // By share; 0 / 0 is no error.
    if (worst.body < 0 || !(mine.error * worst.scale <= worst.error * mine.scale)) worst = mine;
  };
  compare(island.momentum.data(), now.linear, now.force, now.linear_size, balance.linear);
  // Constant forces at moving places have a torque that is not constant.
  if (island.spins_freely && !pushed(world, island))
    compare(island.momentum.data() + 3, now.angular, now.torque, now.angular_size, balance.angular);
}

#define CDOT_INSTANTIATE(S)                                                     \
  template void find_free_motions(const WorldData<S>&, Island<S>&, Bodies<S>&); \
  template void measure_momentum(const WorldData<S>&, Island<S>&);              \
  template void compare_momentum(const WorldData<S>&, const Island<S>&, Balance&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
