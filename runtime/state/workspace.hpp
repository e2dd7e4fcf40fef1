// Intermediate results of a step: J, K, factors, stages. A step computes them from the State.
#pragma once

#include <compare>
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
  std::vector<T> now;            // numbers of a stage, laid out like FlowState::start
  std::vector<T> low, high;      // margins at the start of a step, then on both sides of an event
  int guarded = 0;               // number of guarded rows
  bool projects_stages = false;  // in steps near a loss of rank
  // Pivots of K at the stages of a step, as shares of their diagonals, [stage][row]; of one row (step/rank_loss.hpp).
  std::vector<double> pivots, of_row;
  T start_residual = 0;        // largest C at the start of the step
  std::vector<T> start_turns;  // counters of whole turns there
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
  // With StepProblem::moved_far: the error, the way and the body of the projection.
  double misfit = 0, moved = 0;
  int moved_body = -1;

  System<S>& at_work() { return stiffened && rescue.built() ? rescue : system; }
  const System<S>& at_work() const { return stiffened && rescue.built() ? rescue : system; }
};

// A joint that carries more than its breaking load.
struct Overload {
  int island;
  double share;  // -load / breaking load
  int joint;
  auto operator<=>(const Overload&) const = default;
};

struct Workspace {
  std::vector<int> awake;  // islands, in order
  std::vector<Overload> overloads;
};

}  // namespace cdot
