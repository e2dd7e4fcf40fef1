#include "runtime/motion/momentum.hpp"

#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

template <class R>
spatial::Symmetric<R> point_inertia(R mass, const spatial::Vector<R>& r) {
  return mass *
         spatial::Symmetric<R>{
             r.y * r.y + r.z * r.z, r.x * r.x + r.z * r.z, r.x * r.x + r.y * r.y, -r.x * r.y, -r.x * r.z, -r.y * r.z};
}

// I of the body, 0 if it does not turn.
template <class R, class T>
spatial::Symmetric<R> inertia_of(const planar::InverseMass<T>& m) {
  return {R(0), R(0), inverse(R(m.I)), R(0), R(0), R(0)};
}
template <class R, class T>
spatial::Symmetric<R> inertia_of(const spatial::InverseMass<T>& m) {
  return spatial::inverse(spatial::Symmetric<R>{R(m.Ixx), R(m.Iyy), R(m.Izz), R(m.Ixy), R(m.Ixz), R(m.Iyz)});
}

template <class S>
bool turns(const typename S::InverseMass& m) {
  if constexpr (S::dimension == Dimension::planar) return m.I != 0;
  else return m.Ixx != 0 || m.Iyy != 0 || m.Izz != 0;
}

// I^-1 spin; without the axes about which nothing has inertia.
template <class S, class R>
spatial::Vector<R> turn_of(const spatial::Symmetric<R>& inertia, const spatial::Vector<R>& spin) {
  if constexpr (S::dimension == Dimension::planar) return {R(0), R(0), inverse(inertia.zz) * spin.z};
  else {
    const R least = std::numeric_limits<R>::epsilon() * (inertia.xx + inertia.yy + inertia.zz);
    return spatial::inverse(inertia + spatial::Symmetric<R>{least, least, least, R(0), R(0), R(0)}) * spin;
  }
}

// The velocity of body i in the rigid motion v + w x (x - centre).
template <class S, class R>
typename S::Velocity rigid(const Bodies<S>& all, int i, const spatial::Vector<R>& centre, const spatial::Vector<R>& v,
                           const spatial::Vector<R>& w) {
  const auto moved = v + spatial::cross(w, position<R>(all.pose[i]) - centre);
  return velocity<S>(Twist<R>{moved, turns<S>(all.inverse_mass[i]) ? w : spatial::Vector<R>{}});
}

template <class R>
struct RigidMotion {
  spatial::Vector<R> centre, v, w, spin;
  spatial::Symmetric<R> inertia;
};

}  // namespace

// L = sum (x - X) x m (v - V) + I w, with the centre of mass X and its velocity V
template <class S>
MomentumOf<S> momentum_of(const WorldData<S>& world, const Island<S>& island) {
  using R = ExactNumber<typename S::Scalar>;
  const Bodies<S>& all = world.bodies;
  MomentumOf<S> sum;
  for (int i : island.bodies) {
    const R m = inverse(R(all.inverse_mass[i].m));
    const auto mass = S::inverted(all.inverse_mass[i]);
    const auto impulse = twist<R>(S::weighted(mass, all.velocity[i]));
    const auto force = twist<R>(S::weighted(mass, all.acceleration[i]));
    sum.mass += m, sum.centre = sum.centre + m * position<R>(all.pose[i]);
    sum.linear = sum.linear + impulse.linear, sum.linear_size += norm(impulse.linear);
    sum.force = sum.force + force.linear, sum.torque = sum.torque + force.angular;
  }
  sum.centre = inverse(sum.mass) * sum.centre;
  const auto V = inverse(sum.mass) * sum.linear;
  for (int i : island.bodies) {
    const R m = inverse(R(all.inverse_mass[i].m));
    const auto impulse = twist<R>(S::force(all.inverse_mass[i], all.velocity[i]));
    const auto r = position<R>(all.pose[i]) - sum.centre;
    const auto orbit = spatial::cross(r, impulse.linear - m * V);
    sum.spin = sum.spin + orbit + impulse.angular;
    sum.spin_size += norm(orbit) + norm(impulse.angular);
    sum.inertia = sum.inertia + point_inertia(m, r) + inertia_of<R>(all.inverse_mass[i]);
  }
  return sum;
}

namespace {

// The motion of a free island as one rigid body with its momentum. Others stand; where forces turn it, it does not
// turn.
template <class S>
RigidMotion<ExactNumber<typename S::Scalar>> rigid_part(const WorldData<S>& world, const Island<S>& island) {
  if (!island.floats) return {};
  const MomentumOf<S> now = momentum_of(world, island);
  using Vector = spatial::Vector<ExactNumber<typename S::Scalar>>;
  const bool spins = island.spins_freely && !pushed(world, island);
  const Vector w = spins ? turn_of<S>(now.inertia, now.spin) : Vector{};
  return {now.centre, inverse(now.mass) * now.linear, w, now.spin, now.inertia};
}

}  // namespace

