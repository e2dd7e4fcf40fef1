// cdot-run: the command line. Reads a scene, runs it, writes what was asked for.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <cdot/methods.hpp>

#include "runtime/tool/accuracy/command.hpp"
#include "runtime/tool/commands/diagnose.hpp"
#include "runtime/tool/commands/jacobian.hpp"
#include "runtime/tool/commands/list.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/run/simulate.hpp"
#include "runtime/tool/run/state.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/tool/viewer/viewer.hpp"

namespace {

enum Status { well = 0, answer_is_no = 1, bad_input = 2, stopped = 130 };

struct Arguments {
  std::string scene, csv, html, svg, save_state, from_state;
  std::optional<double> state_time, diagnose_time;
  double until = 0, step = 0, every = 0, tolerance = 0, local_error = 0, wanted_accuracy = 0;
  std::vector<double> times;
  std::string solver, integrator, drift, kernels, precision;
  int iterations = 0, substeps = 0;
  bool project = false, json = false, progress = false;
  cdot::AccuracyOptions accuracy;
};

constexpr int poses_diagnosed = 64, poses_diagnosed_beside = 8;  // by `diagnose`, and beside `simulate`

constexpr const char* footer = R"(
Examples
  cdot-run simulate specs/scenes/four_bar.toml
  cdot-run simulate specs/scenes/four_bar.toml --html four_bar.html then open the page
  cdot-run simulate specs/scenes/four_bar.toml --step 0.0001 --every 0.1 -o four_bar.csv
  cdot-run simulate specs/scenes/four_bar.toml --until 5 --save-state at_5.state
  cdot-run simulate specs/scenes/four_bar.toml --from-state at_5.state        goes on as if nothing had been between
  cdot-run diagnose specs/scenes/four_bar.toml                      rank, condition, stiffness, and what they advise
  cdot-run jacobian specs/scenes/four_bar.toml --svg four_bar.svg   the system in blocks and numbers
  cdot-run accuracy specs/scenes/double_pendulum.toml               what accuracy costs in time
  cdot-run list                                                     the joints that a scene may name

Exit status
  0  all well
  1  the answer is no: the run was not finite, or a joint was off by more than the tolerance
  2  bad usage, or a scene with mistakes; each is shown with its line and the likely fix

The format of scenes is described in specs/scenes/README.md.)";

// What takes the place of the scene's own.
void add_method(CLI::App* command, Arguments& arguments) {
  command->add_option("--step", arguments.step, "the time step [s]")->check(CLI::PositiveNumber);
  command->add_option("--solver", arguments.solver, "direct or iterative")
      ->check(CLI::IsMember(cdot::names_of(cdot::solvers)));
  command
      ->add_option("--integrator", arguments.integrator,
                   "euler, implicit (heavy loads on light chains), rattle (long runs), rk4 or dop853 (accuracy)")
      ->check(CLI::IsMember(cdot::names_of(cdot::integrators)));
  command
      ->add_option("--local-error", arguments.local_error,
                   "let rk4 or dop853 choose its steps: the estimated error of one [m, rad, and per s]")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--kernels", arguments.kernels,
                   "how the iterative solver solves the rows of one joint together: fast, balanced or robust")
      ->check(CLI::IsMember(cdot::names_of(cdot::kernel_forms)));
  command->add_option("--precision", arguments.precision, "compute in double or float")
      ->check(CLI::IsMember(cdot::names_of(cdot::precisions)));
  command->add_option("--drift", arguments.drift, "what keeps joints together: projection, baumgarte or none")
      ->check(CLI::IsMember(cdot::names_of(cdot::drifts)));
  command->add_option("--iterations", arguments.iterations, "of the iterative solver, per substep")
      ->check(CLI::PositiveNumber);
  command->add_option("--substeps", arguments.substeps, "per step")->check(CLI::PositiveNumber);
}

