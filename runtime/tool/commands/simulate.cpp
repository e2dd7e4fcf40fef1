// `cdot-run simulate`: runs a scene and writes the requested files.
#include "runtime/tool/search/simulate.hpp"

#include <fmt/format.h>

#include "runtime/text/colour.hpp"
#include "runtime/tool/commands/options.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/search/advice.hpp"
#include "runtime/tool/viewer/plots.hpp"
#include "runtime/tool/viewer/viewer.hpp"
#include "runtime/tool/watch/record.hpp"

namespace cdot {
namespace {

constexpr int poses_diagnosed = 8;

struct Options {
  SceneOptions scene;
  double accuracy = 0, tolerance = 0, energy_tolerance = 0, trajectory_tolerance = 0, every = 0;
  bool project = false, json = false;
  std::string csv, html, svg, plot, save_state, from_state;
  std::vector<std::string> recorded;
  std::vector<double> times;
  std::optional<double> state_time;
};

void add_options(Line& line, Options& options) {
  add_scene(line, options.scene);
  add_until(line, options.scene);
  add_method(line, options.scene);
  line.add("--accuracy", &options.accuracy, "choose a method that reaches this trajectory error [m, rad]")
      .positive()
      .repeatable()
      .excludes("--step")
      .excludes("--integrator")
      .excludes("--drift")
      .excludes("--iterations")
      .excludes("--substeps")
      .excludes("--local-error")
      .excludes("--solver")
      .excludes("--kernels")
      .excludes("--precision");
  line.add("--tolerance", &options.tolerance, "joint error above which the run has failed [m, rad]").positive();
  line.add("--energy-tolerance", &options.energy_tolerance,
           "share of the motion's energies and momenta that the method may lose; of energies that it makes up a tenth")
      .positive();
  line.add("--trajectory-tolerance", &options.trajectory_tolerance,
           "share of sizes, and rad, of the trajectory's estimated error above which the run has failed")
      .positive();
  line.add("--project", &options.project, "project an inconsistent start onto C = 0");
  line.add("-o,--output", &options.csv,
           "write a CSV file (- is standard output, here and below): time, then x, y, angle, vx, vy, omega of each "
           "body by name; in space x, y, "
           "z, e0..e3, vx, vy, vz, wx, wy, wz");
  line.add("--every", &options.every, "interval of CSV rows [s]; without it, one per step").positive();
  line.add("--times", &options.times, "CSV rows at these times: 0,0.5,2")
      .separated_by_commas()
      .not_negative()
      .excludes("--every");
  line.add("--html", &options.html, "write a self-contained page that plays the mechanism");
  line.add("--svg", &options.svg, "write a picture of the mechanism at several times, with its traces");
  line.add("--plot", &options.plot,
           "write the sensors as plots over time, an SVG file; of a scene without sensors, its coordinates");
  std::vector<std::string> groups{"all"};
  std::string meanings = "add sensors to CSV, JSON, page and plots, separated by commas";
  for (const Recordable& group : recordables()) {
    groups.emplace_back(group.name);
    meanings += fmt::format("\n{}: {}", group.name, group.meaning);
  }
  line.add("--record", &options.recorded, meanings).separated_by_commas().one_of(groups);
  line.add("--save-state", &options.save_state, "write the final state to a file for --from-state");
  line.add("--at", &options.state_time, "save the state at this time [s] instead").not_negative().needs("--save-state");
  line.add("--from-state", &options.from_state,
           "continue from a saved state of this scene, with the same bits as an uninterrupted run");
  line.add("--json", &options.json, "print the summary as JSON");
  add_progress(line, options.scene);
}

RunOptions run_options(const Options& options, const Scene& scene, OutputFile* csv) {
  RunOptions run;
  if (csv) {
    csv->write(csv_head(scene));
    run.row = [csv, &scene](const Frame& frame) { csv->write(csv_row(scene, frame)); };
  }
  run.row_times = options.times;
  std::sort(run.row_times.begin(), run.row_times.end());
  if (options.every > 0) run.row_times = every(options.every, scene.duration);
  if (!options.html.empty() || !options.svg.empty() || !options.plot.empty()) run.film_times = film_times(scene);
  run.diagnose_times = equal_times(scene.duration, poses_diagnosed, 0);
  run.progress = progress_shown(options.scene);
  if (!options.from_state.empty()) run.from = read_state(options.from_state);
  if (options.save_state.empty()) return run;
  run.save_at = options.state_time.value_or(scene.duration);
  check_within(*run.save_at, scene.duration);
  return run;
}

// After Ctrl-C: how far the outputs go, and how to continue.
std::string interruption(const Options& options, const RunResult& result) {
  if (result.choice)
    return "interrupted while a method was chosen: nothing was written. Likely fix: name a method, as --integrator "
           "rk4; its run keeps what it computed\n";
  const bool saved = !options.save_state.empty();
  return fmt::format("interrupted: the run and its outputs end at t = {:.6g} s{}\n", result.time,
                     saved ? fmt::format("; --from-state {} continues", options.save_state) : "");
}

int run(const Options& options) {
  Scene scene = scene_of(options.scene);
  if (options.tolerance > 0) scene.tolerance = options.tolerance;
  if (options.energy_tolerance > 0) scene.energy_tolerance = options.energy_tolerance;
  if (options.trajectory_tolerance > 0) scene.trajectory_tolerance = options.trajectory_tolerance;
  if (options.project) scene.project = true;
  if (options.accuracy > 0) scene.accuracy = options.accuracy;
  record(scene, options.recorded);
  if (!options.plot.empty() && scene.sensors.empty()) record(scene, {"coordinates"});
  std::FILE* summary = summary_beside({options.csv, options.html, options.svg, options.plot, options.save_state});
  std::optional<OutputFile> csv;
  if (!options.csv.empty()) csv.emplace(options.csv);

  std::string warnings;
  const RunOptions asked = run_options(options, scene, csv ? &*csv : nullptr);
  RunResult result = simulate(scene, asked, warnings);
  text::print_messages(stderr, warnings);
  if (result.interrupted) fmt::print(stderr, "{}", interruption(options, result));
  if (result.interrupted && result.choice) return stopped;
  if (!result.interrupted && needs_advice(scene, result)) result.advice = find_advice(scene, asked, result);

  if (csv) csv->commit();
  if (!result.state.empty()) write_file(options.save_state, result.state.text());
  if (!options.html.empty())
    write_file(options.html, html_page(as_run(scene, result), result.film,
                                       result.choice ? choice_text(*result.choice, false) : std::string()));
  if (!options.svg.empty()) write_file(options.svg, svg_still(scene, result.film));
  if (!options.plot.empty()) write_file(options.plot, plots_svg(scene, result.film));
  text::print_messages(summary, options.json ? summary_json(scene, result) : summary_text(scene, result));
  if (result.interrupted) return stopped;
  return failure(scene, result).empty() ? well : answer_is_no;
}

}  // namespace

Run simulate_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

}  // namespace cdot
