// Steps of a Runge-Kutta method that pass near a pose where K loses rank, as the flat pose of a parallelogram. There
// the joints determine the accelerations as a quotient of two numbers that vanish. At the distance d from that pose,
// with K ~ d^2, an error e of a stage's pose changes its accelerations by e / d^2, so the method loses its order;
// round-off of C is magnified by 1 / d in the poses, 1 / d^2 in the velocities and 1 / d^3 in the accelerations. Such a
// step
// - projects every stage onto the joints before it evaluates the accelerations: the vector field f(P(y)), P the
//   projection, is the same on the joints and does not depend on that error;
// - takes a length by which no stage lies close to the pose. The pivots of K at the stages tell when the pose is
//   passed;
// - looks at loads shortly before the pose, as a step that passes it sees none that grows without bound towards it;
//   where one breaks a joint, the step leads there.
#pragma once

#include <algorithm>
#include <cmath>

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Allocates what note_pivots() writes.
template <class S>
void prepare_rank_loss(Island<S>& island, const RungeKuttaOf<S>& method);

// Notes the pivots of K after the accelerations of a stage.
template <class S>
void note_pivots(Island<S>& island, int stage);
// Of the step that was just taken. Stages of one that is rejected may be anywhere, and their rows of any size.
template <class S>
void keep_largest_diagonals(Island<S>& island);

// True if the attempt at a step of h from `time` on came near a loss of rank of K: goes back for one with projected
// stages, of a length h that leads them away from it; 0 if the method cannot pass there. `noise`: magnified round-off
// that the velocities of such a step have [m/s], [rad/s].
template <class S>
bool tries_with_care(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                     typename S::Scalar longest, typename S::Scalar& h, double& noise);

// Attempts at one step with care whose error is too large. Two branches of the motion cross at the pose; numbers that
// are rounded to n digits leave a gap between them. An exact motion then turns into the other branch, within the root
// of that gap, and ever shorter steps would follow it. Here a motion goes straight on: where two leaps find
// the same gap, and errors do not fall with the length, that with the least error is taken.
template <class S>
class Leap {
 public:
  using T = typename S::Scalar;
  // Call before an attempt at a step of h with this error is rejected: the length of another one, at most `longest`,
  // which is `next` unless it would end near the pose; or that of the best attempt before, with its error as `noise`.
  T after(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, T h, double error, T next, T longest,
          double& noise);
  bool taken() const { return taken_; }

 private:
  bool falls(T h, double error, int order) const;

  T length_ = T(0);  // of the best attempt that passed a pose; 0: none
  double error_ = 0, misfit_ = 0;
  bool taken_ = false, led_ = false;
};

// Tells round-off from an error of the length, where no step before bounds that length: two bodies that are a million
// times as heavy as the one between them make a pivot as small as a loss of rank does, and that noise then allows a
// step of any length. An error e ~ h^p falls as the step is shortened, here by half of that power at least.
template <class T>
class Doubt {
 public:
  // `bounded`: there is nothing to tell.
  Doubt(bool bounded, double local_error, int order) : open_(!bounded), local_error_(local_error), order_(order) {}
  // Call after an attempt of h with this error. True if another one is needed, of the length h and with this noise.
  bool asks(double error, T& h, double& noise) {
    const bool tried = longer_ > T(0);
    if (!open_ || (!tried && !(error > local_error_ && error <= noise))) return false;
    if (tried && !(error <= error_ * std::pow(double(h / longer_), 0.5 * order_))) {
      h = longer_, noise = noise_;
      open_ = false;
      return true;
    }
    if (error <= local_error_) return false;
    longer_ = h, error_ = error;
    noise_ = std::max(noise_, noise), noise = 0;
    h *= T(std::max(least_share, std::pow(2 * error / local_error_, -1.0 / order_)));
    return true;
  }

 private:
  static constexpr double least_share = 0.2;  // of a length, for the next attempt

  bool open_;
  double local_error_;
  int order_;
  T longer_ = T(0);  // the last length whose error only its noise allows; 0: none
  double error_ = 0, noise_ = 0;
};

}  // namespace cdot
