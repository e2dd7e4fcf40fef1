#include "tests/runtime/tool/soft_rise.hpp"

#include <cdot/balance.hpp>

namespace cdot::test {
namespace {

constexpr double duration = 3;  // [s]

template <class S>
SoftRise watch(const Scene& scene, const Jitter& jitter) {
  BasicWorld<S> world = build_world_in<S>(scene);
  SoftRise seen;
  seen.starts = world.worst_position_error().value <= 1e-3;
  seen.bound = 0.005 + jitter.longest / 60 / scene.settings.substeps;
  if (!seen.starts) return seen;
  BalanceWatch balance;
  balance.look(world.balance());
  for (int k = 0; !seen.fails && world.time() < duration; ++k) {
    seen.fails = !world.step(jitter.length(k) / 60);
    if (!seen.fails) balance.look(world.balance());
  }
  seen.risen = balance.risen.share(), seen.time = balance.risen.time;
  return seen;
}

}  // namespace

SoftRise soft_rise(Scene scene, const SoftWay& way) {
  scene.settings = {.solver = Solver::iterative,
                    .drift = Drift::soft,
                    .iterations = way.sweeps,
                    .substeps = way.substeps,
                    .gravity_x = scene.settings.gravity_x,
                    .gravity_y = scene.settings.gravity_y,
                    .gravity_z = scene.settings.gravity_z};
  SoftRise seen;
  in_space_of<double>(scene, [&](auto space) { seen = watch<decltype(space)>(scene, way.jitter); });
  return seen;
}

}  // namespace cdot::test
