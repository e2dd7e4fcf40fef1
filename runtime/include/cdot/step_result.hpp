// What step() says: that all went well, or what went wrong and where. Plain data: step() allocates nothing.
#pragma once

#include <string>

namespace cdot {

enum class StepProblem : char {
  none,
  bad_step,      // its length is no finite number > 0
  not_finite,    // a pose or a velocity came out infinite or not a number
  joints_apart,  // Newton did not bring the joints together again, or drove them further apart than the motion did
};

// What step() does about a step that fails, once the state is again the one before it.
enum class OnFailure : char {
  stop,  // nothing
  retry  // takes it again in 2, 4, 8, 16 parts, and where the solver is iterative with the direct one
};

struct StepResult {
  StepProblem problem = StepProblem::none;
  double time = 0, length = 0;  // [s] when the step began, and its length
  int island = -1;              // whose step failed
  int body = -1;                // that moved fastest in it
  int joint = -1, row = -1;     // to be looked at first; -1: there is none
  // How the step succeeded: in so many parts, by the direct solver in place of the iterative one.
  int parts = 1;
  bool direct = false;

  explicit operator bool() const { return problem == StepProblem::none; }
};

// Of a step that failed, or that did not succeed at once: where and why, given the names of its body and its joint.
std::string in_words(const StepResult& result, const std::string& body, const std::string& joint);
std::string likely_fix(StepProblem problem, OnFailure tried);
const char* name_of(StepProblem problem);  // for programs: "not_finite"

}  // namespace cdot
