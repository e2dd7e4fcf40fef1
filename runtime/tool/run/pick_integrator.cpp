#include "runtime/tool/run/pick_integrator.hpp"

#include <cdot/recommended.hpp>

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

Scene with_integrator(Scene scene) {
  const Settings& named = scene.settings;
  if (scene.names_integrator || chooses_method(scene) || named.local_error > 0) return scene;
  if (sweeps(named.solver) || named.drift != Drift::projection) return scene;
  const auto pick = [&]<class S>(S) {
    std::string warnings;  // the run gives them
    BasicWorld<S> world = world_at_start<S>(scene, warnings);
    return recommended(world, scene.step, [&](int body) { return body_name(scene, body); });
  };
  const Recommendation found = scene.single ? in_space_of<float>(scene, pick) : in_space_of<double>(scene, pick);
  scene.settings.integrator = found.settings.integrator, scene.settings.substeps = found.settings.substeps;
  scene.why_integrator = found.reason;
  return scene;
}

}  // namespace cdot
