// The error of its trajectory that a run with fixed steps estimates, against its distance from a far more accurate run.
#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/run/pick_integrator.hpp"
#include "tests/bench/search/runs.hpp"

namespace cdot::search_bench {
namespace {

constexpr int samples = 64;
constexpr double most_cpu = 20;             // [s] of a run
constexpr double off = 0.1, hardly = 0.05;  // in sizes of the mechanism, and [rad]
constexpr double game_step = 1.0 / 60;      // [s] of scenes that name none

struct Counts {
  int runs = 0, warned = 0, truly_off = 0, told = 0, false_alarms = 0;
};

// `truth` is found where the first step asks for it.
void study(Scene scene, double step, std::optional<std::vector<Frame>>& truth, Counts& counts) {
  scene.step = step;
  const std::vector<double> times = equal_times(scene.duration, samples);
  const Run run = run_of(with_integrator(scene), times, most_cpu);
  if (!run.whole || run.result.error.samples == 0) return;
  const Scene unnamed = without_method(scene);
  if (!truth) truth = truth_of(unnamed, times, most_cpu);
  if (truth->empty()) return;
  Yardstick yardstick(unnamed);
  yardstick.see(*truth);
  const double is = largest_apart(yardstick, run.rows, *truth), said = run.result.error.share;
  const bool warns = !trajectory_warning(scene, run.result).empty();
  ++counts.runs, counts.warned += warns, counts.truly_off += is > off;
  counts.told += is > off && warns, counts.false_alarms += warns && is < hardly;
  fmt::print("{:44} {:.4g} s: off by {:.1e}, estimated {:.1e}{}\n", short_name(scene), step, is, said,
             is > off && !warns ? "  MISSED" : "");
  std::fflush(stdout);
}

}  // namespace

void study_estimate(const std::vector<Scene>& scenes) {
  Counts counts;
  for (const Scene& scene : scenes) {
    if (scene.settings.local_error > 0 || scene.accuracy > 0) continue;
    const double own = scene.step > 0 ? scene.step : game_step;
    std::optional<std::vector<Frame>> truth;
    for (const double step : {own, own / 4, 2 * own}) study(scene, step, truth, counts);
  }
  fmt::print(
      "{} runs that pass, {} warned; {} off by more than {}, of which {} warned; {} warned but off by less than {}\n",
      counts.runs, counts.warned, counts.truly_off, off, counts.told, counts.false_alarms, hardly);
}

}  // namespace cdot::search_bench
