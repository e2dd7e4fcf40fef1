// A TrajectoryError -> words.
#include "runtime/tool/run/error_report.hpp"

#include <fmt/format.h>

#include "runtime/events/impacts.hpp"

namespace cdot {
namespace {

// Over all scenes and hard cases at their own steps, the estimate was above this share wherever the error was, save for
// impacts and bodies of 1e-6 of their neighbours' mass. It may be far above the error: without a tolerance of the scene
// it fails no run.
constexpr double usual_share = 0.1;
constexpr double warned_share = 0.1;  // of the tolerance: a warning

// The estimate in words if it exceeds a share.
std::string above(double share, const Scene& scene, const RunResult& result) {
  const TrajectoryError& error = result.error;
  if (result.choice || !(error.share > share)) return {};
  return fmt::format(
      "the trajectory of {} is off by about {:.2g} of its mechanism's size or of 1 rad by t = {:.6g} s, above {:.2g}",
      body_name(scene, error.body), error.share, error.time, share);
}

std::string of_blow(const Scene& scene, const BlowOnJoint& blow) {
  const std::string joint = joint_name(scene, blow.joint);
  if (blow.held)
    return fmt::format(
        "joint {} holds a blow by t = {:.6g} s, because steps of {:.3g} ms spread it. Where a blow is located it lasts "
        "{:g} ms, and this one is {:.3g} % of the strength: whether the joint holds is not sure",
        joint, blow.time, 1e3 * scene.step, 1e3 * impact_time, 100 * blow.share);
  return fmt::format(
      "a blow breaks joint {} by t = {:.6g} s, which carried {:.2g} % of its strength a step before. Equal steps take "
      "a "
      "blow in two parts, and lose the second one where the first breaks a joint: the motion after it is not sure",
      joint, blow.time, 100 * blow.share);
}

std::string of_slip(const Scene& scene, const TurnedSlip& slip) {
  return fmt::format(
      "a blow by t = {:.6g} s turns round the slip of joint {}, whose friction it loads. Equal steps of {} take a blow "
      "in "
      "two parts, and friction acts in the first one against the slip before: the motion after it is not sure",
      slip.time, joint_name(scene, slip.joint), row_of(scene.settings.integrator).name);
}

std::string of_yield(const Scene& scene, const YieldingMotor& motor) {
  return fmt::format(
      "a motor of unlimited force on joint {} goes backwards at {:.2g} rad/s or m/s by t = {:.6g} s. Equal steps of {} "
      "let "
      "it yield at an end that it presses, and a blow may push it back: the motion after it is not sure",
      joint_name(scene, motor.joint), motor.speed, motor.time, row_of(scene.settings.integrator).name);
}

std::string of_break(const Scene& scene, const BreakAtLoss& at) {
  return fmt::format(
      "joint {} breaks by t = {:.6g} s, where row {} of {} nearly loses rank. Loads grow there without bound, and "
      "where "
      "equal steps of {} fall decides how far: whether the joint holds is not sure",
      joint_name(scene, at.joint), at.time, at.row.row + 1, joint_name(scene, at.row.joint),
      row_of(scene.settings.integrator).name);
}

std::string of_turn(const Scene& scene, const SharpTurn& turn) {
  return fmt::format(
      "within one step {} changes its velocity by {:.2g} % by t = {:.6g} s, where row {} of {} nearly loses rank. Two "
      "branches of the motion cross in that pose, and where the steps fall may decide which one the run takes: the "
      "motion after it is not sure",
      body_name(scene, turn.body), 100 * turn.share, turn.time, turn.row.row + 1, joint_name(scene, turn.row.joint));
}

}  // namespace

double warned_trajectory_share(const Scene& scene) {
  return scene.trajectory_tolerance > 0 ? warned_share * scene.trajectory_tolerance : usual_share;
}

std::string trajectory_failure(const Scene& scene, const RunResult& result) {
  return scene.trajectory_tolerance > 0 ? above(scene.trajectory_tolerance, scene, result) : std::string();
}

std::string trajectory_warning(const Scene& scene, const RunResult& result) {
  if (!trajectory_failure(scene, result).empty()) return {};
  return above(warned_trajectory_share(scene), scene, result);
}

std::string decision_warning(const Scene& scene, const RunResult& result) {
  if (const long long count = result.counts.undecided; count > 0)
    return fmt::format(
        "{} blow{} undecided, first by t = {:.6g} s at joint \"{}\": an error as small as that of the steps decides "
        "whether it stops the bodies there, so the error of the motion after it is not sure",
        count, count == 1 ? " is" : "s are", result.first_undecided,
        name_in(scene.joints, static_cast<int>(result.counts.undecided_joint)));
  if (result.blow.joint >= 0) return of_blow(scene, result.blow);
  if (result.turned_slip.joint >= 0) return of_slip(scene, result.turned_slip);
  if (result.yielding_motor.joint >= 0) return of_yield(scene, result.yielding_motor);
  if (result.break_at_loss.joint >= 0) return of_break(scene, result.break_at_loss);
  if (result.sharp_turn.body >= 0) return of_turn(scene, result.sharp_turn);
  if (const NearBreak& near = result.near_break; near.joint >= 0)
    return fmt::format(
        "joint {} is within {:.2g} % of breaking at t = {:.6g} s, and the error of its load is about {:.2g} %: whether "
        "it holds is not sure",
        joint_name(scene, near.joint), 100 * near.distance, near.time, 100 * near.error);
  return {};
}

std::string contradiction(const Scene& scene, const RunResult& result) {
  const StepCounts& counts = result.counts;
  if (counts.contradicted == 0) return {};
  const std::string joint = joint_name(scene, static_cast<int>(counts.contradicted_joint)),
                    rival = joint_name(scene, static_cast<int>(counts.contradicting_joint));
  const double time = result.first_contradicted;
  if (counts.contradicting_joint < 0)
    return fmt::format(
        "a motor of joint {} has unlimited force, but other joints hold it by t = {:.6g} s: no motion has its rate. "
        "Likely fix: leave out the motor or a joint that holds it",
        joint, time);
  return fmt::format(
      "{} contradict each other by t = {:.6g} s: both have unlimited force, and no motion has the rates of both. "
      "Likely fix: a largest force or torque for one of them, such as `max` of a motor or `most` of a freewheel",
      joint == rival ? fmt::format("two motors of joint {}", joint)
                     : fmt::format("motors of the joints {} and {}", joint, rival),
      time);
}

std::string error_text(const Scene& scene, const TrajectoryError& error) {
  return fmt::format(
      "  trajectory      off by about {:.1g} m and {:.1g} rad ({}, t = {:.6g} s), estimated at {} places\n",
      error.position, error.angle, body_name(scene, error.body), error.time, error.samples);
}

text::Json error_json(const Scene& scene, const TrajectoryError& error) {
  return {
      {"position", error.position},           {"angle", error.angle},    {"share", error.share}, {"time", error.time},
      {"body", body_name(scene, error.body)}, {"samples", error.samples}};
}

}  // namespace cdot
