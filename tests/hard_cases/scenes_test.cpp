// Hard cases in `cdot-run simulate`: reports, notes, refusals with their line, and numbers with closer bounds than
// those for every way. Steps are those of the scene, mostly 1/60 s, unless stated.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::scenes_test {
namespace {

Scene hard(const char* name) {
  return read_scene(std::string(CDOT_SOURCE_DIR "/tests/hard_cases/") + name + "/planar.toml");
}

Scene in_steps_of_a_millisecond(Scene scene) {
  scene.step = 0.001;
  return scene;
}

RunResult run(const Scene& scene, RunOptions options = {}) {
  std::string warnings;
  RunResult result = simulate(scene, options, warnings);
  fmt::print("{}", summary_text(scene, result));
  EXPECT_EQ(warnings, "");
  EXPECT_TRUE(result.finite);
  return result;
}

// The largest rise of the energy above its value at the start, relative to `scale`.
struct EnergyRise {
  double first = 0, highest = -1e300;
  bool started = false;
  void operator()(const Frame& frame) {
    if (!started) first = frame.energy, started = true;
    highest = std::max(highest, frame.energy);
  }
  double rise() const { return highest - first; }
};

// The same scene in single precision must stay finite.
void expect_finite_in_float(const Scene& scene) {
  World<float> world = build_world<float>(scene);
  if (scene.project) world.project(1e-6);
  const int steps = static_cast<int>(std::ceil(scene.duration / scene.step));
  for (int k = 0; k < steps; ++k) world.step(scene.step);
  for (int k = 0; k < static_cast<int>(scene.bodies.size()); ++k) {
    const auto pose = world.pose(k);
    EXPECT_TRUE(std::isfinite(pose.x + pose.y + pose.angle)) << scene.bodies[static_cast<std::size_t>(k)].name;
  }
}

TEST(HardCasesInScenes, BallAndChain) {
  const Scene scene = hard("ball_and_chain");
  const RunResult result = run(scene);
  EXPECT_LT(result.worst_error, 5e-3);
  expect_finite_in_float(scene);
}

// The ball and chain at rest: the top joint carries the whole weight.
TEST(HardCasesInScenes, BallAndChainAtRestCarriesItsWeight) {
  Scene scene = hard("ball_and_chain");
  for (SceneBody& body : scene.bodies) {
    BodyDefinition& b = body.definition;
    b.y = -b.x, b.x = 0, b.angle = -1.5707963267948966;
  }
  for (SceneJoint& joint : scene.joints) {
    for (NamedValue& value : joint.definition.parameters) {
      const bool at_origin = joint.definition.bodies[0] == world_body && value.name == "pa";
      if (at_origin) value.numbers = {0, 0};
    }
  }
  World<double> world = build_world<double>(scene);
  for (int k = 0; k < 60; ++k) world.step(scene.step);
  const auto top = world.reaction(0, 0);
  EXPECT_NEAR(top.force_y, 41795.6, 41.8);
  EXPECT_NEAR(top.force_y, (40 * 5.982 + 4021.24) * 9.81, 1e-3);
}

TEST(HardCasesInScenes, LightChainHeavyLoad) {
  Scene scene = hard("heavy_load");
  scene.settings.substeps = 8;
  EnergyRise energy;
  RunOptions options;
  options.row = [&](const Frame& frame) { energy(frame); };
  const RunResult result = run(scene, options);
  EXPECT_LT(result.worst_error, 1e-3);
  EXPECT_LT(energy.rise(), 0.001 * 500);  // 0.1 % of the kick's energy
  expect_finite_in_float(scene);
}

TEST(HardCasesInScenes, LightChainHeavyLoadAtRest) {
  Scene scene = hard("heavy_load");
  scene.settings.substeps = 8;
  scene.bodies.back().definition.vx = 0;
  World<double> world = build_world<double>(scene);
  for (int k = 0; k < 60; ++k) world.step(scene.step);
  EXPECT_NEAR(world.reaction(0, 0).force_y, 9908.1, 1e-3);
}

TEST(HardCasesInScenes, FeatherBetweenAnvils) {
  Scene scene = hard("feather_between_anvils");
  scene.settings.substeps = 32;  // the energy of the swing has an error proportional to the step
  const RunResult result = run(scene);
  EXPECT_LT(result.worst_error, 1e-3);
  const double swing = 1000 * 9.81 * (0.5 + 2.5);  // energy of the swing: the anvils' potential above the vertical [J]
  EXPECT_LT(result.energy_drift, 0.005 * swing);
  expect_finite_in_float(scene);
}

TEST(HardCasesInScenes, SameJointTenTimes) {
  const auto states_of = [](const Scene& scene) {
    std::vector<BodyState> states;
    RunOptions options;
    options.row = [&](const Frame& frame) { states.push_back(frame.bodies[0]); };
    const RunResult result = run(scene, options);
    EXPECT_LT(result.worst_error, 1e-9);
    return states;
  };
  const std::vector<BodyState> ten = states_of(in_steps_of_a_millisecond(hard("same_joint_ten_times")));
  const std::vector<BodyState> one = states_of(in_steps_of_a_millisecond(scene_named("compound_pendulum")));
  ASSERT_EQ(ten.size(), one.size());
  double apart = 0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    apart = std::max(
        {apart, std::abs(ten[k].x - one[k].x), std::abs(ten[k].y - one[k].y), std::abs(ten[k].angle - one[k].angle)});
  }
  EXPECT_LT(apart, 1e-9);
}

