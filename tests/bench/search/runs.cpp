#include "tests/bench/search/runs.hpp"

#include <algorithm>
#include <filesystem>

#include "runtime/tool/run/process.hpp"

namespace cdot::search_bench {

namespace fs = std::filesystem;

namespace {

Run run_with(RunOptions options, const Scene& scene, const std::vector<double>& times, std::string& warnings) {
  Run run;
  options.row_times = times;
  options.row = [&](const Frame& frame) { run.rows.push_back(frame); };
  run.result = simulate(scene, options, warnings);
  run.whole = !run.result.stopped && failure(scene, run.result).empty() && run.rows.size() == times.size();
  return run;
}

Scene named(const Scene& scene, Integrator integrator, double local_error, double step) {
  Choice choice;
  choice.integrator = integrator, choice.local_error = local_error, choice.step = step;
  Scene solved = solved_by(choice, scene);
  solved.accuracy = 0;
  return solved;
}

}  // namespace

std::vector<Scene> scenes_below(const std::string& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Scene> scenes;
  for (const fs::path& file : files) scenes.push_back(read_scene(file.string()));
  return scenes;
}

Scene without_method(Scene scene) {
  const Settings named = scene.settings;
  scene.settings = {.gravity_x = named.gravity_x, .gravity_y = named.gravity_y, .gravity_z = named.gravity_z};
  scene.step = 0, scene.accuracy = 0, scene.single = false;
  return scene;
}

std::string short_name(const Scene& scene) {
  const fs::path path = scene.file;
  return path.parent_path().filename() / path.stem();
}

Run run_of(const Scene& scene, const std::vector<double>& times, double most) {
  RunOptions options;
  const double began = cpu_now();
  if (!chooses_method(scene)) options.look = [&](const Frame&, const RunResult&) { return cpu_now() - began < most; };
  std::string warnings;
  return run_with(options, scene, times, warnings);
}

Run search_of(const Scene& scene, const std::vector<double>& times, double most_evaluations, std::string& warnings) {
  RunOptions options;
  options.most_evaluations = most_evaluations;
  return run_with(options, scene, times, warnings);
}

Run run_of(const Scene& scene, Integrator integrator, double local_error, double step, const std::vector<double>& times,
           double most) {
  return run_of(named(scene, integrator, local_error, step), times, most);
}

Run reference_of(const Scene& scene, double local_error, const std::vector<double>& times, double most) {
  const double interval = scene.duration / intervals_of_own_steps;
  Run run = run_of(scene, Integrator::dop853, local_error, interval, times, most);
  const bool jams = run.result.counts.rescued == 1 && run.result.first_rescue < 1.5 * interval;
  if (run.result.counts.rescued > 0 && !jams) run.whole = false;  // another method has taken long steps
  return run;
}

double largest_apart(const Yardstick& yardstick, const std::vector<Frame>& a, const std::vector<Frame>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, yardstick.apart(a[k], b[k]));
  return most;
}

std::vector<Frame> truth_of(const Scene& scene, const std::vector<double>& times, double most) {
  const double interval = scene.duration / intervals_of_own_steps;
  for (const auto& [integrator, local_error] :
       {std::pair{Integrator::dop853, 1e-12}, {Integrator::dop853, 1e-10}, {Integrator::radau5, 1e-10}}) {
    Run run = run_of(scene, integrator, local_error, interval, times, most);
    if (run.whole) return std::move(run.rows);
  }
  return {};
}

double median(std::vector<double> numbers) {
  if (numbers.empty()) return 0;
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

}  // namespace cdot::search_bench
