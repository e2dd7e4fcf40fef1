// The error that a run estimates of itself, against its distance from a run of much higher accuracy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/methods.hpp>

#include "runtime/tool/run/trajectory.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::error_estimate_test {
namespace {

constexpr int samples = 20;

// The largest distance from a run with dop853 that chooses its steps.
Apart true_error(const Scene& scene) {
  const std::vector<double> times = equal_times(scene.duration, samples);
  RunOptions options;
  std::vector<Frame> frames;
  options.row = [&](const Frame& frame) { frames.push_back(frame); };
  options.row_times = times;
  std::string warnings;
  simulate(scene, options, warnings);
  const Way exact{.integrator = Integrator::dop853, .adaptive = true};
  const Trajectory reference = trajectory_of(scene, exact, {1, 1e-11}, times);
  Apart worst;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Apart here = apart(frames[k], reference.frames.at(k), scene.dimension);
    worst.position = std::max(worst.position, here.position), worst.angle = std::max(worst.angle, here.angle);
  }
  return worst;
}

TrajectoryError estimate(const Scene& scene) {
  std::string warnings;
  return simulate(scene, {}, warnings).error;
}

Scene mechanism(const char* name, Integrator integrator, double step) {
  Scene scene = scene_named(name);
  scene.duration = std::min(scene.duration, 5.0);
  scene.step = step;
  scene.settings.integrator = integrator;
  return scene;
}

// Errors of four methods over seven decades. Beyond half a radian the phase is lost, and an error has no size. A few
// samples of an oscillating error overestimate its sum.
TEST(ErrorEstimate, IsNeverMuchBelowTheErrorNorHopelesslyAbove) {
  for (const char* name : {"compound_pendulum", "double_pendulum", "four_bar", "slider_crank", "machine",
                           "spatial/chain_10", "spatial/gyroscope"})
    for (const Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle, Integrator::rk4}) {
      const Scene scene = mechanism(name, integrator, 0.01);
      const Apart is = true_error(scene);
      const TrajectoryError said = estimate(scene);
      fmt::print("{:18} {:8}  off by {:.1e} m, {:.1e} rad; estimated {:.1e} m, {:.1e} rad from {} samples\n", name,
                 name_of(integrators, integrator), is.position, is.angle, said.position, said.angle, said.samples);
      EXPECT_GE(std::max(said.position, said.angle), 0.15 * std::min(0.5, is.larger()))
          << name << " " << name_of(integrators, integrator);
      EXPECT_LE(said.position, 100 * is.position) << name << " " << name_of(integrators, integrator);
    }
}

TEST(ErrorEstimate, FollowsTheOrderOfTheMethod) {
  for (const auto& [integrator, order] :
       {std::pair{Integrator::euler, 1}, {Integrator::rattle, 2}, {Integrator::implicit, 2}, {Integrator::rk4, 4}}) {
    const double coarse = estimate(mechanism("double_pendulum", integrator, 0.01)).position,
                 fine = estimate(mechanism("double_pendulum", integrator, 0.005)).position;
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.6) << name_of(integrators, integrator);
  }
}

TEST(ErrorEstimate, OfOwnStepsIsNone) {
  Scene scene = scene_named("compound_pendulum");
  scene.settings.integrator = Integrator::dop853;
  scene.settings.local_error = 1e-6;
  EXPECT_EQ(estimate(scene).samples, 0);  // a method that chooses its steps has an estimate of its own
}

}  // namespace
}  // namespace cdot::test::error_estimate_test