void add_simulate(CLI::App& app, Arguments& arguments) {
  CLI::App* simulate = app.add_subcommand("simulate", "Run a scene and say how it went");
  simulate->add_option("SCENE", arguments.scene, "the scene, a TOML file")->required();
  simulate->add_option("--until", arguments.until, "end at this time [s], in place of the scene's duration")
      ->check(CLI::PositiveNumber);
  add_method(simulate, arguments);
  simulate
      ->add_option("--accuracy", arguments.wanted_accuracy,
                   "choose the method such that the trajectory is as exact as that [m, rad]")
      ->check(CLI::PositiveNumber)
      ->excludes("--integrator")
      ->excludes("--local-error")
      ->excludes("--solver")
      ->excludes("--kernels")
      ->excludes("--precision");
  simulate->add_option("--tolerance", arguments.tolerance, "joint error from which the run has failed [m, rad]")
      ->check(CLI::PositiveNumber);
  simulate->add_flag("--project", arguments.project, "move a start that does not fit onto its joints");
  simulate->add_option("-o,--output", arguments.csv,
                       "write a CSV file: time, then x, y, angle, vx, vy, omega of each body by "
                       "name; in space x, y, "
                       "z, e0..e3, vx, vy, vz, wx, wy, wz");
  auto* every = simulate->add_option("--every", arguments.every, "a CSV row each so many seconds; else one per step")
                    ->check(CLI::PositiveNumber);
  simulate->add_option("--times", arguments.times, "CSV rows at these times: 0,0.5,2")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->excludes(every);
  simulate->add_option("--html", arguments.html, "write a page that plays the mechanism, all in one file");
  simulate->add_option("--svg", arguments.svg, "write a picture of the mechanism at several times, with its traces");
  auto* save = simulate->add_option("--save-state", arguments.save_state,
                                    "write the state at the end to a file, for --from-state to go on from");
  simulate->add_option("--at", arguments.state_time, "save the state at this time [s] instead")
      ->check(CLI::NonNegativeNumber)
      ->needs(save);
  simulate->add_option("--from-state", arguments.from_state,
                       "go on from a saved state of this scene, with the bits of a run that was never interrupted");
  simulate->add_flag("--json", arguments.json, "the summary as JSON");
  simulate->add_flag("--progress", arguments.progress, "show progress even where stderr is no terminal");
  simulate->footer(footer);
}

CLI::App* add_jacobian(CLI::App& app, Arguments& arguments) {
  CLI::App* jacobian = app.add_subcommand("jacobian", "Show the whole system's D with D v = 0 at a scene's start");
  jacobian->add_option("SCENE", arguments.scene, "the scene, a TOML file")->required();
  jacobian->add_option("--svg", arguments.svg, "write a picture: the sparsity of K, and which joints share a body");
  jacobian->add_flag("--json", arguments.json, "as JSON, with all numbers of D and K");
  jacobian->footer(footer);
  return jacobian;
}

CLI::App* add_diagnose(CLI::App& app, Arguments& arguments) {
  CLI::App* diagnose = app.add_subcommand(
      "diagnose",
      "Run a scene and say what its equations are like: rank, redundant and conflicting rows, condition, "
      "stiffness; and where the scene's method is the wrong one");
  diagnose->add_option("SCENE", arguments.scene, "the scene, a TOML file")->required();
  auto* until =
      diagnose->add_option("--until", arguments.until, "end at this time [s], in place of the scene's duration")
          ->check(CLI::PositiveNumber);
  add_method(diagnose, arguments);
  diagnose->add_option("--at", arguments.diagnose_time, "look at this time [s] only; else at many from start to end")
      ->check(CLI::NonNegativeNumber)
      ->excludes(until);
  diagnose->add_flag("--json", arguments.json, "as JSON, with all islands");
  diagnose->add_flag("--progress", arguments.progress, "show progress even where stderr is no terminal");
  diagnose->footer(footer);
  return diagnose;
}

