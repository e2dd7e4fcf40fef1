// The result of a run -> a summary for people and for programs.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cdot/methods.hpp>

#include "runtime/text/json.hpp"
#include "runtime/tool/run/balance_report.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {

std::string in_words(const TriedFix& advice) {
  if (advice.tried.empty()) return "Nothing could be tried within the bounds of work";
  if (advice.options.empty()) return fmt::format("Tried in vain: `{}`", fmt::join(advice.tried, "`, `"));
  std::string text = fmt::format("Tried: `{}` keeps energy and momentum to {:.1e}", advice.options, advice.share);
  if (advice.off > 0) text += fmt::format(", and the trajectory to about {:.1e},", advice.off);
  if (advice.cost > 0)
    text += fmt::format(" at {} times the cost",
                        advice.cost < 10 ? fmt::format("{:.2g}", advice.cost) : fmt::format("{:.0f}", advice.cost));
  if (advice.until > 0) text += fmt::format(", up to t = {:.6g} s", advice.until);
  return text;
}

namespace {

text::Json advice_json(const TriedFix& advice) {
  return {{"options", advice.options}, {"share", advice.share}, {"off", advice.off},
          {"cost", advice.cost},       {"steps", advice.steps}, {"evaluations", advice.evaluations},
          {"until", advice.until},     {"tried", advice.tried}};
}

// Springs follow the joints in the World.
std::string joint_in_words(const Scene& scene, int joint) {
  return joint < std::ssize(scene.joints) ? fmt::format("joint \"{}\"", name_in(scene.joints, joint)) : "a spring";
}

// [m] or [rad]; methods pass an end by the error of their events.
constexpr double shown_end = 1e-6;

std::string fix_of_accuracy(const Choice& choice) {
  if (choice.rescued > 0) return "Likely fix: a method and a step of your own";
  if (choice.of_events > choice.asked) return fmt::format("Likely fix: --accuracy {:.1g}", 2 * choice.of_events);
  if (!(choice.holds_until > 0)) return "Likely fix: a larger error";
  return fmt::format("Likely fix: --until {:.6g}", choice.holds_until);
}

// The advice that was tried; without one, what usually helps. Steps are not what a search lacked.
std::string fix_of(const RunResult& result, const std::string& usual) {
  if (result.advice) return in_words(*result.advice);
  if (!result.choice) return "Likely fix: " + usual;
  if (result.choice->rescued == 0 && result.choice->holds_until > 0) return fix_of_accuracy(*result.choice);
  if (result.choice->ended_by_budget) return "Likely fix: an earlier end (--until)" + budget_text(*result.choice);
  return "Likely fix: an earlier end (--until), or joints that can follow: `cdot-run diagnose` names those that "
         "contradict each other";
}

std::string failed_step_text(const Scene& scene, const RunResult& result, const StepResult& step) {
  return fmt::format(
      "{}. {}",
      in_words(step, fmt::format("body \"{}\"", name_in(scene.bodies, step.body)), joint_in_words(scene, step.joint)),
      fix_of(result, likely_fix(step.problem, scene.on_failure)));
}

text::Json failed_step_json(const Scene& scene, const StepResult& step) {
  return {{"problem", name_of(step.problem)},
          {"time", step.time},
          {"length", step.length},
          {"island", step.island},
          {"body", name_in(scene.bodies, step.body)},
          {"joint", name_in(scene.joints, step.joint)},
          {"row", step.row + 1}};
}

// Of a pose where the law of an effect has none, as a gas spring of negative length.
std::string energy_without_value(const RunResult& result) {
  const std::string effect =
      result.without_energy.empty() ? "an effect" : fmt::format("an effect `{}`", result.without_energy);
  return fmt::format("{} has no energy at the pose of t = {:.6g} s. {}", effect, result.time,
                     fix_of(result, "a limit or a stop before that pose, or a shorter step"));
}

}  // namespace

