// A body whose inertia is not the same about all axes. Its tensor turns with it, and what stays
// while it turns is its angular momentum L = I w: that is the gyroscopic torque, so it appears
// nowhere as a torque. A World has one of these for each such body that can turn, and none for
// others.
#pragma once

#include "runtime/rotation.hpp"

namespace cdot::spatial {

template <class T>
struct Gyroscope {
  int body;
  Symmetric<T> inertia, inverse;  // in the body's frame
  Symmetric<T> world;             // inertia in world axes, at the pose of the last turn()
  Vector<T> torque;               // constant, in world axes
  // L = I w for this w. Kept from step to step, so that round-off of I^-1 I does not add up: what
  // impulses change w by is added to it.
  Vector<T> momentum, spin;
  Vector<T> lent;  // w, while the mean spin of a step stands in for it
};

// The solution d of (I - b x) d = I r: never singular, since its determinant is det I + b . I b.
template <class T>
Vector<T> newton_step(const Symmetric<T>& I, const Vector<T>& b, const Vector<T>& r) {
  const Vector<T> first = {I.xx, I.xy - b.z, I.xz + b.y}, second = {I.xy + b.z, I.yy, I.yz - b.x},
                  third = {I.xz - b.y, I.yz + b.x, I.zz}, right = I * r;
  const Vector<T> across = cross(second, third);
  const T scale = T(1) / dot(first, across);
  return scale * Vector<T>{dot(right, across), dot(right, cross(third, first)),
                           dot(right, cross(first, second))};
}

// The angular velocity about which a free body turns during a step of h, in world axes: Simo &
// Wong's algorithm C1 (Int. J. Numer. Methods Eng. 31, 1991). In the body's frame
//   theta = h (W0 + W1) / 2,   I W1 = exp(-theta) I W0
// keeps the angular momentum, and the energy as well: its change is theta . (I W1 - I W0) / h, and
// the rotation leaves the part of I W0 along theta alone. Solved by Newton; should that fail
// (h |W| beyond a radian, far from a principal axis) the momentum is still kept, the energy
// bounded.
template <class T>
Vector<T> mean_spin(const Gyroscope<T>& gyroscope, const Pose<T>& q, const Vector<T>& w, T h) {
  const Vector<T> before = to_body(q, w), momentum = gyroscope.inertia * before;
  Vector<T> after = before;
  T smallest_residual = std::numeric_limits<T>::infinity();
  Vector<T> best = before;
  for (int round = 0; round < 12; ++round) {
    const Vector<T> mean = T(0.5) * (before + after);
    // exp(-theta) L by Rodrigues: L - sinc theta x L + (1 - cos) / angle^2 theta x (theta x L)
    const Vector<T> theta = h * mean;
    const T angle = norm(theta), s = half_sinc(angle);
    const T sinc = T(2) * s * std::cos(angle / 2), half_versine = T(2) * s * s;
    const Vector<T> across = cross(theta, momentum);
    const Vector<T> turned = momentum - sinc * across + half_versine * cross(theta, across);
    const Vector<T> residual = after - gyroscope.inverse * turned;
    const T size = norm(residual);
    if (size < smallest_residual) best = mean;
    if (!(size < T(0.5) * smallest_residual)) break;  // round-off, or no convergence
    smallest_residual = size;
    // d(exp(-theta) L) = turned x (T dtheta), T -> E for small steps; dtheta = h/2 dW
    after = after - newton_step(gyroscope.inertia, T(0.5) * h * turned, residual);
  }
  return to_world(q, best);
}

}  // namespace cdot::spatial
