// Intermediate results of a step: J, K, factors, stages. A step computes them from the State.
#pragma once

#include <vector>

#include <cdot/step_result.hpp>

#include "runtime/direct/system.hpp"
#include "runtime/number/broyden.hpp"

namespace cdot {

template <class S>
struct FlowWorkspace {
  using T = typename S::Scalar;
  // Euler's methods and RATTLE, by body: poses at the start of the step; velocities there, or before RATTLE's second
  // kick.
  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  Broyden<ExactNumber<T>> search;  // RATTLE: search for the impulses of its first half
  // Runge-Kutta:
  std::vector<T> now;        // numbers of a stage, laid out like FlowState::start
  std::vector<T> low, high;  // margins at the start of a step, then on both sides of an event
  int guarded = 0;           // number of guarded rows
  T start_residual = 0;      // largest C at the start of the step
};

template <class S>
struct IslandWorkspace {
  std::vector<Segment<S>> segments;
  System<S> system;  // of the direct solver and of projections
  // The same with rows of tension, for steps in which a Runge-Kutta method falls back to linearly implicit Euler. Built
  // only if such rows exist.
  System<S> rescue;
  const RowSolver<S>* solver = nullptr;     // that of the settings, except in a retry
  bool stiffened = false;                   // linearly implicit step: effective masses include stiffness
  StepProblem trouble = StepProblem::none;  // problem found by a stage of the step

  System<S>& at_work() { return stiffened && rescue.built() ? rescue : system; }
  const System<S>& at_work() const { return stiffened && rescue.built() ? rescue : system; }
};

struct Workspace {
  std::vector<int> awake;  // islands, in order
};

}  // namespace cdot
