#include "runtime/tool/run/choose_method.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/tool/run/trajectory.hpp"

namespace cdot {
namespace {

constexpr int most_tries = 8;     // per integrator
constexpr double finer = 0.01;    // local error of the run to compare with, as a share
constexpr double finest = 1e-15;  // local error below which there is only round-off
constexpr double safety = 0.5;    // share of the accuracy that the run may use

Way way_of(Integrator integrator) { return {.integrator = integrator, .iterations = 0, .adaptive = true}; }

double distance_between(const Trajectory& a, const Trajectory& b, Dimension dimension) {
  double worst = a.finite && b.finite ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < std::min(a.frames.size(), b.frames.size()); ++k)
    worst = std::max(worst, apart(a.frames[k], b.frames[k], dimension).larger());
  return worst;
}

// The loosest local error found whose run is close enough to a finer one.
Choice try_integrator(const Scene& scene, Integrator integrator) {
  const Way way = way_of(integrator);
  const std::vector<double> times = equal_times(scene.duration, looks_for_accuracy);
  Choice best{integrator, 0, std::numeric_limits<double>::infinity(), false, 0};
  double local_error = scene.accuracy;
  for (int attempt = 0; attempt < most_tries && local_error > finest; ++attempt) {
    const Trajectory run = trajectory_of(scene, way, {1, local_error}, times);
    // The finer run starts with half the step: equal steps would share the same error.
    const Trajectory better = trajectory_of(scene, way, {2, finer * local_error}, times);
    const double achieved = distance_between(run, better, scene.dimension);
    if (achieved < best.achieved)
      best = {integrator, local_error, achieved, achieved <= safety * scene.accuracy, run.counts.evaluations};
    if (best.reached) break;
    // The error is about proportional to the local error. A factor of at most 0.1 bounds the number of trials.
    local_error *= std::clamp(0.5 * safety * scene.accuracy / achieved, 1e-4, 0.1);
  }
  return best;
}

bool better(const Choice& a, const Choice& b) {
  if (a.reached != b.reached) return a.reached;
  return a.reached ? a.evaluations < b.evaluations : a.achieved < b.achieved;
}

}  // namespace

Choice choose_method(const Scene& scene) {
  std::optional<Choice> best;
  for (const IntegratorRow& row : integrator_rows) {
    if (row.level != Level::acceleration) continue;
    const Choice choice = try_integrator(scene, row.integrator);
    if (!best || !better(*best, choice)) best = choice;
  }
  return *best;
}

Scene solved_by(const Choice& choice, Scene scene) {
  scene.step = scene.duration / looks_for_accuracy;
  scene.accuracy = 0;
  return solved_by(way_of(choice.integrator), {1, choice.local_error}, std::move(scene));
}

}  // namespace cdot