std::string failure(const Scene& scene, const RunResult& result) {
  if (result.failed_step) return failed_step_text(scene, result, *result.failed_step);
  if (std::isnan(result.energy_end)) return energy_without_value(result);
  if (const std::string motors = contradiction(scene, result); !motors.empty()) return motors;
  if (!result.finite)
    return fmt::format("unstable: the state is not finite at t = {:.6g} s. {}", result.time,
                       fix_of(result, "a shorter step"));
  if (result.worst_error > scene.tolerance) {
    return fmt::format("|C| of joint \"{}\" is {:.3g} at t = {:.6g} s, above the tolerance of {:.3g}. {}",
                       result.worst_joint, result.worst_error, result.worst_error_time, scene.tolerance,
                       fix_of(result, "a shorter step"));
  }
  if (result.worst_end.by > scene.tolerance) {
    return fmt::format("{} is passed by {:.3g} at t = {:.6g} s, above the tolerance of {:.3g}. {}",
                       end_name(scene, result.worst_end), result.worst_end.by, result.worst_end_time, scene.tolerance,
                       fix_of(result, "a start between the ends, or a shorter step"));
  }
  if (const std::string lost = balance_failure(scene, result); !lost.empty())
    return fmt::format("{}. {}", lost, fix_of(result, "a shorter step"));
  if (const std::string off = trajectory_failure(scene, result); !off.empty())
    return fmt::format("{}. {}", off, fix_of(result, "a shorter step"));
  const std::string lack = result.choice ? accuracy_failure(*result.choice) : std::string();
  return lack.empty() ? lack : fmt::format("{}. {}", lack, fix_of_accuracy(*result.choice));
}

namespace {

std::string own_steps_text(const RunResult& result) {
  const StepCounts& counts = result.counts;
  if (counts.taken == 0)
    return fmt::format("  own steps       none: {}\n", result.failed_step   ? "the first one failed"
                                                       : counts.rescued > 0 ? "an implicit method took them all"
                                                                            : "no body can move");
  std::string text =
      fmt::format("  own steps       {}, from {:.3g} s to {:.3g} s", counts.taken, counts.shortest, counts.longest);
  if (counts.rejected > 0) text += fmt::format(", {} rejected", counts.rejected);
  if (counts.events > 0) text += fmt::format(", {} event{} located", counts.events, counts.events == 1 ? "" : "s");
  return text + "\n";
}

}  // namespace

namespace {

// "3 steps were left to an implicit method, first by t = 0.24 s, where the largest force was the 12 N of joint "rope"".
std::string rescue_text(const Scene& scene, const RunResult& result) {
  std::string text = fmt::format("{} step{} left to an implicit method, first by t = {:.6g} s", result.counts.rescued,
                                 result.counts.rescued == 1 ? " was" : "s were", result.first_rescue);
  const auto [joint, force] = result.at_rescue;
  if (joint >= 0)
    text += fmt::format(", where the largest force was the {:.3g} N of {}", force, joint_in_words(scene, joint));
  return text;
}

// Of a step that an adaptive method left to an implicit method, whose error nobody knows; or of an accuracy that holds
// in part.
std::string warning_of_accuracy(const Scene& scene, const RunResult& result) {
  if (result.choice) {
    const std::string lack = accuracy_warning(*result.choice);
    return lack.empty() ? lack : fmt::format("{}. {}", lack, fix_of_accuracy(*result.choice));
  }
  if (scene.settings.local_error == 0 || result.counts.rescued == 0) return {};
  return fmt::format(
      "the local error {:.1e} is broken: {}. Likely fix: a larger local error, or fixed steps of implicit or rattle",
      scene.settings.local_error, rescue_text(scene, result));
}

}  // namespace

// The scene with the method that ran.
Scene as_run(const Scene& scene, const RunResult& result) {
  return result.choice ? solved_by(*result.choice, scene) : scene;
}

std::vector<Concern> concerns_of(const Scene& as_run, const RunResult& result, bool warnings_only) {
  std::vector<Concern> concerns = concerns_about(as_run, result.diagnosis, warnings_only);
  if (result.choice && result.choice->reached)
    std::erase_if(concerns, [](const Concern& concern) { return concern.of_method; });
  return concerns;
}

