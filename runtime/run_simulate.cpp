#include "runtime/run_simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "runtime/run_process.hpp"

namespace cdot {
namespace {

constexpr double start_tolerance =
    1e-6;  // [m], [rad], and per second: what a start may be off unreported

// A line on stderr that is written over, at most a few times a second.
class Progress {
 public:
  Progress(bool wanted, double until) : wanted_(wanted), until_(until) {}
  ~Progress() {
    if (shown_) fmt::print(stderr, "\r{:60}\r", "");
  }
  void at(double time) {
    if (!wanted_ || ++calls_ % 64 != 0) return;
    const std::time_t now = std::time(nullptr);
    if (now == last_) return;
    if (last_ != 0) {
      fmt::print(stderr, "\r{:3.0f} %  {:.4g} s of {:.4g} s", 100 * time / until_, time, until_);
      shown_ = true;
    }
    last_ = now;
  }

 private:
  bool wanted_, shown_ = false;
  double until_;
  unsigned calls_ = 0;
  std::time_t last_ = 0;
};

void judge(const Scene& scene, const Frame& frame, RunResult& result) {
  const WorstError& worst = frame.worst;
  if (worst.joint >= 0 && worst.value >= result.worst_error) {
    result.worst_error = worst.value;
    result.worst_error_time = frame.time;
    result.worst_joint = scene.joints[static_cast<std::size_t>(worst.joint)].name;
  }
  result.finite = finite(frame) && std::isfinite(worst.value);
  result.energy_drift = std::max(result.energy_drift, std::abs(frame.energy - result.energy_start));
  result.energy_end = frame.energy;
  result.time = frame.time;
}

template <class S>
void finish(const Scene& scene, const BasicWorld<S>& world, RunResult& result) {
  for (std::size_t k = 0; k < scene.joints.size(); ++k) {
    if (world.broken(static_cast<int>(k))) result.broken_joints.push_back(scene.joints[k].name);
  }
  result.redundant_rows = world.redundant_rows();
  result.counts = world.step_counts();
  for (const Note& note : world.notes()) {
    const std::string& joint = scene.joints[static_cast<std::size_t>(note.joint)].name;
    result.notes.push_back(fmt::format("joint \"{}\" {}", joint, note.text));
  }
  result.interrupted = Interrupt::asked();
}

// A method that chooses its steps gives the state at any time by its own interpolant: none has to be guessed between
// two. Empty for other methods.
std::vector<double> own_ends(const Scene& scene, const RunOptions& options) {
  if (!(scene.settings.local_error > 0)) return {};
  std::vector<double> ends = every(scene.step, scene.duration);
  ends.push_back(scene.duration);
  for (const auto* times : {&options.row_times, &options.film_times})
    for (double time : *times)
      if (time <= scene.duration) ends.push_back(time);
  std::sort(ends.begin(), ends.end());
  // Times that only round-off tells apart are one.
  const double same = 1e-9 * scene.duration;
  ends.erase(std::unique(ends.begin(), ends.end(), [&](double a, double b) { return b - a < same; }), ends.end());
  ends.erase(ends.begin());  // the start
  return ends;
}

template <class S>
RunResult simulate_in(const Scene& scene, const RunOptions& options, std::string& warnings) {
  RunResult result;
  BasicWorld<S> world = world_at_start<S>(scene, warnings);
  Sampler rows(
      options.row_times, options.row ? options.row : [](const Frame&) {});
  Sampler film(options.film_times, [&](const Frame& frame) { result.film.push_back(frame); });
  const bool every_step = options.row && options.row_times.empty();
  Progress progress(options.progress, scene.duration);
  const Interrupt interrupt;

  const int bodies = static_cast<int>(scene.bodies.size());
  const std::vector<double> ends = own_ends(scene, options);
  const auto steps = ends.empty() ? static_cast<long long>(std::ceil(scene.duration / scene.step * (1 - 1e-12)))
                                  : static_cast<long long>(ends.size());
  const auto end_of = [&](long long k) {
    return ends.empty() ? static_cast<double>(k + 1) * scene.step : ends[static_cast<std::size_t>(k)];
  };
  Frame before = frame_of(world, 0, bodies), after = before;
  result.energy_start = before.energy;
  for (long long k = 0;; ++k) {
    judge(scene, after, result);
    if (!result.finite) break;
    if (every_step) options.row(after);
    rows.step(before, after);
    film.step(before, after);
    if (k == steps || Interrupt::asked()) break;
    const double start = cpu_now();
    world.step(ends.empty() ? scene.step : end_of(k) - (k > 0 ? end_of(k - 1) : 0));
    result.cpu += cpu_now() - start;
    result.steps = k + 1;
    std::swap(before, after);
    after = frame_of(world, end_of(k), bodies);
    progress.at(after.time);
  }
  finish(scene, world, result);
  return result;
}

}  // namespace

template <class S>
BasicWorld<S> world_at_start(const Scene& scene, std::string& warnings) {
  BasicWorld<S> world = build_world_in<S>(scene);
  if (scene.project && !world.project(start_tolerance * start_tolerance)) {
    warnings +=
        fmt::format("{}: warning: the start could not be projected: joints contradict each other\n",
                    scene.file);
  }
  warnings += inconsistency_report(scene, world, start_tolerance);
  world.prepare();
  return world;
}

RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings) {
  if (scene.accuracy > 0) {
    const Choice choice = choose_method(scene);
    const Scene chosen = solved_by(choice, scene);
    RunResult result = simulate(chosen, options, warnings);
    result.choice = choice;
    return result;
  }
  return scene.dimension == Dimension::planar
             ? simulate_in<Planar<double>>(scene, options, warnings)
             : simulate_in<Spatial<double>>(scene, options, warnings);
}

#define CDOT_INSTANTIATE(S) template BasicWorld<S> world_at_start(const Scene&, std::string&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