CLI::App* add_accuracy(CLI::App& app, Arguments& arguments) {
  CLI::App* accuracy =
      app.add_subcommand("accuracy", "Solve a scene in every way at every step, and show what accuracy costs in time");
  cdot::AccuracyOptions& options = arguments.accuracy;
  accuracy->add_option("SCENE", arguments.scene, "the scene, a TOML file")->required();
  accuracy->add_option("--until", arguments.until, "end at this time [s], in place of the scene's duration")
      ->check(CLI::PositiveNumber);
  accuracy->add_option("--budget", options.sweep.budget, "CPU time to spend [s]; more of it: finer steps")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  accuracy->add_option("--rounds", options.sweep.rounds, "how often each run is timed, in turns")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  accuracy->add_option("--levels", options.sweep.levels, "steps or local errors to try per way, at most")
      ->check(CLI::PositiveNumber);
  accuracy->add_option("--only", options.only, "only ways with this in their name: direct, rk4, float");
  accuracy->add_option("--reference", options.reference,
                       "a trajectory to measure against, as `simulate -o` writes it; else one is made by two methods");
  accuracy->add_option("-o,--output", options.output,
                       "write PREFIX.csv, PREFIX.json and PREFIX.svg; else the scene's name with .accuracy");
  accuracy->add_flag("--resume", options.resume, "go on where this command was interrupted");
  accuracy->add_flag("--json", options.json, "print JSON");
  accuracy->add_flag("--progress", arguments.progress, "show progress even where stderr is no terminal");
  accuracy->footer(footer);
  return accuracy;
}

void override_scene(const Arguments& arguments, cdot::Scene& scene) {
  if (arguments.until > 0) scene.duration = arguments.until;
  if (arguments.step > 0) scene.step = arguments.step;
  if (arguments.tolerance > 0) scene.tolerance = arguments.tolerance;
  if (arguments.iterations > 0) scene.settings.iterations = arguments.iterations;
  if (arguments.substeps > 0) scene.settings.substeps = arguments.substeps;
  if (arguments.project) scene.project = true;
  cdot::Settings& settings = scene.settings;
  if (!arguments.solver.empty()) settings.solver = cdot::method_called(cdot::solvers, arguments.solver);
  if (!arguments.integrator.empty()) settings.integrator = cdot::method_called(cdot::integrators, arguments.integrator);
  if (!arguments.drift.empty()) settings.drift = cdot::method_called(cdot::drifts, arguments.drift);
  if (!arguments.kernels.empty()) settings.kernels = cdot::method_called(cdot::kernel_forms, arguments.kernels);
  if (!arguments.precision.empty()) scene.single = cdot::method_called(cdot::precisions, arguments.precision);
  if (arguments.local_error > 0) settings.local_error = arguments.local_error;
  if (arguments.wanted_accuracy > 0) scene.accuracy = arguments.wanted_accuracy;
}

cdot::RunOptions options_of(const Arguments& arguments, const cdot::Scene& scene, cdot::OutputFile* csv) {
  cdot::RunOptions options;
  if (csv) {
    csv->write(cdot::csv_head(scene));
    options.row = [csv, &scene](const cdot::Frame& frame) { csv->write(cdot::csv_row(scene, frame)); };
  }
  options.row_times = arguments.times;
  std::sort(options.row_times.begin(), options.row_times.end());
  if (arguments.every > 0) options.row_times = cdot::every(arguments.every, scene.duration);
  if (!arguments.html.empty() || !arguments.svg.empty()) options.film_times = cdot::film_times(scene);
  options.diagnose_times = cdot::diagnose_times(scene.duration, poses_diagnosed_beside);
  options.progress = arguments.progress || ::isatty(STDERR_FILENO) != 0;
  if (!arguments.from_state.empty()) options.from = cdot::read_state(arguments.from_state);
  if (!arguments.save_state.empty()) options.keep_state = arguments.state_time.value_or(scene.duration);
  if (options.keep_state > scene.duration)
    throw cdot::Error(fmt::format("--at {}: the run ends at {} s", *options.keep_state, scene.duration));
  return options;
}

