// Euler's steps by sweeps over all scenes: few sweeps, steps that vary, each drift correction, and no energy appears.
// tests/bench/soft has all numbers of sweeps and substeps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/methods.hpp>

#include "tests/runtime/tool/support.hpp"
#include "tests/runtime/tool/swept_rise.hpp"

namespace cdot::test {
namespace {

void expect_no_rise(const Scene& scene, const SweptWay& way) {
  const SweptRise seen = swept_rise(scene, way);
  EXPECT_LT(seen.risen, seen.bound) << fmt::format("{}, {} {}: {} sweeps, {} substeps, steps up to {}/60 s, at {} s",
                                                   scene.file, name_of(integrators, way.integrator),
                                                   name_of(drifts, way.drift), way.sweeps, way.substeps,
                                                   way.jitter.longest, seen.time);
}

TEST(Soft, EnergyRisesInNoScene) {
  for (const auto& file : all_scene_files()) {
    const Scene scene = read_scene(file.string());
    for (const auto& [sweeps, substeps] : {std::pair{1, 1}, {1, 4}, {4, 2}})
      for (const Jitter& jitter : {Jitter{1, 1}, {0.5, 2}}) expect_no_rise(scene, {sweeps, substeps, jitter});
  }
}

TEST(Sweeps, EnergyRisesInNoScene) {
  constexpr double duration = 1;
  for (const auto& file : all_scene_files()) {
    const Scene scene = read_scene(file.string());
    for (const Drift drift : {Drift::projection, Drift::baumgarte, Drift::none})
      for (const Integrator integrator : {Integrator::euler, Integrator::implicit})
        for (const auto& [sweeps, substeps, jitter] :
             {std::tuple{1, 1, Jitter{1, 1}}, {2, 4, Jitter{0.1, 2}}, {10, 4, Jitter{1, 1}}})
          expect_no_rise(scene, {sweeps, substeps, jitter, drift, integrator, 1. / 60, duration});
  }
}

}  // namespace
}  // namespace cdot::test
