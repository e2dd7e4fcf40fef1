// A body whose inertia differs between axes. Its tensor I turns with the body while the angular momentum L = I w stays
// constant. Keeping L replaces the gyroscopic torque w x I w, which the step therefore never adds. A World has one
// Gyroscope for each such body that can turn.
#pragma once

#include <cdot/rotation.hpp>

namespace cdot::spatial {

template <class T>
struct Gyroscope {
  Symmetric<T> inertia, inverse;  // in the body's frame: these two never change
  Symmetric<T> world;             // inertia in world axes, at the pose of the last turn()
  Vector<T> torque;               // constant, in world axes
  // momentum = I spin, at the last turn(). L is carried from step to step, so round-off of I^-1 I does not accumulate:
  // changes of w by impulses are added to L.
  Vector<T> momentum, spin;
  Vector<T> lent;  // w, while the step's mean spin stands in its place
};

// The mean angular velocity of a free body during a step of h, in world axes. For a body that is symmetric about an
// axis of its frame the result is exact: the body precesses about L at the rate L / I_across and spins about its axis.
// Otherwise Simo & Wong's algorithm C1 (Int. J. Numer. Methods Eng. 31, 1991). In the body's frame
//   theta = h (W0 + W1) / 2,   I W1 = exp(-theta) I W0
// conserves the angular momentum. It also conserves the energy: the energy changes by theta . (I W1 - I W0) / h, and
// the rotation does not change the part of I W0 along theta. Newton solves for W1. If Newton fails (h |W| above 1 rad,
// far from a principal axis), the momentum is still conserved and the energy bounded.
template <class T>
Vector<T> mean_spin(const Gyroscope<T>& gyroscope, const Pose<T>& q, const Vector<T>& w, T h);

}  // namespace cdot::spatial
