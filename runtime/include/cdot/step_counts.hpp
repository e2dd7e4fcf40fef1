// Counts over all islands. Those of evaluations, of steps taken and rejected, of events and of steered steps count only
// for integrators that choose their steps.
#pragma once

#include <limits>

namespace cdot {

struct StepCounts {
  long long evaluations = 0;          // of an island's accelerations
  long long taken = 0, rejected = 0;  // the error estimate was too large
  long long events = 0;               // located: a row came into reach, let go, slipped or stuck
  // Step ends that an implicit method took over: too many events, or no step short enough. With fixed steps also: an
  // error estimate above the motion itself even in the smallest parts. It is the midpoint rule, or linearly implicit
  // Euler: with sweeps, where a joint's direction reverses, and for radau5 with more than 20 bodies.
  long long rescued = 0;
  // Blows that an error as small as that of the steps changes much: friction jams there, or a rope across an arm that
  // is nearly straight is met, or not. And the joint of the first one; -1: none.
  long long undecided = 0, undecided_joint = -1;
  // Solutions in which a motor of unlimited force has not its rate, since another one or joints contradict it. And the
  // joints of the first motor and of its rival; -1: none.
  long long contradicted = 0, contradicted_joint = -1, contradicting_joint = -1;
  long long steered = 0;  // steps near a loss of rank of K, with projected stages
  long long crossed = 0;  // of these: over a pose in which two branches of the motion cross but for rounded numbers
  long long retried = 0;  // failed steps that succeeded in parts
  long long direct = 0;   // of these: steps that needed the direct solver in place of the iterative one
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;  // [s]
};

}  // namespace cdot
