// The result of step(): success, or the problem and its place. Plain data, because step() must not allocate.
#pragma once

#include <string>

namespace cdot {

enum class StepProblem : char {
  none,
  bad_step,      // the step's length is not a finite number > 0
  not_finite,    // a pose or a velocity became infinite or NaN
  joints_apart,  // Newton did not converge, or left a larger C than the motion had
  moved_far,     // the projection moves a body by more than the error of the joints explains
  jams,          // friction grows with the load that it causes, and no step finds a balance
  out_of_range,  // a number in time left its range, or is not finite
  too_large,     // radau5 takes islands of at most 600 velocity components: 200 bodies in the plane, 100 in space
};

// The reaction of step() to a failed step, after the rollback.
enum class OnFailure : char {
  stop,  // nothing
  retry  // repeats it in 2, 4, 8, 16 parts; then, if the solver is iterative, by the direct one
};

struct StepResult {
  StepProblem problem = StepProblem::none;
  double time = 0, length = 0;  // [s] begin and length of the step
  int island = -1;              // whose step failed
  int body = -1;                // the fastest in that step
  int joint = -1, row = -1;     // the likely culprit; -1: none; out_of_range: row -1, the joint whose number it is
  double misfit = 0;            // [m, rad] moved_far: error of the joints,
  double moved = 0;             // [m] and the way of `body` that its projection takes; a rotation by its arc
  // How the step succeeded: number of parts; whether the direct solver replaced the iterative one.
  int parts = 1;
  bool direct = false;

  explicit operator bool() const { return problem == StepProblem::none; }
};

// The result of project(). True if all joints are satisfied.
struct ProjectResult {
  bool met = false;
  // The joints are nearly redundant and contradict each other: closing them would move `body` by `moved`, far more than
  // `misfit` explains. That is refused. The poses then satisfy the joints in the sense of least squares.
  bool refused = false;
  int joint = -1, row = -1;  // with the largest error before the projection
  double misfit = 0;         // [m, rad], per second for velocities: that error
  int body = -1;             // that would move most
  double moved = 0;          // [m], [m/s]; a rotation by its arc

  explicit operator bool() const { return met; }
};

// Describes a step that failed or needed a retry: the place and the cause, with the names of its body and its joint.
std::string in_words(const StepResult& result, const std::string& body, const std::string& joint);
std::string likely_fix(StepProblem problem, OnFailure tried);
const char* name_of(StepProblem problem);  // for programs: "not_finite"

}  // namespace cdot
