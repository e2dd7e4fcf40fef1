#include "runtime/tool/search/work.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

int mechanisms_of(const Scene& scene) { return std::max(1, extents_of(scene).mechanisms); }

double work_of_one_step(const Scene& scene) {
  const IntegratorRow& row = row_of(scene.settings.integrator);
  if (row.level == Level::acceleration) return 0;
  return price_of_step(row) * scene.settings.substeps * mechanisms_of(scene) * work_of_evaluation(scene);
}

}  // namespace

double work_of_evaluation(const Scene& scene) {
  return overhead + static_cast<double>(scene.bodies.size()) / mechanisms_of(scene);
}

double work_of_steps(const Scene& scene) { return work_of_one_step(scene) * std::ceil(scene.duration / scene.step); }

double work_of(const Scene& scene, const RunResult& result) {
  const double of_one = work_of_evaluation(scene);
  if (result.choice)
    return of_one * static_cast<double>(result.choice->evaluations + result.choice->evaluations_before);
  return work_of_one_step(scene) * static_cast<double>(result.steps) +
         of_one * static_cast<double>(result.counts.evaluations);
}

}  // namespace cdot