int simulate(const Arguments& arguments) {
  cdot::Scene scene = cdot::read_scene(arguments.scene);
  override_scene(arguments, scene);
  std::optional<cdot::OutputFile> csv;
  if (!arguments.csv.empty()) csv.emplace(arguments.csv);

  std::string warnings;
  const cdot::RunOptions options = options_of(arguments, scene, csv ? &*csv : nullptr);
  const cdot::RunResult result = cdot::simulate(scene, options, warnings);
  fmt::print(stderr, "{}", warnings);
  if (result.interrupted) return stopped;

  if (csv) csv->commit();
  if (!result.state.empty()) cdot::write_state(arguments.save_state, result.state);
  if (!arguments.html.empty()) cdot::write_file(arguments.html, cdot::html_page(scene, result.film));
  if (!arguments.svg.empty()) cdot::write_file(arguments.svg, cdot::svg_still(scene, result.film));
  fmt::print("{}", arguments.json ? cdot::summary_json(scene, result) : cdot::summary_text(scene, result));
  return cdot::failure(scene, result).empty() ? well : answer_is_no;
}

int diagnose(const Arguments& arguments) {
  cdot::Scene scene = cdot::read_scene(arguments.scene);
  override_scene(arguments, scene);
  cdot::RunOptions options;
  options.progress = arguments.progress || ::isatty(STDERR_FILENO) != 0;
  options.diagnose_times = cdot::diagnose_times(scene.duration, poses_diagnosed);
  if (arguments.diagnose_time) {
    if (*arguments.diagnose_time > scene.duration)
      throw cdot::Error(fmt::format("--at {}: the run ends at {} s", *arguments.diagnose_time, scene.duration));
    options.diagnose_times = {*arguments.diagnose_time};
    scene.duration = std::max(*arguments.diagnose_time, 1e-9 * scene.step);
  }
  std::string warnings;
  const cdot::RunResult result = cdot::simulate(scene, options, warnings);
  fmt::print(stderr, "{}", warnings);
  if (result.interrupted) return stopped;
  fmt::print("{}", arguments.json ? cdot::diagnosis_json(scene, result) : cdot::diagnosis_text(scene, result));
  const auto concerns = cdot::concerns_about(scene, result.diagnosis, true);
  return concerns.empty() && cdot::failure(scene, result).empty() ? well : answer_is_no;
}

int accuracy(const Arguments& arguments) {
  cdot::Scene scene = cdot::read_scene(arguments.scene);
  override_scene(arguments, scene);
  cdot::AccuracyOptions options = arguments.accuracy;
  options.progress = arguments.progress || ::isatty(STDERR_FILENO) != 0;
  const cdot::AccuracyOutcome outcome = cdot::measure_accuracy(scene, options);
  if (!outcome.finished) return stopped;
  fmt::print("{}", outcome.out);
  return outcome.answered ? well : answer_is_no;
}

int jacobian(const Arguments& arguments) {
  const cdot::Scene scene = cdot::read_scene(arguments.scene);
  const cdot::SystemMatrix system = cdot::system_matrix(scene);
  if (!arguments.svg.empty()) cdot::write_file(arguments.svg, cdot::jacobian_svg(scene, system));
  fmt::print("{}", arguments.json ? cdot::jacobian_json(scene, system) : cdot::jacobian_text(scene, system));
  return well;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs mechanisms: bodies, and joints whose kernels were derived from their position "
      "constraints.");
  app.name("cdot-run");
  app.require_subcommand(1);
  app.footer(footer);
  Arguments arguments;
  add_simulate(app, arguments);
  const CLI::App* shown = add_jacobian(app, arguments);
  const CLI::App* diagnosed = add_diagnose(app, arguments);
  const CLI::App* costs = add_accuracy(app, arguments);
  CLI::App* list = app.add_subcommand("list", "Show the joints that a scene may name, with their parameters");
  list->add_flag("--json", arguments.json, "as JSON");
  try {
    app.parse(argc, argv);
    if (shown->parsed()) return jacobian(arguments);
    if (diagnosed->parsed()) return diagnose(arguments);
    if (costs->parsed()) return accuracy(arguments);
    if (!list->parsed()) return simulate(arguments);
    fmt::print("{}", arguments.json ? cdot::list_json() : cdot::list_text());
    return well;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? well : bad_input;
  } catch (const cdot::SceneError& error) {
    fmt::print(stderr, "{}{} mistake{}\n", error.what(), error.mistakes, error.mistakes == 1 ? "" : "s");
  } catch (const std::exception& error) {
    fmt::print(stderr, "cdot-run: {}\n", error.what());
  }
  return bad_input;
}
