// Runs from inside: verdicts, warnings, projection, selection of frames.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::run_test {
namespace {

Scene scene_of(const std::string& text) { return read_scene(std::string_view(text), "test.toml"); }

constexpr const char* pendulum =
    "duration = 1\nstep = 0.001\n[[body]]\nname = \"rod\"\nmass = 1\nshape = { rod = 1 }\nposition = [0.5, 0]\n"
    "[[joint]]\nname = \"pivot\"\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\npa = [0, "
    "0]\npb = [-0.5, 0]\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(Run, ConsistentStartIsSilent) {
  std::string warnings;
  const RunResult result = simulate(scene_of(pendulum), {}, warnings);
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(result.steps, 1000);
  EXPECT_EQ(failure(scene_of(pendulum), result), "");
}

TEST(Run, InconsistentStartIsReportedPerJointAndRow) {
  std::string warnings;
  const RunResult result =
      simulate(scene_of(with(pendulum, "[0.5, 0]", "[0.5, 0.25]\nvelocity = [3, 0]")), {}, warnings);
  EXPECT_EQ(warnings,
            "test.toml:9:1: warning: the start violates revolute \"pivot\": C2 = -0.25, Cdot1 = -3\n"
            "    9 | [[joint]]\n"
            "      | ^^^^^^^^^\n"
            "  fix: correct the pose or velocity, or set project = true\n");
  EXPECT_NEAR(result.worst_error, 0.25, 1e-12);  // the steps close the joint
  EXPECT_EQ(result.worst_error_time, 0);
  EXPECT_EQ(result.time, 1);
}

// A spring between a post and the ground moves nothing, and has no joint whose start it could violate.
TEST(Run, ASpringBetweenPostsIsNoInconsistency) {
  const std::string post = "[[body]]\nname = \"post\"\nstatic = true\nposition = [2, 0]\n";
  const std::string spring = "[[spring]]\nbodies = [\"post\", \"world\"]\nstiffness = 1\nrest = 1\n";
  std::string warnings;
  const RunResult result = simulate(scene_of(std::string(pendulum) + post + spring), {}, warnings);
  EXPECT_EQ(warnings, "");
  EXPECT_EQ(failure(scene_of(pendulum), result), "");
}

// Two pins 1.25 m apart hold a rod at points 1 m apart. To project is no fix where the scene does so.
TEST(Run, AProjectionInVainIsNoAdvice) {
  std::string warnings;
  const std::string other =
      "[[joint]]\nname = \"other\"\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\npa = [1.25, 0]\npb = [0.5, "
      "0]\n";
  simulate(scene_of("project = true\n" + std::string(pendulum) + other), {}, warnings);
  EXPECT_NE(warnings.find("the start violates revolute \"other\""), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("  fix: correct the pose or velocity\n"), std::string::npos) << warnings;
}

// The hinge stands 0.25 rad outside its limit; the rope is 0.3 m too long. Both are told with place and amount and fail
// the run, and the projection that the message advises mends them.
TEST(Run, AStartBeyondAnEndIsReportedAndFails) {
  const auto is_told = [](const std::string& text, const std::string& end, const std::string& amount) {
    std::string warnings;
    Scene scene = scene_of(text);
    const std::string failed = failure(scene, simulate(scene, {}, warnings));
    EXPECT_NE(warnings.find("the start passes " + end + " by " + amount + " (m or rad)"), std::string::npos)
        << warnings;
    EXPECT_EQ(failed.find(end + " is passed by " + amount + " at t = 0 s, above the tolerance of 0.01"), 0u) << failed;
    scene.project = true;
    warnings.clear();
    EXPECT_EQ(failure(scene, simulate(scene, {}, warnings)), "");
    EXPECT_EQ(warnings, "");
  };
  is_told(with(pendulum, "[[joint]]", "[[joint]]\nangle.limit = [0.25, 1]"), "an end of `limit` of revolute \"pivot\"",
          "0.25");
  is_told(std::string(pendulum) +
              "[[joint]]\nname = \"line\"\ntype = \"tearing_rope\"\nbodies = [\"world\", \"rod\"]\n"
              "pa = [0.5, 0.9]\npb = [0, 0]\nl = 0.6\nstrength = 1e9\n",
          "an end of tearing_rope \"line\"", "0.3");
}

