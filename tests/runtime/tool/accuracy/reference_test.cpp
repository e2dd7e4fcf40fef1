// The reference of `cdot-run accuracy`: its methods agree with each other and with closed forms, and a report names a
// disagreement.
#include "runtime/tool/accuracy/reference.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <tuple>

#include "runtime/tool/accuracy/refine.hpp"
#include "tests/runtime/tool/accuracy/pendulum.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test {
namespace {

// The reference agrees with the closed form within its own error estimate.
TEST(AccuracyReference, IsAsGoodAsItSays) {
  const Scene scene = pendulum_scene();
  const ReferenceRun made = make_reference_run(scene), exact = closed_form();
  ASSERT_EQ(made.frames.size(), exact.frames.size());
  double worst = 0;
  for (std::size_t k = 0; k < made.frames.size(); ++k)
    worst = std::max(worst, apart(made.frames[k], exact.frames[k], scene.dimension).larger());
  fmt::print("  the two methods agree to {:.2e}, with the closed form to {:.2e}\n", made.disagreement(), worst);
  EXPECT_LE(worst, made.resolution() + 1e-14);
  EXPECT_LE(made.disagreement(), 0.1 * wanted_agreement);
  EXPECT_LE(worst, 1e-13);
}

// In space, against the closed form of the body that tumbles without torque.
TEST(AccuracyReference, IsAsGoodAsItSaysInSpace) {
  Scene scene = scene_named("spatial/torque_free_body");
  scene.duration = 8;
  const ReferenceRun made = make_reference_run(scene);
  const Reference exact = read_reference("torque_free_body", 8);
  double worst = 0;
  int compared = 0;
  for (const Frame& frame : made.frames)
    for (const ReferenceSample& sample : exact.samples)
      if (std::abs(sample.time - frame.time) < 1e-9) {
        worst = std::max(worst,
                         apart(frame, {sample.time, {sample.bodies.begin()->second}, 0, {}}, scene.dimension).larger());
        ++compared;
      }
  fmt::print("  the two methods agree to {:.2e}, with the closed form to {:.2e}\n", made.disagreement(), worst);
  EXPECT_EQ(compared, 8);
  EXPECT_LE(worst, made.resolution() + exact.accuracy);
  EXPECT_LE(made.disagreement(), wanted_agreement);
}

// With some compilers long double equals double.
constexpr bool finer = std::numeric_limits<long double>::digits > std::numeric_limits<double>::digits;
const std::string in_extended = ", in extended precision";

// A planar frame as a spatial one.
Frame in_space(Frame frame) {
  for (BodyState& b : frame.bodies) b.e0 = std::cos(b.angle / 2), b.e3 = std::sin(b.angle / 2);
  return frame;
}

// Compares with references of other code, for motions that magnify round-off and for one that does not.
TEST(AccuracyReference, AgreesWithOtherCode) {
  if (!finer) GTEST_SKIP() << "long double is double here";
  for (const auto& [problem, name, duration] : {std::tuple{"torque_free_body", "spatial/torque_free_body", 20.0},
                                                {"gyroscope", "spatial/gyroscope", 2.0},
                                                {"four_bar", "crank_rocker", 2.0}}) {
    Scene scene = scene_named(name);
    scene.duration = duration;
    const ReferenceRun made = make_reference_run(scene);
    const Reference other = read_reference_of_peers(problem);
    double worst = 0;
    int compared = 0;
    for (const ReferenceSample& sample : other.samples) {
      Frame at{sample.time, {}, 0, {}};
      for (const SceneBody& body : scene.bodies) at.bodies.push_back(sample.bodies.at(body.name));
      for (const Frame& frame : made.frames)
        if (std::abs(frame.time - sample.time) < 1e-9)
          worst = std::max(
              worst,
              apart(scene.dimension == Dimension::planar ? in_space(frame) : frame, at, Dimension::spatial).larger()),
          ++compared;
    }
    fmt::print("  {}: {} agree to {:.1e}, with other code, good to {:.0e}, to {:.1e}\n", problem, made.made_by,
               made.disagreement(), other.accuracy, worst);
    EXPECT_EQ(compared, 4);
    EXPECT_LE(made.disagreement(), wanted_agreement);
    EXPECT_LE(worst, made.disagreement() + other.accuracy + 1e-14);
  }
}

// Two methods without a common formula, on problems of all kinds; in extended precision if doubles are too coarse.
class Agreement : public testing::TestWithParam<const char*> {};

TEST_P(Agreement, IsAsWanted) {
  const std::string name = GetParam();
  const bool magnifies = name == "four_bar" || name == "spatial/torque_free_body" || name == "spatial/gyroscope";
  if (magnifies && !finer) GTEST_SKIP() << "long double is double here";
  const ReferenceRun made = make_reference_run(scene_named(name));
  fmt::print("  {} agree to {:.2e}; {}\n", made.made_by, made.disagreement(), made.settled);
  EXPECT_LE(made.disagreement(), wanted_agreement);
  const std::string methods = name == "machine" ? "dop853 and rk4" : "dop853 and composed rattle";
  EXPECT_EQ(made.made_by, methods + (magnifies ? in_extended : ""));
}

std::string plain(const testing::TestParamInfo<const char*>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Of, Agreement,
                         testing::Values("simple_pendulum", "compound_pendulum", "double_pendulum", "slider_crank",
                                         "crank_rocker", "four_bar", "chain_10", "pulley_ratio1", "pulley_ratio2",
                                         "machine", "spatial/double_pendulum", "spatial/slider_crank",
                                         "spatial/chain_10", "spatial/three_bodies", "spatial/torque_free_body",
                                         "spatial/gyroscope"),
                         plain);

// Drag takes energy backwards in time as well: composed RATTLE, which steps back, would not repeat the motion.
TEST(AccuracyReference, EffectsWithoutAnEnergyAreNotReversed) {
  Scene scene = scene_named("simple_pendulum");
  scene.duration = 1;
  scene.joints.emplace_back().definition = {"drag", {0}, {{"pa", {0, 0}}, {"c", {0.3}}}, {}};
  scene.joints.back().name = "air";
  EXPECT_FALSE(reversible(scene));
  const ReferenceRun made = make_reference_run(scene);
  fmt::print("  {} agree to {:.2e}; {}\n", made.made_by, made.disagreement(), made.settled);
  EXPECT_EQ(made.made_by, "dop853 and rk4");
  EXPECT_LE(made.disagreement(), wanted_agreement);

  scene.joints.back().definition = {"gravity_well", {0}, {{"pa", {0, 0}}, {"centre", {0, 3}}, {"mu", {2}}}, {}};
  EXPECT_TRUE(reversible(scene));
}

// The result depends on counts of work, not on times, so it repeats.
TEST(AccuracyReference, IsTheSameAgain) {
  Scene scene = scene_named("double_pendulum");
  scene.duration = 0.5;
  Effort effort;
  effort.evaluations = 3000;
  const ReferenceRun once = make_reference_run(scene, effort), again = make_reference_run(scene, effort);
  EXPECT_EQ(once.disagree, again.disagree);
  EXPECT_EQ(once.settled, again.settled);
  EXPECT_EQ(distances(once.frames, again.frames, scene.dimension), std::vector<double>(sample_count, 0));
}

// A double pendulum that turns over is chaotic: extended precision is too coarse as well.
TEST(AccuracyReference, SaysThatRoundOffForbidsMore) {
  if (!finer) GTEST_SKIP() << "long double is double here";
  Scene scene = scene_named("double_pendulum");
  const auto place = [&](std::size_t body, double x, double y, double angle) {
    auto& d = scene.bodies[body].definition;
    d.x = x, d.y = y, d.angle = angle;
  };
  place(0, 0, 0.5, std::numbers::pi / 2);
  place(1, 0.5, 1, 0);
  scene.bodies[0].definition.w = 1, scene.bodies[0].definition.vx = -0.5, scene.bodies[1].definition.vx = -1;
  scene.duration = 8.5;
  Effort effort;
  effort.evaluations = 400'000;
  const ReferenceRun made = make_reference_run(scene, effort);
  fmt::print("  {} agree to {:.2e}; condition {:.1e}, round-off {:.1e}; {}\n", made.made_by, made.disagreement(),
             made.sensitivity.condition, made.sensitivity.round_off, made.verdict);
  EXPECT_EQ(made.made_by, "dop853 and composed rattle" + in_extended);
  EXPECT_GT(made.disagreement(), wanted_agreement);
  EXPECT_LE(made.disagreement(), 1e-10);
  EXPECT_GT(made.sensitivity.condition, 3e6);
  EXPECT_LT(made.sensitivity.condition, 5e7);
  EXPECT_LT(made.sensitivity.slight, 1e-18);
  EXPECT_EQ(made.verdict, "round-off sets this limit");
}

TEST(AccuracyReference, SaysThatItMayBeFiner) {
  Effort effort;
  effort.evaluations = 2000;
  const ReferenceRun made = make_reference_run(scene_named("slider_crank"), effort);
  fmt::print("  {} agree to {:.2e}; {}; {}\n", made.made_by, made.disagreement(), made.settled, made.verdict);
  EXPECT_GT(made.disagreement(), wanted_agreement);
  const std::size_t between = made.made_by.find(" and ");
  ASSERT_NE(between, std::string::npos);
  for (const std::string& method : {made.made_by.substr(0, between), made.made_by.substr(between + 5)})
    EXPECT_NE(made.settled.find(method + " still changes by"), std::string::npos) << method;
  EXPECT_EQ(made.verdict, "the methods need finer steps: raise --budget");
}

// A four-bar has two possible motions from its flat pose, and hinges in space make some rows redundant.
TEST(AccuracyReference, PassesFlatPosesOfHinges) {
  Scene scene = scene_named("spatial/four_bar");
  scene.duration = 2;
  const ReferenceRun made = make_reference_run(scene);
  fmt::print("  {} agree to {:.2e}; {}; {}\n", made.made_by, made.disagreement(), made.settled, made.verdict);
  EXPECT_EQ(made.made_by, "dop853 and composed rattle");
  EXPECT_LE(made.disagreement(), finer ? wanted_agreement : 1e-11);
}

TEST(AccuracyReference, NamesTheCauseOfADisagreement) {
  EXPECT_EQ(verdict_on(2e-12, {10, 1e-13}, true), "round-off sets this limit");
  EXPECT_EQ(verdict_on(1e-11, {10, 1e-13}, true), "the methods need finer steps: raise --budget");
  EXPECT_TRUE(verdict_on(1e-11, {10, 1e-13}, false).starts_with("finer steps do not help"));
}

// --- composed RATTLE ---

TEST(ComposedRattle, IsOfOrderTen) {
  const Scene scene = pendulum_scene();
  const ReferenceRun exact = closed_form();
  double before = 0;
  int seen = 0;
  for (int steps = 2; steps <= 8; steps *= 2) {
    const Trajectory run = composed(Integrator::rattle, scene, steps, equal_times(2, 4));
    ASSERT_EQ(run.frames.size(), 4u);
    EXPECT_EQ(run.counts.evaluations, 4 * 35 * steps);
    double error = 0;
    for (std::size_t k = 0; k < 4; ++k)
      error = std::max(error, apart(run.frames[k], exact.frames[4 * k + 3], scene.dimension).larger());
    fmt::print("  {} steps: {:.3e}", steps, error);
    if (before > 0) {
      fmt::print(", order {:.2f}", std::log2(before / error));
      EXPECT_NEAR(std::log2(before / error), 10, 1);
      ++seen;
    }
    fmt::print("\n");
    before = error;
  }
  EXPECT_EQ(seen, 2);
}

TEST(ComposedRattle, NeedsAReversibleMotion) {
  for (const char* name : {"simple_pendulum", "four_bar", "slider_crank", "spatial/gyroscope", "spatial/three_bodies"})
    EXPECT_TRUE(reversible(scene_named(name))) << name;
  const auto changed = [](auto change) {
    Scene scene = scene_named("double_pendulum");
    change(scene);
    return reversible(scene);
  };
  CoordinateEffects effects{"angle", {}, {}, {}, {}};
  EXPECT_TRUE(changed([&](Scene& scene) { scene.joints[0].effects = {effects}; }));
  effects.springs.push_back({{false, 0, 0, 3, 0}, {}});
  EXPECT_TRUE(changed([&](Scene& scene) { scene.joints[0].effects = {effects}; }));
  effects.springs.push_back({{false, 0, 0, 0, 1}, {}});
  EXPECT_FALSE(changed([&](Scene& scene) { scene.joints[0].effects = {effects}; }));
  effects.springs.clear();
  effects.motor = Motor{1, 2};
  EXPECT_FALSE(changed([&](Scene& scene) { scene.joints[0].effects = {effects}; }));
  EXPECT_FALSE(changed([](Scene& scene) { scene.joints[0].bonds = {{"breaking", {{"strength", {10}}}}}; }));
  EXPECT_FALSE(changed([](Scene& scene) { scene.joints[0].definition.soft = Softness{true, 2, 0.5, 0, 0}; }));
  EXPECT_FALSE(changed([](Scene& scene) { scene.bodies[0].definition.linear_damping = 0.1; }));
  EXPECT_FALSE(changed([](Scene& scene) { scene.joints[0].definition.type = "max_distance"; }));
  EXPECT_FALSE(changed([](Scene& scene) { scene.springs.push_back({0, 1, 0, 0, 0, 0, 0, 0, 1, 1, 0.1}); }));
}

// A weak motor drives a rod against a limit: the acceleration jumps when the rod reaches the limit and when it leaves.
TEST(AccuracyReference, SolvesMotionsWithKinks) {
  const Scene scene = read_scene(
      "duration = 2\n[[body]]\nname = \"rod\"\nmass = 1\nshape = { rod = 1 }\nposition = [0.5, 0]\n[[joint]]\ntype = "
      "\"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\nangle.limit = { lower = \"-80 deg\" }\n"
      "angle.motor = { speed = 1, max = 2 }\n",
      "kinks.toml");
  const ReferenceRun made = make_reference_run(scene);
  fmt::print("  {} agree to {:.2e}; {}\n", made.made_by, made.disagreement(), made.settled);
  EXPECT_LE(made.disagreement(), 1e-9);
}

TEST(AccuracyReference, AgreesUntilItDoesNot) {
  ReferenceRun reference;
  reference.times = {1, 2, 3, 4};
  reference.disagree = {1e-13, 1e-10, 1e-4, 1e-11};
  EXPECT_EQ(reference.agreed_until(1e-9), 2);
  EXPECT_EQ(reference.agreed_until(1e-14), 0);
  EXPECT_EQ(reference.disagreement(), 1e-4);
}

}  // namespace
}  // namespace cdot::test
