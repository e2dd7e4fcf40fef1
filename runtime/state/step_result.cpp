#include <fmt/format.h>

#include <cdot/step_result.hpp>

namespace cdot {
namespace {

const char* what_went_wrong(StepProblem problem) {
  switch (problem) {
    case StepProblem::not_finite: return "a pose or velocity became infinite or NaN";
    case StepProblem::joints_apart: return "Newton did not converge: the joints drifted apart in this step";
    case StepProblem::moved_far: return "the joints nearly contradict each other";
    case StepProblem::jams: return "it jams: friction grows with the load that it causes itself";
    case StepProblem::out_of_range: return "a number that follows time leaves its range";
    case StepProblem::too_large:
      return "it has more than 200 bodies (in space 100) that move together, too many for radau5";
    case StepProblem::bad_step:
    case StepProblem::none: break;
  }
  return "";
}

}  // namespace

std::string likely_fix(StepProblem problem, OnFailure tried) {
  const std::string or_retry = tried == OnFailure::retry ? "" : "; or on_failure = \"retry\"";
  switch (problem) {
    case StepProblem::not_finite:
      return "a shorter step; the direct solver; integrator implicit where loads are heavy or springs stiff" + or_retry;
    case StepProblem::joints_apart: return "a shorter step: at most a tenth of a radian in each" + or_retry;
    case StepProblem::moved_far:
      return "correct the anchors, lengths or angles of the joints of this loop, or remove one; a shorter step" +
             or_retry;
    case StepProblem::jams: return "integrator euler, whose impulses stop what jams; a smaller coefficient of friction";
    case StepProblem::out_of_range:
      return "a function or table that stays in the range of the number, or an earlier end";
    case StepProblem::too_large: return "integrator implicit, or dop853 with local_error";
    case StepProblem::bad_step: return "a finite step above 0 s";
    case StepProblem::none: break;
  }
  return "";
}

const char* name_of(StepProblem problem) {
  switch (problem) {
    case StepProblem::not_finite: return "not_finite";
    case StepProblem::joints_apart: return "joints_apart";
    case StepProblem::moved_far: return "moved_far";
    case StepProblem::jams: return "jams";
    case StepProblem::out_of_range: return "out_of_range";
    case StepProblem::too_large: return "too_large";
    case StepProblem::bad_step: return "bad_step";
    case StepProblem::none: break;
  }
  return "none";
}

std::string in_words(const StepResult& result, const std::string& body, const std::string& joint) {
  if (result.problem == StepProblem::bad_step) return fmt::format("a step of {} s is impossible", result.length);
  std::string text = fmt::format("the step of {:.6g} s at t = {:.6g} s ", result.length, result.time);
  if (result) {
    text += fmt::format("was taken in {} part{}", result.parts, result.parts == 1 ? "" : "s");
    return text + (result.direct ? " by the direct solver" : "");
  }
  text += fmt::format("failed in island {}: {}", result.island, what_went_wrong(result.problem));
  if (result.problem == StepProblem::moved_far)
    text += fmt::format(": to correct {:.3g} m or rad, the projection would move {} by {:.3g} m", result.misfit, body,
                        result.moved);
  if (result.problem == StepProblem::out_of_range) return text + fmt::format("; it belongs to {}", joint);
  if (result.joint >= 0) text += fmt::format("; look at {}, row {}", joint, result.row + 1);
  if (result.body >= 0 && result.problem != StepProblem::moved_far) text += fmt::format("; {} moved fastest", body);
  return text;
}

}  // namespace cdot
