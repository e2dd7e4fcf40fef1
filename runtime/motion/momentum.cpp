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
void calm(WorldData<S>& world, const Island<S>& island, double energy) {
  using T = typename S::Scalar;
  using Vector = spatial::Vector<ExactNumber<T>>;
  Bodies<S>& all = world.bodies;
  const MomentumOf<S> now = island.floats ? momentum_of(world, island) : MomentumOf<S>{};
  const Vector v = inverse(now.mass) * now.linear,
               w = island.spins_freely ? turn_of<S>(now.inertia, now.spin) : Vector{};
  double own = 0;
  for (int i : island.bodies) {
    all.increment[i] = S::sum(all.velocity[i], rigid<S>(all, i, now.centre, v, w), T(-1));
    own += 0.5 * S::dot(S::force(all.inverse_mass[i], all.increment[i]), all.increment[i]);
  }
  const double left = energy < own ? std::sqrt(1 - energy / own) : 0;
  for (int i : island.bodies) {
    all.velocity[i] = S::sum(all.velocity[i], all.increment[i], T(left - 1));
    all.increment[i] = {};
  }
}

#define CDOT_INSTANTIATE(S)                                                  \
  template MomentumOf<S> momentum_of(const WorldData<S>&, const Island<S>&); \
  template void calm(WorldData<S>&, const Island<S>&, double);               \
  template void restore_momentum(WorldData<S>&, const Island<S>&, const MomentumOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
