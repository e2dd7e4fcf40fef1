// All that a step computes from the State, and reads again only within the step: J, K, factors, stages.
#pragma once

#include <vector>

#include <cdot/step_result.hpp>

#include "runtime/direct/system.hpp"
#include "runtime/number/broyden.hpp"

namespace cdot {

template <class S>
struct FlowWorkspace {
  using T = typename S::Scalar;
  // Euler's methods and RATTLE: at the start of the step, by body.
  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  Broyden<ExactNumber<T>> search;  // RATTLE: for the impulses of its first half
  // Runge-Kutta:
  std::vector<T> now;        // of a stage, as FlowState::start
  std::vector<T> low, high;  // margins at the start of a step, then on both sides of an event
  int guarded = 0;           // rows that come and go at events
  T start_residual = 0;      // of C where the step starts
};

template <class S>
struct IslandWorkspace {
  std::vector<Segment<S>> segments;
  System<S> system;  // of the direct solver and of projections
  // The same with rows of tension, for steps that a method at acceleration level leaves to the linearly implicit one;
  // built where there are such rows.
  System<S> rescue;
  const RowSolver<S>* solver = nullptr;     // that of the settings, but where a step that failed is tried again
  bool stiffened = false;                   // effective masses are more than masses: those of a linearly implicit step
  StepProblem trouble = StepProblem::none;  // that a stage of the step ran into

  System<S>& at_work() { return stiffened && rescue.built() ? rescue : system; }
  const System<S>& at_work() const { return stiffened && rescue.built() ? rescue : system; }
};

struct Workspace {
  std::vector<int> awake;  // islands, in order
};

}  // namespace cdot
