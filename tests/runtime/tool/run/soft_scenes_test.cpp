// Drift::soft over all scenes: few sweeps, steps that vary, and no energy appears. tests/bench/soft has all numbers of
// sweeps and substeps.
#include <gtest/gtest.h>

#include "tests/runtime/tool/soft_rise.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

TEST(Soft, EnergyRisesInNoScene) {
  for (const auto& file : all_scene_files()) {
    const Scene scene = read_scene(file.string());
    for (const auto& [sweeps, substeps] : {std::pair{1, 1}, {1, 4}, {4, 2}})
      for (const Jitter& jitter : {Jitter{1, 1}, {0.5, 2}}) {
        const SoftRise seen = soft_rise(scene, {sweeps, substeps, jitter});
        EXPECT_LT(seen.risen, seen.bound)
            << scene.file << ": " << sweeps << " sweeps, " << substeps << " substeps, steps up to " << jitter.longest
            << "/60 s, at " << seen.time << " s";
      }
  }
}

}  // namespace
}  // namespace cdot::test