TEST(HardCasesInScenes, FourBarThroughTheFlatPosition) {
  Scene scene = hard("change_point");
  scene.settings.substeps = 4;
  double branch = 0;
  RunOptions options;
  options.row = [&](const Frame& frame) {
    branch =
        std::max(branch, std::abs(std::remainder(frame.bodies[0].angle - frame.bodies[2].angle, 6.283185307179586)));
  };
  const RunResult result = run(scene, options);
  EXPECT_LT(result.worst_error, 1e-4);
  EXPECT_LT(result.energy_drift, 0.005 * 20.4533);  // of the energy above the pivots
  EXPECT_LT(branch, 1e-3) << "left the parallel branch";
  expect_finite_in_float(scene);
}

TEST(HardCasesInScenes, SliderCrankThroughItsDeadCentres) {
  const Scene scene = hard("dead_centre");
  double guide = 0;
  BodyState crank{};
  RunOptions options;
  options.row = [&](const Frame& frame) {
    guide = std::max(guide, std::abs(frame.bodies[2].y));
    if (frame.time < 0.2 + 1e-9) crank = frame.bodies[0];
  };
  run(scene, options);
  const Reference reference = read_reference("slider_crank", 0.2);
  // 0.2 s are 6553.6 steps: the last row is advanced to the end with the rate.
  const double late = 0.2 - std::floor(0.2 / scene.step) * scene.step;
  EXPECT_NEAR(crank.angle + crank.w * late, reference.samples.back().bodies.at("crank").angle, 1e-3);
  EXPECT_LT(guide, 1e-5);
}

TEST(HardCasesInScenes, DistanceBetweenCoincidentPoints) {
  const Scene scene = hard("zero_length_distance");
  const RunResult result = run(scene);
  EXPECT_LT(result.worst_error, 1e-4);
  expect_finite_in_float(scene);
}

// Checks that build_world() refuses a ball at the anchor with these lines, in their first line and with a fix.
void expect_refused(const std::string& lines, const std::string& named, const std::string& fix) {
  const Scene scene = read_scene("[[body]]\nname = \"ball\"\nmass = 1\nshape = { disc = 1 }\n" + lines, "zero.toml");
  try {
    build_world<double>(scene);
    FAIL() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_EQ(std::string(error.what()).find("zero.toml:5:1: error: " + named), 0u) << error.what();
    EXPECT_NE(std::string(error.what()).find(fix), std::string::npos) << error.what();
  }
}

// A distance of length 0 has no direction on C = 0: refused in the joint's line, with a replacement.
TEST(HardCasesInScenes, DistanceOfLengthZeroIsRefused) {
  expect_refused(
      "[[joint]]\nname = \"zero\"\ntype = \"distance\"\nbodies = [\"world\", \"ball\"]\n"
      "pa = [0, 0]\npb = [0, 0]\nl = 0\n",
      "zero: ", "revolute");
}

// So is a spring that pushes from there.
TEST(HardCasesInScenes, SpringThatPushesFromLengthZeroIsRefused) {
  expect_refused("[[spring]]\nbodies = [\"world\", \"ball\"]\nstiffness = 100\nrest = 1\n", "a spring 1 away",
                 "a rest of 0");
}

TEST(HardCasesInScenes, PulleyAtZeroRope) {
  const Scene scene = hard("pulley_at_zero_rope");
  EnergyRise energy;
  double length_error = 0;
  bool reached = false;
  RunOptions options;
  options.row = [&](const Frame& frame) {
    energy(frame);
    const double l1 = std::hypot(frame.bodies[0].x + 1, frame.bodies[0].y - 10);
    const double l2 = std::hypot(frame.bodies[1].x - 1, frame.bodies[1].y - 10);
    reached = reached || l1 < 1e-3 || l2 < 1e-3;
    if (!reached) length_error = std::max(length_error, std::abs(l1 + l2 - 5.2));
  };
  run(scene, options);
  EXPECT_LT(length_error, 1e-4);
  EXPECT_LT(energy.rise(), 0.001 * 147.15);
  expect_finite_in_float(scene);
}

TEST(HardCasesInScenes, BothBodiesStatic) {
  const Scene scene = hard("both_immovable");
  const RunResult result = run(scene);
  EXPECT_EQ(result.notes.size(), 1u);
  EXPECT_LT(result.worst_error, 1e-9);
  expect_finite_in_float(scene);
}

// 1000 km away a double resolves 1e-10 m; the pendulum may differ by that from the one at the origin.
TEST(HardCasesInScenes, FarFromTheOrigin) {
  const auto states_of = [](const Scene& scene) {
    std::vector<BodyState> states;
    RunOptions options;
    options.row = [&](const Frame& frame) { states.push_back(frame.bodies[0]); };
    run(scene, options);
    return states;
  };
  const std::vector<BodyState> far = states_of(in_steps_of_a_millisecond(hard("far_from_origin")));
  const std::vector<BodyState> near = states_of(in_steps_of_a_millisecond(scene_named("compound_pendulum")));
  ASSERT_EQ(far.size(), near.size());
  double apart = 0;
  for (std::size_t k = 0; k < far.size(); ++k) {
    apart = std::max({apart, std::abs(far[k].x - 1e6 - near[k].x), std::abs(far[k].angle - near[k].angle)});
  }
  fmt::print("  apart {:.2e}\n", apart);
  EXPECT_LT(apart, 1e-5);
}

}  // namespace
}  // namespace cdot::test::scenes_test
