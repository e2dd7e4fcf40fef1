// `cdot-run diagnose`: the equations of a run; with --matrix, D of its start.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "runtime/text/colour.hpp"
#include "runtime/text/json.hpp"
#include "runtime/tool/commands/matrix.hpp"
#include "runtime/tool/commands/options.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/search/simulate.hpp"

namespace cdot {
namespace {

using text::Json;

constexpr std::size_t most_islands = 12, most_rows_listed = 12;
constexpr int most_poses = 64;

std::string method_text(const Scene& scene) {
  const Settings& s = scene.settings;
  std::string text = fmt::format("{} {}, {}", name_of(solvers, s.solver), name_of(integrators, s.integrator),
                                 name_of(precisions, scene.single));
  if (s.local_error > 0) return text + fmt::format(", steps of its own to a local error of {:.1e}", s.local_error);
  return text + fmt::format(", substeps of {:.4g} s", scene.step / s.substeps);
}

std::string rows_text(const Scene& scene, const WorstOfIsland& worst) {
  const Diagnosis::Island& island = worst.island;
  std::string text = fmt::format("  rank            {} of {} rows", island.rank, island.rows);
  if (worst.rank_time > 0) text += fmt::format(", least at t = {:.4g} s", worst.rank_time);
  text += "\n";
  for (std::size_t k = 0; k < island.redundant.size() && k < most_rows_listed; ++k) {
    const Diagnosis::Redundant& row = island.redundant[k];
    std::string others;
    for (int joint : row.joints)
      if (joint != row.row.joint) others += (others.empty() ? "" : ", ") + joint_name(scene, joint);
    text += fmt::format("  {:15} row {} of {}: {} {}\n", row.conflicting ? "conflicting" : "redundant", row.row.row + 1,
                        joint_name(scene, row.row.joint), row.conflicting ? "contradicts" : "follows from",
                        others.empty() ? "the other rows of that joint" : others);
  }
  if (island.redundant.size() > most_rows_listed)
    text += fmt::format("                  and {} more\n", island.redundant.size() - most_rows_listed);
  return text;
}

std::string at_time(double time) { return time > 0 ? fmt::format(" at t = {:.4g} s", time) : ""; }

std::string island_text(const Scene& scene, const WorstOfIsland& worst, int number) {
  const Diagnosis::Island& island = worst.island;
  std::string text =
      fmt::format("island {}: {} {}", number, island.bodies.size(), island.bodies.size() == 1 ? "body" : "bodies");
  if (!island.bodies.empty()) text += fmt::format(", from {}", body_name(scene, island.bodies.front()));
  text += "\n";
  if (island.rows > 0) {
    text += rows_text(scene, worst);
    text += fmt::format("  condition of K  {:.3g}{}; the smallest pivot is {:.2g} of its row's, in row {} of {}\n",
                        island.condition, at_time(worst.condition_time), island.smallest_pivot, island.weakest.row + 1,
                        joint_name(scene, island.weakest.joint));
  }
  if (island.heaviest > 0)
    text += fmt::format("  masses          {:.4g} to {:.4g} kg\n", island.lightest, island.heaviest);
  if (island.stiffest.square > 0) {
    const bool tension = island.stiffest.tension > 0.5 * island.stiffest.square;
    text += fmt::format("  stiffest        {:.4g} rad/s of {}{}, by {}\n", std::sqrt(island.stiffest.square),
                        body_name(scene, island.stiffest.body), at_time(worst.stiffest_time),
                        tension ? "the tension of the joints" : "its springs");
  }
  if (island.fastest_decay.rate > 0)
    text += fmt::format("  fastest decay   {:.4g} 1/s of {}{}, by dampers\n", island.fastest_decay.rate,
                        body_name(scene, island.fastest_decay.body), at_time(worst.decay_time));
  if (island.fastest_spin > 0)
    text += fmt::format("  fastest turn    {:.4g} rad/s of {}{}\n", island.fastest_spin,
                        body_name(scene, island.spinning), at_time(worst.spin_time));
  return text;
}

Json row_json(const Scene& scene, const Diagnosis::Row& row) {
  if (row.joint < 0) return nullptr;
  return {{"joint", scene.joints[static_cast<std::size_t>(row.joint)].name}, {"row", row.row + 1}};
}

Json redundant_json(const Scene& scene, const Diagnosis::Redundant& redundant) {
  Json json = row_json(scene, redundant.row);
  json["joints"] = Json::array();
  for (int joint : redundant.joints) json["joints"].push_back(scene.joints[static_cast<std::size_t>(joint)].name);
  json["missed"] = redundant.missed;
  json["conflicting"] = redundant.conflicting;
  return json;
}

Json island_json(const Scene& scene, const WorstOfIsland& worst) {
  const Diagnosis::Island& island = worst.island;
  const auto named = [&](int body) -> Json {
    if (body < 0) return nullptr;
    return scene.bodies[static_cast<std::size_t>(body)].name;
  };
  Json redundant = Json::array();
  for (const auto& row : island.redundant) redundant.push_back(redundant_json(scene, row));
  return {{"bodies", island.bodies.size()},
          {"rows", island.rows},
          {"rank", island.rank},
          {"rank_time", worst.rank_time},
          {"redundant", redundant},
          {"condition", island.condition},
          {"condition_time", worst.condition_time},
          {"smallest_pivot", island.smallest_pivot},
          {"weakest", row_json(scene, island.weakest)},
          {"lightest", island.lightest},
          {"heaviest", island.heaviest},
          {"stiffest", std::sqrt(std::max(0.0, island.stiffest.square))},
          {"stiffest_time", worst.stiffest_time},
          {"stiffest_body", named(island.stiffest.body)},
          {"fastest_decay", island.fastest_decay.rate},
          {"decay_time", worst.decay_time},
          {"decaying", named(island.fastest_decay.body)},
          {"fastest_spin", island.fastest_spin},
          {"spin_time", worst.spin_time},
          {"spinning", named(island.spinning)}};
}

std::string losses_text(const Scene& scene, const std::vector<RankLoss>& losses) {
  if (losses.empty()) return {};
  std::string text = fmt::format("rank over the whole run: {}\n", rank_losses_text(scene, losses));
  for (std::size_t k = 0; k < losses.size() && k < most_rows_listed; ++k)
    text += fmt::format("  t = {:.4g} s      pivot {:.1e}, row {} of {}\n", losses[k].time, losses[k].row.share,
                        losses[k].row.row + 1, joint_name(scene, losses[k].row.joint));
  if (losses.size() > most_rows_listed)
    text += fmt::format("  and {} more, all in --json\n", losses.size() - most_rows_listed);
  return text;
}

std::string diagnosis_text(const Scene& asked, const RunResult& result) {
  const Scene scene = as_run(asked, result);
  std::string text =
      fmt::format("{}\nmethod: {}\n", scene.title.empty() ? scene.file : scene.title, method_text(scene));
  if (result.diagnoses == 1 && !result.diagnosis.empty())
    text += fmt::format("at t = {:.4g} s\n", result.diagnosis.front().rank_time);
  else
    text +=
        fmt::format("the worst of {} poses from t = {:.4g} to {:.4g} s\n", result.diagnoses, result.start, result.time);
  for (std::size_t k = 0; k < result.diagnosis.size() && k < most_islands; ++k)
    text += island_text(scene, result.diagnosis[k], static_cast<int>(k));
  if (result.diagnosis.size() > most_islands)
    text += fmt::format("and {} more islands, all in --json\n", result.diagnosis.size() - most_islands);
  text += losses_text(scene, result.rank_losses);
  const std::vector<Concern> concerns = concerns_of(scene, result, false);
  for (const Concern& one : concerns) {
    text += fmt::format("{}: {}\n", one.warning ? "warning" : "note", one.what);
    if (!one.fix.empty()) text += fmt::format("  likely fix: {}\n", one.fix);
  }
  const std::string why = failure(asked, result);
  if (!why.empty()) text += fmt::format("FAILED: {}\n", why);
  if (concerns.empty() && why.empty()) text += "no warnings: the method suits this scene\n";
  return text;
}

std::string diagnosis_json(const Scene& asked, const RunResult& result) {
  const Scene scene = as_run(asked, result);
  Json json = {{"scene", scene.file},       {"title", scene.title},  {"method", method_text(scene)},
               {"poses", result.diagnoses}, {"start", result.start}, {"time", result.time},
               {"islands", Json::array()}};
  for (const WorstOfIsland& one : result.diagnosis) json["islands"].push_back(island_json(scene, one));
  json["rank_losses"] = rank_losses_json(scene, result.rank_losses);
  json["concerns"] = concerns_json(concerns_of(scene, result, false));
  json["failure"] = failure(asked, result);
  return json.dump(2) + "\n";
}

struct Options {
  SceneOptions scene;
  std::optional<double> time;
  bool matrix = false, json = false;
  std::string svg;
};

void add_options(Line& line, Options& options) {
  add_scene(line, options.scene);
  add_until(line, options.scene);
  add_method(line, options.scene);
  line.add("--at", &options.time, "diagnose only at this time [s]; without it, throughout the run")
      .not_negative()
      .excludes("--until");
  line.add("--matrix", &options.matrix, "show D of the whole system, D v = 0, at the start, without a run")
      .excludes("--until")
      .excludes("--at");
  line.add("--svg", &options.svg, "write a picture: the sparsity of K, and which joints share a body")
      .needs("--matrix");
  line.add("--json", &options.json, "print JSON, with all islands; with --matrix all numbers of D and K");
  add_progress(line, options.scene);
}

int show_matrix(const Options& options, const Scene& scene) {
  const SystemMatrix system = system_matrix(scene);
  std::FILE* summary = summary_beside({options.svg});
  if (!options.svg.empty()) write_file(options.svg, matrix_svg(scene, system));
  fmt::print(summary, "{}", options.json ? matrix_json(scene, system) : matrix_text(scene, system));
  return well;
}

int run(const Options& options) {
  Scene scene = scene_of(options.scene);
  if (options.matrix) return show_matrix(options, scene);
  RunOptions run;
  run.progress = progress_shown(options.scene);
  run.diagnose_times = equal_times(scene.duration, most_poses, 0);
  if (options.time) {
    check_within(*options.time, scene.duration);
    run.diagnose_times = {*options.time};
    // A method by default is that of the whole run.
    if (!chooses_method(scene)) scene.duration = std::max(*options.time, 1e-12 * scene.duration);
  }
  std::string warnings;
  const RunResult result = simulate(scene, run, warnings);
  text::print_messages(stderr, warnings);
  if (result.interrupted) return stopped;
  fmt::print("{}", options.json ? diagnosis_json(scene, result) : diagnosis_text(scene, result));
  const bool nothing_wrong = concerns_of(as_run(scene, result), result, true).empty() && failure(scene, result).empty();
  return nothing_wrong ? well : answer_is_no;
}

}  // namespace

Run diagnose_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

Run moved_to_diagnose(Line& line) {
  line.retire();
  return []() -> int { throw Error("`jacobian` has moved: use diagnose --matrix"); };
}

}  // namespace cdot
