// Drift::soft over all scenes: few sweeps, steps that vary, and no energy appears.
#include <gtest/gtest.h>

#include <cdot/balance.hpp>

#include "runtime/tool/scene/scene.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

constexpr double duration = 3;  // [s]

// Of step k: between a half and two, in no order.
double jittered(int k) { return std::exp2(std::sin(12.9898 * k * k)); }

template <class S>
void expect_no_rise(const Scene& scene, double step, bool jitter) {
  BasicWorld<S> world = build_world_in<S>(scene);
  if (world.worst_position_error().value > 1e-3) return;  // closing the gaps of a start may lift bodies
  BalanceWatch seen;
  seen.look(world.balance());
  for (int k = 0; world.time() < duration; ++k) {
    if (!world.step(jitter ? step * jittered(k) : step)) break;  // says so itself
    seen.look(world.balance());
  }
  // Symplectic Euler itself is off by h/2 F v.
  const double longest = (jitter ? 2 : 1) * step / scene.settings.substeps;
  EXPECT_LT(seen.risen.share(), 0.005 + longest)
      << scene.file << ": " << scene.settings.iterations << " sweeps, " << scene.settings.substeps
      << " substeps, jitter " << jitter << ", at " << seen.risen.time << " s";
}

TEST(Soft, EnergyRisesInNoScene) {
  for (const auto& file : all_scene_files()) {
    Scene scene = read_scene(file.string());
    scene.settings = {.solver = Solver::iterative,
                      .drift = Drift::soft,
                      .gravity_x = scene.settings.gravity_x,
                      .gravity_y = scene.settings.gravity_y,
                      .gravity_z = scene.settings.gravity_z};
    for (const auto& [iterations, substeps] : {std::pair{1, 1}, {1, 4}, {4, 2}})
      for (bool jitter : {false, true}) {
        scene.settings.iterations = iterations, scene.settings.substeps = substeps;
        in_space_of<double>(scene, [&](auto space) { expect_no_rise<decltype(space)>(scene, 1.0 / 60, jitter); });
      }
  }
}

}  // namespace
}  // namespace cdot::test
