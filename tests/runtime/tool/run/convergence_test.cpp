// Every problem with a known solution at four steps, each half the last: the error falls with the order of the method,
// and the finest run is as close to the reference as its step allows.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cdot/methods.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::convergence_test {
namespace {

// Between successive steps h and h/2 the errors have the ratio 2^slope. The slope is that of the order, to within this.
constexpr double slope_tolerance = 0.1;

// Symplectic Euler starts half a kick late, so positions, angles and rates have errors of first order. Exceptions: a
// start without acceleration (the four-bar has positions of second order) and a constant acceleration (the pulleys have
// exact rates). The test therefore takes the largest of the four errors.
struct Problem {
  const char* scene;
  double until;  // [s]
  double step;   // the coarsest [s]
  double bound;  // for the largest error of the finest run, step / 8 [m, rad, m/s, rad/s]
};

void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.scene; }

class Convergence : public testing::TestWithParam<std::tuple<Problem, Integrator>> {};

TEST_P(Convergence, IsOfTheOrder) {
  const auto& [problem, integrator] = GetParam();
  Scene scene = scene_named(problem.scene);
  scene.settings.integrator = integrator;
  const Reference reference = read_reference(problem.scene, problem.until);
  double before = 0, now = 0;
  for (int halvings = 0; halvings < 4; ++halvings) {
    scene.step = problem.step / (1 << halvings);
    const Distance distance = distance_to(reference, scene);
    now = distance.largest();
    fmt::print("  h = {:.4e}  off by {:.3e} m {:.3e} rad {:.3e} m/s {:.3e} rad/s", scene.step, distance.position,
               distance.angle, distance.velocity, distance.spin);
    if (halvings > 0) {
      const double slope = std::log2(before / now);
      fmt::print("  slope {:.3f}", slope);
      EXPECT_NEAR(slope, row_of(integrator).order, slope_tolerance);
    }
    fmt::print("\n");
    before = now;
  }
  EXPECT_LT(now, problem.bound);
  EXPECT_GT(now, reference.accuracy) << "better than the reference: the comparison says nothing";
}

std::string name_of_case(const testing::TestParamInfo<std::tuple<Problem, Integrator>>& info) {
  return fmt::format("{}_{}", std::get<0>(info.param).scene, name_of(integrators, std::get<1>(info.param)));
}

INSTANTIATE_TEST_SUITE_P(Problems, Convergence,
                         testing::Combine(testing::Values(Problem{"simple_pendulum", 10, 0.001, 1.5e-3},
                                                          Problem{"compound_pendulum", 10, 0.001, 1.1e-3},
                                                          Problem{"double_pendulum", 2, 0.001, 5e-4},
                                                          Problem{"four_bar", 10, 0.001, 9e-4},
                                                          Problem{"slider_crank", 0.2, 2.5e-6, 2.5e-4},
                                                          Problem{"pulley_ratio1", 1, 0.01, 2.5e-3},
                                                          Problem{"pulley_ratio2", 1, 0.01, 3e-3}),
                                          testing::Values(Integrator::euler)),
                         name_of_case);
INSTANTIATE_TEST_SUITE_P(Midpoint, Convergence,
                         testing::Combine(testing::Values(Problem{"simple_pendulum", 10, 0.01, 4e-4},
                                                          Problem{"compound_pendulum", 10, 0.01, 3e-4},
                                                          Problem{"double_pendulum", 2, 0.005, 2.2e-5},
                                                          Problem{"four_bar", 0.5, 0.005, 2e-6},
                                                          Problem{"slider_crank", 0.2, 2e-5, 2e-5}),
                                          testing::Values(Integrator::implicit)),
                         name_of_case);

// The work of a constant force over a step is exact in the midpoint rule, and so is a constant acceleration.
TEST(MidpointRule, IsExactForConstantAccelerations) {
  for (const char* pulleys : {"pulley_ratio1", "pulley_ratio2"}) {
    Scene scene = scene_named(pulleys);
    scene.settings.integrator = Integrator::implicit;
    scene.step = 0.02;
    EXPECT_LT(distance_to(read_reference(pulleys, 1), scene).largest(), 1e-13) << pulleys;
  }
}

// Scenes at rest have no order: at every step they stay at rest to round-off.
class Standing : public testing::TestWithParam<const char*> {};

TEST_P(Standing, StaysAtEveryStep) {
  Scene scene = scene_named(GetParam());
  for (const double step : {1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480}) {
    scene.step = step;
    double moved = 0, turned = 0;
    long long frames = 0;
    RunOptions options;
    options.row = [&](const Frame& frame) {
      ++frames;
      EXPECT_EQ(frame.bodies.size(), scene.bodies.size());
      for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
        const BodyState& is = frame.bodies[k];
        const BodyDefinition& was = scene.bodies[k].definition;
        moved = std::max(moved, std::hypot(is.x - was.x, is.y - was.y));
        turned = std::max(turned, std::abs(is.angle - was.angle));
      }
    };
    std::string warnings;
    simulate(scene, options, warnings);
    EXPECT_EQ(frames, std::llround(std::ceil(scene.duration / step * (1 - 1e-12))) + 1);
    fmt::print("  h = {:.4e}  moved {:.2e} m, turned {:.2e} rad\n", step, moved, turned);
    EXPECT_EQ(warnings, "");
    EXPECT_LT(moved, 1e-6);
    EXPECT_LT(turned, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Problems, Standing, testing::Values("catenary_100", "cantilever"),
                         [](const auto& info) { return std::string(info.param); });

World<double> after_a_second(const Scene& scene) {
  World<double> world = build_world<double>(scene);
  for (int k = 0; k < 60; ++k) world.step(1.0 / 60);
  return world;
}

TEST(Reactions, OfTheCantileverAreExactStatics) {
  const Scene scene = read_scene((scenes_dir() / "cantilever.toml").string());
  World<double> world = after_a_second(scene);
  const auto json = nlohmann::json::parse(read_text(source_dir() / "tests/runtime/tool/run/reference/cantilever.json"));
  ASSERT_EQ(json["reactions"].size(), 10u);
  for (int k = 0; k < 10; ++k) {
    const auto& expected = json["reactions"][static_cast<std::size_t>(k)];
    const auto reaction = world.reaction(k, k);  // weld k on its second body, block k
    const double force = expected["force_on_body_b"][1], moment = expected["moment_on_body_b_about_joint"];
    // From the centre of the block to the weld, 0.25 m to its left: M = torque - (-0.25) force.
    EXPECT_NEAR(reaction.force_x, 0, 1e-6 * force);
    EXPECT_NEAR(reaction.force_y, force, 1e-6 * force);
    EXPECT_NEAR(reaction.torque + 0.25 * reaction.force_y, moment, 1e-6 * moment);
  }
}

TEST(Reactions, OfTheCatenaryAreItsTension) {
  const Scene scene = read_scene((scenes_dir() / "catenary_100.toml").string());
  World<double> world = after_a_second(scene);
  const auto json =
      nlohmann::json::parse(read_text(source_dir() / "tests/runtime/tool/run/reference/catenary_100.json"));
  ASSERT_EQ(json["forces"].size(), 100u);
  for (int k = 0; k < 100; ++k) {
    const auto reaction = world.reaction(k, k);  // the joint at the left end of link k
    EXPECT_NEAR(reaction.force_x, json["forces"][static_cast<std::size_t>(k)][0], 1e-4);
    EXPECT_NEAR(reaction.force_y, json["forces"][static_cast<std::size_t>(k)][1], 1e-4);
  }
}

}  // namespace
}  // namespace cdot::test::convergence_test