template <class S>
void restore_momentum(WorldData<S>& world, const Island<S>& island, const MomentumOf<S>& start, typename S::Scalar h) {
  using R = ExactNumber<typename S::Scalar>;
  using Vector = spatial::Vector<R>;
  Bodies<S>& all = world.bodies;
  const MomentumOf<S> now = momentum_of(world, island);
  Vector turn = start.spin + R(h) * now.torque;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto force = twist<R>(S::force(all.inverse_mass[i], all.acceleration[i]));
    const Vector before = position<R>(island.flow.pose[k]) - start.centre,
                 after = position<R>(all.pose[i]) - now.centre;
    turn = turn + R(0.5) * R(h) * spatial::cross(before + after, force.linear);
  }
  const Vector v = inverse(now.mass) * (start.linear + R(h) * now.force - now.linear),
               w = island.spins_freely ? turn_of<S>(now.inertia, turn - now.spin) : Vector{};
  for (int i : island.bodies)
    all.velocity[i] = S::sum(all.velocity[i], rigid<S>(all, i, now.centre, v, w), typename S::Scalar(1));
}

template <class S>
double find_own_motion(WorldData<S>& world, const Island<S>& island) {
  Bodies<S>& all = world.bodies;
  const auto rigid_motion = rigid_part(world, island);
  double energy = 0;
  for (int i : island.bodies) {
    all.increment[i] =
        S::sum(all.velocity[i], rigid<S>(all, i, rigid_motion.centre, rigid_motion.v, rigid_motion.w), -1);
    energy += 0.5 * S::dot(S::force(all.inverse_mass[i], all.increment[i]), all.increment[i]);
  }
  return energy;
}

template <class S>
void keep_own_motion(WorldData<S>& world, const Island<S>& island, double share) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) {
    all.velocity[i] = S::sum(all.velocity[i], all.increment[i], T(share - 1));
    all.increment[i] = {};
  }
}

// exp(turn) with turn = h (w + w') / 2 and w' = I'^-1 L, where I' is turned and L stays.
template <class S, class R>
spatial::Vector<R> turn_of_rigid(const RigidMotion<R>& rigid, R h) {
  constexpr int rounds = 4;
  spatial::Vector<R> turn = h * rigid.w;
  for (int round = 0; round < rounds; ++round) {
    const auto axes = spatial::turned_by(spatial::oriented<R>(0, 0, 0, 1, 0, 0, 0), turn);
    const auto end = spatial::to_world(axes, turn_of<S>(rigid.inertia, spatial::to_body(axes, rigid.spin)));
    turn = R(0.5) * h * (rigid.w + end);
  }
  return turn;
}

template <class S>
void move_in_own_axes(WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  using R = ExactNumber<T>;
  Bodies<S>& all = world.bodies;
  const auto moves = rigid_part(world, island);
  const bool spins = norm(moves.w) > 0;
  const auto turn = spins ? turn_of_rigid<S>(moves, R(h)) : spatial::Vector<R>{};
  const auto axes = spatial::turned_by(spatial::oriented<R>(0, 0, 0, 1, 0, 0, 0), turn);
  for (int i : island.bodies) {
    const auto own = S::sum(all.velocity[i], rigid<S>(all, i, moves.centre, moves.v, moves.w), T(-1));
    all.pose[i] = S::moved(all.pose[i], S::sum({}, own, h));
    const auto r = position<R>(all.pose[i]) - moves.centre, way = R(h) * moves.v + spatial::to_world(axes, r) - r;
    const auto turns_too = turns<S>(all.inverse_mass[i]) ? turn : spatial::Vector<R>{};
    all.pose[i] = S::moved(all.pose[i], velocity<S>(Twist<R>{way, turns_too}));
    const Twist<R> of = twist<R>(own), turned{spatial::to_world(axes, of.linear), spatial::to_world(axes, of.angular)};
    all.velocity[i] =
        S::sum(velocity<S>(turned), rigid<S>(all, i, moves.centre + R(h) * moves.v, moves.v, moves.w), T(1));
  }
}

template <class S>
void move_along(WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  using R = ExactNumber<typename S::Scalar>;
  const auto way = velocity<S>(Twist<R>{R(h) * rigid_part(world, island).v, {}});
  for (int i : island.bodies) {
    auto& pose = world.bodies.pose[i];
    pose.x += way.x, pose.y += way.y;
    if constexpr (S::dimension == Dimension::spatial) pose.z += way.z;
  }
}

#define CDOT_INSTANTIATE(S)                                                   \
  template MomentumOf<S> momentum_of(const WorldData<S>&, const Island<S>&);  \
  template double find_own_motion(WorldData<S>&, const Island<S>&);           \
  template void keep_own_motion(WorldData<S>&, const Island<S>&, double);     \
  template void move_in_own_axes(WorldData<S>&, const Island<S>&, S::Scalar); \
  template void move_along(WorldData<S>&, const Island<S>&, S::Scalar);       \
  template void restore_momentum(WorldData<S>&, const Island<S>&, const MomentumOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
