#include "runtime/tool/commands/options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cdot/methods.hpp>

namespace cdot {

void add_scene(CLI::App& line, SceneOptions& options) {
  line.add_option("SCENE", options.file, "the scene, a TOML file")->required();
}

CLI::Option* add_until(CLI::App& line, SceneOptions& options) {
  return line.add_option("--until", options.until, "end at this time [s], in place of the scene's duration")
      ->check(CLI::PositiveNumber);
}

void add_method(CLI::App& line, SceneOptions& options) {
  line.add_option("--step", options.step, "the time step [s]")->check(CLI::PositiveNumber);
  line.add_option("--solver", options.solver, "direct or iterative")->check(CLI::IsMember(names_of(solvers)));
  line.add_option("--integrator", options.integrator,
                  "euler, implicit (heavy loads on light chains), rattle (long runs), rk4 or dop853 (accuracy)")
      ->check(CLI::IsMember(names_of(integrators)));
  line.add_option("--local-error", options.local_error,
                  "let rk4 or dop853 choose its steps: the estimated error of one [m, rad, and per s]")
      ->check(CLI::PositiveNumber);
  line.add_option("--kernels", options.kernels,
                  "how the iterative solver solves the rows of one joint together: fast, balanced or robust")
      ->check(CLI::IsMember(names_of(kernel_forms)));
  line.add_option("--precision", options.precision, "compute in double or float")
      ->check(CLI::IsMember(names_of(precisions)));
  line.add_option("--drift", options.drift, "what keeps joints together: projection, baumgarte or none")
      ->check(CLI::IsMember(names_of(drifts)));
  line.add_option("--iterations", options.iterations, "of the iterative solver, per substep")
      ->check(CLI::PositiveNumber);
  line.add_option("--substeps", options.substeps, "per step")->check(CLI::PositiveNumber);
}

void add_progress(CLI::App& line, SceneOptions& options) {
  line.add_flag("--progress", options.progress, "show progress even where stderr is no terminal");
}

Scene scene_of(const SceneOptions& options) {
  Scene scene = read_scene(options.file);
  Settings& settings = scene.settings;
  if (options.until > 0) scene.duration = options.until;
  if (options.step > 0) scene.step = options.step;
  if (options.iterations > 0) settings.iterations = options.iterations;
  if (options.substeps > 0) settings.substeps = options.substeps;
  if (options.local_error > 0) settings.local_error = options.local_error;
  if (!options.solver.empty()) settings.solver = method_called(solvers, options.solver);
  if (!options.integrator.empty()) settings.integrator = method_called(integrators, options.integrator);
  if (!options.drift.empty()) settings.drift = method_called(drifts, options.drift);
  if (!options.kernels.empty()) settings.kernels = method_called(kernel_forms, options.kernels);
  if (!options.precision.empty()) scene.single = method_called(precisions, options.precision);
  return scene;
}

bool progress_shown(const SceneOptions& options) { return options.progress || ::isatty(STDERR_FILENO) != 0; }

void check_within(double at, double end) {
  if (at > end) throw Error(fmt::format("--at {}: the run ends at {} s", at, end));
}

}  // namespace cdot
