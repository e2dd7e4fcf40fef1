// A body whose inertia is not the same about all axes. Its tensor turns with it, and what stays
// while it turns is its angular momentum L = I w: that is the gyroscopic torque, so it appears
// nowhere as a torque. A World has one of these for each such body that can turn, and none for
// others.
#pragma once

#include <cdot/rotation.hpp>

namespace cdot::spatial {

template <class T>
struct Gyroscope {
  Symmetric<T> inertia, inverse;  // in the body's frame: these two never change
  Symmetric<T> world;             // inertia in world axes, at the pose of the last turn()
  Vector<T> torque;               // constant, in world axes
  // L = I w for this w. Kept from step to step, so that round-off of I^-1 I does not add up: what
  // impulses change w by is added to it.
  Vector<T> momentum, spin;
  Vector<T> lent;  // w, while the mean spin of a step stands in for it
};

// The angular velocity about which a free body turns during a step of h, in world axes. Of a body that is symmetric
// about an axis of its frame it is the exact one: the body goes round L at L / I_across and spins about its axis. Else
// Simo & Wong's algorithm C1 (Int. J. Numer. Methods Eng. 31, 1991). In the body's frame
//   theta = h (W0 + W1) / 2,   I W1 = exp(-theta) I W0
// keeps the angular momentum, and the energy as well: its change is theta . (I W1 - I W0) / h, and
// the rotation leaves the part of I W0 along theta alone. Solved by Newton; should that fail
// (h |W| beyond a radian, far from a principal axis) the momentum is still kept, the energy
// bounded.
template <class T>
Vector<T> mean_spin(const Gyroscope<T>& gyroscope, const Pose<T>& q, const Vector<T>& w, T h);

}  // namespace cdot::spatial
