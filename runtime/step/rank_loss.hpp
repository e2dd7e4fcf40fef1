// Steps of a Runge-Kutta method that pass near a pose where K loses rank, as the flat pose of a parallelogram. There
// the joints determine the accelerations as a quotient of two numbers that vanish. At the distance d from that pose,
// with K ~ d^2, an error e of a stage's pose changes its accelerations by e / d^2, so the method loses its order;
// round-off of C is magnified by 1 / d in the poses, 1 / d^2 in the velocities and 1 / d^3 in the accelerations. Such a
// step
// - projects every stage onto the joints before it evaluates the accelerations: the vector field f(P(y)), P the
//   projection, is the same on the joints and does not depend on that error;
// - takes a length by which no stage lies close to the pose. The pivots of K at the stages tell when the pose is
// passed.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// Allocates what note_pivots() writes.
template <class S>
void prepare_rank_loss(Island<S>& island, const RungeKuttaOf<S>& method);

// Notes the pivots of K after the accelerations of a stage.
template <class S>
void note_pivots(Island<S>& island, int stage);

template <class T>
struct Passage {
  bool near = false;  // the step needs projected stages
  T length = T(0);    // that leads its stages away from the pose; 0: the present one is as good
  double noise = 0;   // [m/s], [rad/s]: magnified round-off that the velocities of such a step have
};

// Of a step of h whose stages were noted; the length is at most `longest`.
template <class S>
Passage<typename S::Scalar> passage_of(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method,
                                       typename S::Scalar h, typename S::Scalar longest);

}  // namespace cdot