// In one step of 0.2 s the piston goes on to a negative length, where a gas has no energy.
TEST(Run, AnEffectWithoutEnergyIsNamed) {
  const Scene scene = scene_of(R"(
gravity = [0, 0]
duration = 0.2
step = 0.2
integrator = "euler"
[[body]]
name = "piston"
mass = 1
inertia = 1
position = [1, 0]
velocity = [-10, 0]
[[joint]]
type = "prismatic"
bodies = ["piston", "world"]
pa = [0, 0]
pb = [0, 0]
t = { world = [0, 1] }
slide.gas_spring = { F = 1e-6, rest = 1 }
)");
  std::string warnings;
  EXPECT_EQ(failure(scene, simulate(scene, {}, warnings))
                .find("an effect `gas_spring` has no energy at the pose of t = "
                      "0.2 s. Likely fix: a limit"),
            0u)
      << failure(scene, simulate(scene, {}, warnings));
}

// A wheel stands where its angle jumps by a turn, and the row is off by more than half a turn. A pose satisfies it.
TEST(Run, AGearThatStartsATurnOffIsNoContradiction) {
  const Scene scene = scene_of(R"(
dimension = 3
duration = 0.1
step = 0.01
[[body]]
name = "a"
mass = 532.7
inertia = 0.185
orientation = [-0.6955410621613091, -0.08749382829420078, 0.7129629143681643, -0.015853819527068654]
[[body]]
name = "b"
mass = 70.5
inertia = [[0.0197, -0.0039, 0.0075], [-0.0039, 0.0253, 0.006], [0.0075, 0.006, 0.0199]]
orientation = [0.6404103156958032, -0.3584163729715481, 0.24894078167924058, 0.6320133055191562]
[[joint]]
name = "teeth"
type = "gear"
bodies = ["a", "b"]
fa = [[0.8515218137089237, 0.44521080749632763, -0.2769439251298588], [0.2454232586687331, 0.12831742582655306, 0.9608860818711379]]
fb = [[0.6976828778569025, 0.2454471511631597, 0.6730485315418249], [-0.17664793495985087, 0.9694099731207065, -0.17041071295118526]]
ga = [[-0.205042214108906, -0.15541670075282576, 0.9663350037954869], [-0.5442148224471061, -0.8025139461764014, -0.24454364277413604]]
gb = [[-0.0885444043858149, 0.7322190351260082, 0.6752889552266488], [0.9960722305395134, 0.06508955511195388, 0.06002883776458309]]
ratio = 2.9677753944961407
phi = 8.541431651279963
)");
  const std::vector<Inconsistency> off = build_world_in<Spatial<double>>(scene).inconsistencies(1e-6);
  ASSERT_EQ(off.size(), 1u);
  EXPECT_LT(off.front().value, -std::numbers::pi * 2.9);
}

// Floats have no digits left for 0.1 m at 1e7 m: the poses of this scene are relative to a point among its bodies.
TEST(Run, FarFromTheOriginPosesKeepTheirDigits) {
  const Scene scene =
      scene_of(with(with(pendulum, "[0.5, 0]", "[10000000.5, -3e7]"), "pa = [0, 0]", "pa = [1e7, -3e7]"));
  const World<float> world = build_world<float>(scene);
  EXPECT_LT(std::abs(world.pose(0).x), 1);
  EXPECT_LT(std::abs(world.pose(0).y), 1);
  EXPECT_EQ(world.place(0).x, 10000000.5);
  EXPECT_EQ(world.place(0).y, -3e7);
}

// A chain with an inconsistent start gets one short warning, not one per link.
TEST(Run, OfManyInconsistentJointsTheFirstAreReported) {
  const std::string links =
      with(with(pendulum, "[[body]]", "[[body]]\nrepeat = 40"), "[[joint]]", "[[joint]]\nrepeat = 40");
  const Scene scene = scene_of(
      with(with(with(with(links, "\"rod\"", "\"rod{i}\""), "\"pivot\"", "\"pivot{i}\""), "\"rod\"]", "\"rod{i}\"]"),
           "[0.5, 0]", "[0.5, 0.25]"));
  std::string warnings;
  simulate(scene, {}, warnings);
  std::size_t told = 0;
  for (std::size_t at = 0; (at = warnings.find("the start violates revolute", at)) != std::string::npos; ++at) ++told;
  EXPECT_EQ(told, 5u) << warnings;
  EXPECT_NE(warnings.find("\"pivot5\""), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("warning: the start violates 35 more joints\n"), std::string::npos) << warnings;
}

TEST(Run, ProjectionMakesTheStartConsistent) {
  Scene scene = scene_of(with(pendulum, "[0.5, 0]", "[0.5, 0.25]\nvelocity = [3, 1]"));
  scene.project = true;
  std::string warnings;
  std::vector<Frame> rows;
  RunOptions options;
  options.row = [&](const Frame& frame) { rows.push_back(frame); };
  const RunResult result = simulate(scene, options, warnings);
  EXPECT_EQ(warnings, "");
  EXPECT_LT(result.worst_error, 1e-9);
  EXPECT_LT(rows.front().worst.value, 1e-9);
  const BodyState& rod = rows.front().bodies[0];
  EXPECT_NEAR(std::hypot(rod.x, rod.y), 0.5, 1e-9);       // on its pin
  EXPECT_NEAR(rod.x * rod.vx + rod.y * rod.vy, 0, 1e-9);  // rotating about the pin
  EXPECT_NEAR(rod.vx, -rod.w * rod.y, 1e-9);
  EXPECT_NEAR(rod.vy, rod.w * rod.x, 1e-9);
}

