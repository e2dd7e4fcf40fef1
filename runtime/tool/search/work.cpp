#include "runtime/tool/search/work.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

struct Work {
  double all, of_one;  // of each island once, and of the mean body's
};

Work work_of_evaluations(const Scene& scene) {
  const Extents extents = extents_of(scene);
  double movable = 0, of_others = 0;
  for (std::size_t body = 0; body < scene.bodies.size(); ++body)
    if (!scene.bodies[body].is_static) ++movable, of_others += extents.bodies[body];
  return {overhead * std::max(1, extents.mechanisms) + movable, overhead + of_others / std::max(1.0, movable)};
}

double work_of_one_step(const Scene& scene) {
  const IntegratorRow& row = row_of(scene.settings.integrator);
  if (row.level == Level::acceleration) return 0;
  return price_of_step(row) * scene.settings.substeps * work_of_evaluations(scene).all;
}

}  // namespace

double work_of_evaluation(const Scene& scene) { return work_of_evaluations(scene).of_one; }

double evaluations_of_all(const Scene& scene) {
  const Work work = work_of_evaluations(scene);
  return work.all / work.of_one;
}

double price_of_derivatives(const Scene& scene) {
  const int freedom = scene.dimension == Dimension::planar ? 3 : 6;
  return 2.0 * freedom * static_cast<double>(scene.bodies.size());
}

double work_of_steps(const Scene& scene) { return work_of_one_step(scene) * std::ceil(scene.duration / scene.step); }

double work_of(const Scene& scene, const RunResult& result) {
  const double of_one = work_of_evaluation(scene);
  if (result.choice)
    return of_one * static_cast<double>(result.choice->evaluations + result.choice->evaluations_before);
  return std::max(work_of_one_step(scene) * static_cast<double>(result.steps),
                  of_one * static_cast<double>(result.solves)) +
         of_one * static_cast<double>(result.counts.evaluations);
}

}  // namespace cdot
