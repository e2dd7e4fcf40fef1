// What cdot-run says at the end of a run, for people and for programs.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "runtime/run_simulate.hpp"

namespace cdot {

std::string failure(const Scene& scene, const RunResult& result) {
  if (!result.finite) return fmt::format("unstable: not finite at t = {:.6g} s", result.time);
  if (result.worst_error > scene.tolerance) {
    return fmt::format(
        "joint \"{}\" is off by {:.3g} at t = {:.6g} s, more than the tolerance of {:.3g}",
        result.worst_joint, result.worst_error, result.worst_error_time, scene.tolerance);
  }
  return {};
}

std::string summary_text(const Scene& scene, const RunResult& result) {
  std::string text = fmt::format("{}\n", scene.title.empty() ? scene.file : scene.title);
  text += fmt::format("  bodies, joints  {}, {}\n", scene.bodies.size(), scene.joints.size());
  text += fmt::format("  time            {:.6g} s in {} steps of {:.6g} s\n", result.time,
                      result.steps, scene.step);
  text +=
      fmt::format("  CPU             {:.4g} s, {:.3g} us per step\n", result.cpu,
                  result.steps > 0 ? 1e6 * result.cpu / static_cast<double>(result.steps) : 0.0);
  if (!result.worst_joint.empty()) {
    text += fmt::format("  worst |C|       {:.3g} (joint \"{}\", t = {:.6g} s)\n",
                        result.worst_error, result.worst_joint, result.worst_error_time);
  }
  text += fmt::format(
      "  energy          {:.6g} J at the start, {:.6g} J at the end, at most {:.3g} J apart\n",
      result.energy_start, result.energy_end, result.energy_drift);
  if (result.redundant_rows > 0)
    text += fmt::format("  redundant rows  {}\n", result.redundant_rows);
  for (const std::string& joint : result.broken_joints)
    text += fmt::format("  broken          \"{}\"\n", joint);
  for (const std::string& note : result.notes) text += fmt::format("  note            {}\n", note);
  const std::string why = failure(scene, result);
  if (!why.empty()) text += fmt::format("  FAILED          {}\n", why);
  return text;
}

std::string summary_json(const Scene& scene, const RunResult& result) {
  const std::string why = failure(scene, result);
  const nlohmann::ordered_json json = {
      {"scene", scene.file},
      {"title", scene.title},
      {"ok", why.empty()},
      {"failure", why},
      {"bodies", scene.bodies.size()},
      {"joints", scene.joints.size()},
      {"time", result.time},
      {"step", scene.step},
      {"steps", result.steps},
      {"cpu", result.cpu},
      {"worst_error", result.worst_error},
      {"worst_error_joint", result.worst_joint},
      {"worst_error_time", result.worst_error_time},
      {"energy_start", result.energy_start},
      {"energy_end", result.energy_end},
      {"energy_drift", result.energy_drift},
      {"redundant_rows", result.redundant_rows},
      {"broken_joints", result.broken_joints},
      {"notes", result.notes},
  };
  return json.dump(2) + "\n";
}

}  // namespace cdot