std::string summary_text(const Scene& asked, const RunResult& result) {
  const Scene scene = as_run(asked, result);
  std::string text = fmt::format("{}\n", scene.title.empty() ? scene.file : scene.title);
  text += fmt::format("  bodies, joints  {}, {}\n", scene.bodies.size(), scene.joints.size());
  const bool own_steps = scene.settings.local_error > 0;
  text += fmt::format("  time            {:.6g} s", result.time);
  if (!own_steps) text += fmt::format(" in {} steps of {:.6g} s", result.steps, scene.step);
  if (result.start > 0) text += fmt::format(", from the state at {:.6g} s", result.start);
  text += "\n";
  if (!scene.why_integrator.empty())
    text += fmt::format("  integrator      {}: {}\n", name_of(integrators, scene.settings.integrator),
                        scene.why_integrator);
  if (scene.single) text += "  precision       float\n";
  if (own_steps) text += own_steps_text(result);
  if (result.counts.rescued > 0)
    text += fmt::format("  implicit rescue {}, for endless events or a useless error estimate\n",
                        rescue_text(scene, result));
  if (result.choice) text += choice_text(*result.choice);
  text += fmt::format("  CPU             {:.4g} s, {:.3g} us per step\n", result.cpu,
                      result.steps > 0 ? 1e6 * result.cpu / static_cast<double>(result.steps) : 0.0);
  if (!result.worst_joint.empty()) {
    text += fmt::format("  worst |C|       {:.3g} (joint \"{}\", t = {:.6g} s)\n", result.worst_error,
                        result.worst_joint, result.worst_error_time);
  }
  if (result.worst_end.by > shown_end)
    text += fmt::format("  passed end      {:.3g} ({}, t = {:.6g} s)\n", result.worst_end.by,
                        end_name(scene, result.worst_end), result.worst_end_time);
  text += fmt::format("  energy          {:.6g} J at the start, {:.6g} J at the end, largest change {:.3g} J\n",
                      result.energy_start, result.energy_end, result.energy_drift);
  for (std::size_t k = 0; k < result.sensors.size(); ++k) {
    const Sensor& sensor = scene.sensors[k];
    const SensorRange& range = result.sensors[k];
    text += fmt::format("  sensor          {}: {:.6g} to {:.6g} {}, {:.6g} at the end\n", sensor.name, range.least,
                        range.most, sensor.unit, range.end);
  }
  text += balance_text(result);
  if (result.error.samples > 0) text += error_text(scene, result.error);
  if (result.redundant_rows > 0) text += fmt::format("  redundant rows  {}\n", result.redundant_rows);
  const std::string losses = rank_losses_text(scene, result.rank_losses);
  if (!losses.empty()) text += fmt::format("  rank            {}\n", losses);
  if (result.counts.steered > 0)
    text +=
        fmt::format("                  {} steps near a loss of rank took projected stages\n", result.counts.steered);
  if (result.counts.crossed > 0)
    text += fmt::format(
        "                  {} of them cross other branches of the motion but for rounded numbers, and go straight on\n",
        result.counts.crossed);
  if (result.counts.retried > 0)
    text += fmt::format(
        "  retried         {} failed step{} succeeded in shorter parts, {} of them with the direct solver\n",
        result.counts.retried, result.counts.retried == 1 ? "" : "s", result.counts.direct);
  for (const std::string& joint : result.broken_joints) text += fmt::format("  broken          \"{}\"\n", joint);
  for (const std::string& note : result.notes) text += fmt::format("  note            {}\n", note);
  for (const Concern& concern : concerns_of(scene, result, true))
    text += fmt::format("  warning         {}. Likely fix: {}\n", concern.what, concern.fix);
  if (const std::string lost = balance_warning(scene, result); !lost.empty())
    text += fmt::format("  warning         {}. {}\n", lost, fix_of(result, "a shorter step"));
  if (const std::string off = trajectory_warning(scene, result); !off.empty())
    text += fmt::format("  warning         {}. {}\n", off, fix_of(result, "a shorter step"));
  if (const std::string open = decision_warning(scene, result); !open.empty())
    text += fmt::format("  warning         {}. {}\n", open,
                        fix_of(result, own_steps ? "a smaller local error" : "a shorter step"));
  if (const std::string lack = warning_of_accuracy(scene, result); !lack.empty())
    text += fmt::format("  warning         {}\n", lack);
  const std::string why = failure(asked, result);
  if (!why.empty()) text += fmt::format("  FAILED          {}\n", why);
  return text;
}

