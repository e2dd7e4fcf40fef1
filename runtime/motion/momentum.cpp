#include "runtime/motion/momentum.hpp"

#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

// Of a pose; linear and angular part of a Velocity, which is also an impulse.
template <class T>
spatial::Vector<T> position(const planar::Pose<T>& q) {
  return {q.x, q.y, T(0)};
}
template <class T>
spatial::Vector<T> position(const spatial::Pose<T>& q) {
  return {q.x, q.y, q.z};
}
template <class T>
spatial::Vector<T> linear(const planar::Velocity<T>& v) {
  return {v.x, v.y, T(0)};
}
template <class T>
spatial::Vector<T> linear(const spatial::Velocity<T>& v) {
  return {v.x, v.y, v.z};
}
template <class T>
spatial::Vector<T> angular(const planar::Velocity<T>& v) {
  return {T(0), T(0), v.w};
}
template <class T>
spatial::Vector<T> angular(const spatial::Velocity<T>& v) {
  return {v.wx, v.wy, v.wz};
}
template <class S>
typename S::Velocity velocity(const spatial::Vector<typename S::Scalar>& v,
                              const spatial::Vector<typename S::Scalar>& w) {
  if constexpr (S::dimension == Dimension::planar) return {v.x, v.y, w.z};
  else return {v.x, v.y, v.z, w.x, w.y, w.z};
}

template <class T>
spatial::Symmetric<T> point_inertia(T mass, const spatial::Vector<T>& r) {
  return mass *
         spatial::Symmetric<T>{
             r.y * r.y + r.z * r.z, r.x * r.x + r.z * r.z, r.x * r.x + r.y * r.y, -r.x * r.y, -r.x * r.z, -r.y * r.z};
}

// I of the body, 0 if it does not turn.
template <class T>
spatial::Symmetric<T> inertia_of(const planar::InverseMass<T>& m) {
  return {T(0), T(0), inverse(m.I), T(0), T(0), T(0)};
}
template <class T>
spatial::Symmetric<T> inertia_of(const spatial::InverseMass<T>& m) {
  return spatial::inverse(Spatial<T>::inverse_inertia(m));
}

template <class S>
bool turns(const typename S::InverseMass& m) {
  if constexpr (S::dimension == Dimension::planar) return m.I != 0;
  else return m.Ixx != 0 || m.Iyy != 0 || m.Izz != 0;
}

// The velocity of body i in the rigid motion v + w x (x - centre).
template <class S>
typename S::Velocity rigid(const Bodies<S>& all, int i, const spatial::Vector<typename S::Scalar>& centre,
                           const spatial::Vector<typename S::Scalar>& v, const spatial::Vector<typename S::Scalar>& w) {
  using Vector = spatial::Vector<typename S::Scalar>;
  const Vector moved = v + spatial::cross(w, position(all.pose[i]) - centre);
  return velocity<S>(moved, turns<S>(all.inverse_mass[i]) ? w : Vector{});
}

// I^-1 spin; without the axes about which nothing has inertia.
template <class S>
spatial::Vector<typename S::Scalar> turn_of(const spatial::Symmetric<typename S::Scalar>& inertia,
                                            const spatial::Vector<typename S::Scalar>& spin) {
  using T = typename S::Scalar;
  if constexpr (S::dimension == Dimension::planar) return {T(0), T(0), inverse(inertia.zz) * spin.z};
  else {
    const T least = std::numeric_limits<T>::epsilon() * (inertia.xx + inertia.yy + inertia.zz);
    return spatial::inverse(inertia + spatial::Symmetric<T>{least, least, least, T(0), T(0), T(0)}) * spin;
  }
}

}  // namespace

template <class S>
Momentum<typename S::Scalar> momentum_of(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  const Bodies<S>& all = world.bodies;
  Momentum<T> sum;
  for (int i : island.bodies) {
    const T m = inverse(all.inverse_mass[i].m);
    sum.mass += m;
    sum.centre = sum.centre + m * position(all.pose[i]);
  }
  sum.centre = inverse(sum.mass) * sum.centre;
  for (int i : island.bodies) {
    const auto r = position(all.pose[i]) - sum.centre;
    const auto impulse = S::force(all.inverse_mass[i], all.velocity[i]);
    sum.linear = sum.linear + linear(impulse);
    sum.spin = sum.spin + spatial::cross(r, linear(impulse)) + angular(impulse);
    sum.inertia = sum.inertia + point_inertia(inverse(all.inverse_mass[i].m), r) + inertia_of(all.inverse_mass[i]);
  }
  return sum;
}

template <class S>
void restore_momentum(WorldData<S>& world, const Island<S>& island, const Momentum<typename S::Scalar>& start,
                      typename S::Scalar h) {
  using T = typename S::Scalar;
  using Vector = spatial::Vector<T>;
  Bodies<S>& all = world.bodies;
  const Momentum<T> now = momentum_of(world, island);
  Vector push = start.linear, turn = start.spin;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto force = S::force(all.inverse_mass[i], all.acceleration[i]);
    const Vector middle =
        T(0.5) * ((position(island.flow.pose[k]) - start.centre) + (position(all.pose[i]) - now.centre));
    push = push + h * linear(force);
    turn = turn + h * (spatial::cross(middle, linear(force)) + angular(force));
  }
  const Vector v = inverse(now.mass) * (push - now.linear),
               w = island.spins_freely ? turn_of<S>(now.inertia, turn - now.spin) : Vector{};
  for (int i : island.bodies) all.velocity[i] = S::sum(all.velocity[i], rigid<S>(all, i, now.centre, v, w), T(1));
}

#define CDOT_INSTANTIATE(S)                                                        \
  template Momentum<S::Scalar> momentum_of(const WorldData<S>&, const Island<S>&); \
  template void restore_momentum(WorldData<S>&, const Island<S>&, const Momentum<S::Scalar>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