TEST(Run, ContradictingJointsAreReported) {
  Scene scene = scene_of(std::string(pendulum) +
                         "[[joint]]\nname = \"other\"\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\n"
                         "pa = [3, 0]\npb = [0.5, 0]\n");
  scene.project = true;
  std::string warnings;
  simulate(scene, {}, warnings);
  EXPECT_NE(warnings.find("could not be projected"), std::string::npos) << warnings;
}

TEST(Run, JointErrorBeyondToleranceIsAFailure) {
  Scene scene = scene_of(pendulum);
  scene.settings.drift = Drift::none;
  scene.step = 0.02;
  scene.tolerance = 1e-4;
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  EXPECT_GT(result.worst_error, 1e-4);
  EXPECT_EQ(result.worst_joint, "pivot");
  EXPECT_NE(failure(scene, result), "");
  scene.tolerance = 10;
  EXPECT_NE(failure(scene, result).find("the method lost"), std::string::npos) << failure(scene, result);
  scene.energy_tolerance = 1;
  EXPECT_EQ(failure(scene, result), "");
}

// A spring far too stiff for an explicit force: the run ends before the state becomes infinite or NaN, and reports it.
TEST(Run, NotFiniteEndsTheRun) {
  Scene scene = scene_of(
      "gravity = [0, 0]\nstep = 1\nduration = 5000\nintegrator = \"rattle\"\n[[body]]\nname = \"ball\"\nmass = 1\n"
      "shape = { disc = 1 }\n"
      "position = [1, 0]\n[[spring]]\nbodies = [\"world\", \"ball\"]\nstiffness = 1e6\nrest = "
      "0.5\n");
  std::string warnings;
  const RunResult result = simulate(scene, {}, warnings);
  ASSERT_TRUE(result.failed_step);
  EXPECT_EQ(result.failed_step->problem, StepProblem::not_finite);
  EXPECT_TRUE(result.finite);
  EXPECT_LT(result.time, 5000);
  EXPECT_NE(failure(scene, result).find("infinite or NaN"), std::string::npos);
}

TEST(Run, StaticJointIsNoted) {
  std::string warnings;
  const RunResult result =
      simulate(read_scene((source_dir() / "tests/hard_cases/both_immovable/planar.toml").string()), {}, warnings);
  EXPECT_EQ(result.notes, std::vector<std::string>{"joint \"idle\" connects only immovable bodies and does nothing"});
}

// Nothing moves, so nothing is wrong: no step, no doubt about the accuracy.
TEST(Run, ASceneThatCannotMoveReachesItsAccuracy) {
  std::string warnings;
  const Scene scene = scene_of("[[body]]\nname = \"wall\"\nstatic = true\n");
  const RunResult result = simulate(scene, {}, warnings);
  ASSERT_TRUE(result.choice);
  EXPECT_TRUE(result.choice->reached);
  EXPECT_LE(result.choice->achieved, 1e-4);
  EXPECT_EQ(result.counts.taken, 0);
}

TEST(Frames, CubicBetweenStepsIsExactForCubics) {
  const auto at = [](double t) {
    Frame frame;
    frame.time = t;
    frame.bodies.push_back({t * t * t - t, 2 - t * t, t, 3 * t * t - 1, -2 * t, 1});
    return frame;
  };
  const Frame middle = between(at(1), at(1.5), 1.2);
  EXPECT_NEAR(middle.bodies[0].x, 1.2 * 1.2 * 1.2 - 1.2, 1e-14);
  EXPECT_NEAR(middle.bodies[0].y, 2 - 1.2 * 1.2, 1e-14);
  EXPECT_NEAR(middle.bodies[0].angle, 1.2, 1e-14);
  EXPECT_EQ(middle.time, 1.2);
}

TEST(Frames, EveryReachesTheEnd) {
  EXPECT_EQ(every(0.1, 0.3).size(), 4u);
  EXPECT_EQ(every(0.1, 0.35).size(), 4u);
  EXPECT_EQ(every(1.0 / 3, 1).size(), 4u);
  EXPECT_EQ(every(2, 1).size(), 1u);
}

}  // namespace
}  // namespace cdot::test::run_test