text::Json rank_losses_json(const Scene& scene, const std::vector<RankLoss>& losses) {
  text::Json json = text::Json::array();
  for (const RankLoss& one : losses)
    json.push_back({{"time", one.time},
                    {"pivot", one.row.share},
                    {"joint", name_in(scene.joints, one.row.joint)},
                    {"row", one.row.row + 1}});
  return json;
}

std::string summary_json(const Scene& asked, const RunResult& result) {
  const Scene scene = as_run(asked, result);
  const std::string why = failure(asked, result);
  text::Json json = {
      {"scene", scene.file},
      {"title", scene.title},
      {"ok", why.empty()},
      {"failure", why},
      {"bodies", scene.bodies.size()},
      {"joints", scene.joints.size()},
      {"start", result.start},
      {"time", result.time},
      {"precision", name_of(precisions, scene.single)},
      {"step", scene.step},
      {"steps", result.steps},
      {"integrator", name_of(integrators, scene.settings.integrator)},
      {"why_integrator", scene.why_integrator},
      {"cpu", result.cpu},
      {"worst_error", result.worst_error},
      {"worst_error_joint", result.worst_joint},
      {"worst_error_time", result.worst_error_time},
      {"passed_end", result.worst_end.by},
      {"passed_end_of", result.worst_end.joint < 0 ? "" : end_name(scene, result.worst_end)},
      {"energy_start", result.energy_start},
      {"energy_end", result.energy_end},
      {"energy_drift", result.energy_drift},
      {"balance", balance_json(result)},
      {"warning", balance_warning(scene, result)},
      {"trajectory_warning", trajectory_warning(scene, result)},
      {"accuracy_warning", warning_of_accuracy(scene, result)},
      {"decision_warning", decision_warning(scene, result)},
      {"redundant_rows", result.redundant_rows},
      {"rank_losses", rank_losses_json(scene, result.rank_losses)},
      {"retried", {{"steps", result.counts.retried}, {"direct", result.counts.direct}}},
      {"broken_joints", result.broken_joints},
      {"notes", result.notes},
      {"concerns", concerns_json(concerns_of(scene, result, true))},
  };
  if (result.counts.evaluations > 0)
    json["own_steps"] = {{"evaluations", result.counts.evaluations}, {"taken", result.counts.taken},
                         {"rejected", result.counts.rejected},       {"events", result.counts.events},
                         {"rescued", result.counts.rescued},         {"steered", result.counts.steered},
                         {"crossed", result.counts.crossed},         {"undecided", result.counts.undecided}};
  if (result.counts.contradicted > 0) json["contradiction"] = contradiction(scene, result);
  for (std::size_t k = 0; k < result.sensors.size(); ++k)
    json["sensors"].push_back({{"name", scene.sensors[k].name},
                               {"unit", scene.sensors[k].unit},
                               {"least", result.sensors[k].least},
                               {"most", result.sensors[k].most},
                               {"end", result.sensors[k].end}});
  if (result.error.samples > 0) json["trajectory_error"] = error_json(scene, result.error);
  if (result.advice) json["advice"] = advice_json(*result.advice);
  if (result.failed_step) json["failed_step"] = failed_step_json(scene, *result.failed_step);
  if (result.choice) json["accuracy"] = choice_json(*result.choice);
  return json.dump(2) + "\n";
}

}  // namespace cdot
