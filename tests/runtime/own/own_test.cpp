// Joints and effects without a compiler move as compiled ones, bit for bit: all of the catalogue, by all methods.
#include "runtime/own/own.hpp"

#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

#include <cdot/balance.hpp>
#include <cdot/integrators.hpp>

#include "derive/own/own_kernel.hpp"
#include "runtime/own/check_own.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

namespace fs = std::filesystem;

struct Method {
  const char* name;
  Settings settings;
};

std::vector<Method> methods() {
  std::vector<Method> list = {{"euler", settings(Solver::direct, Drift::projection, -9.81)},
                              {"sweeps", settings(Solver::iterative, Drift::projection, -9.81)},
                              {"soft sweeps", settings(Solver::iterative, Drift::soft, -9.81)}};
  for (const Integrator integrator : {Integrator::implicit, Integrator::rattle, Integrator::rk4, Integrator::radau5}) {
    list.push_back(list.front());
    list.back().settings.integrator = integrator;
    list.back().name = "another integrator";
  }
  for (const Kernels kernels : {Kernels::fast, Kernels::robust}) {
    list.push_back({"sweeps of other kernels", settings(Solver::iterative, Drift::projection, -9.81)});
    list.back().settings.kernels = kernels;
  }
  return list;
}

void place(planar::Pose<double>*, BodyDefinition& d, int k) { d.angle = 0.4 * k - 0.3; }
void place(spatial::Pose<double>*, SpatialBodyDefinition& d, int k) {
  d.e0 = 1, d.e1 = 0.1 * k, d.e2 = 0.2 - 0.1 * k, d.e3 = 0.3;
}

// The poses and velocities after some steps, or the step that failed.
template <class S>
std::vector<double> run_of(const std::string& type, const JointType& info, const Settings& settings, bool grounded) {
  BasicWorld<S> world(settings);
  std::vector<int> bodies;
  for (int k = 0; k < info.bodies; ++k) {
    typename S::BodyDefinition d;
    d.x = 0.7 * k, d.y = 0.3 - 0.2 * k + 0.1 * k * k, d.mass = 1 + k, d.vx = 0.2 - 0.1 * k;
    place(static_cast<typename S::InDoubles::Pose*>(nullptr), d, k);
    bodies.push_back(grounded && k + 1 == info.bodies && k > 0 ? world.ground() : world.add_body(d));
  }
  const int joint = world.add_joint({type, bodies, some_values(info), {}});
  std::vector<double> numbers;
  for (int k = 0; k < 12; ++k) {
    if (!world.step(0.004)) return numbers.push_back(k), numbers;
    for (const int body : bodies) {
      const auto pose = world.pose(body);
      const auto velocity = world.velocity(body);
      for (std::size_t i = 0; i < sizeof pose / sizeof(typename S::Scalar); ++i)
        numbers.push_back(double(reinterpret_cast<const typename S::Scalar*>(&pose)[i]));
      for (std::size_t i = 0; i < sizeof velocity / sizeof(typename S::Scalar); ++i)
        numbers.push_back(double(reinterpret_cast<const typename S::Scalar*>(&velocity)[i]));
    }
  }
  for (std::size_t c = 0; c < info.coordinates.size(); ++c)
    numbers.push_back(world.coordinate(joint, info.coordinates[c].name));
  for (const WorkOfSource& of : world.work_by_source()) numbers.push_back(of.work);
  return numbers;
}

// `run` of the compiled type and of its own one, by every method. Returns how many runs came to their end.
template <class S, class Run>
int expect_same_runs(const std::string& compiled, const std::string& own, Run run) {
  int ended = 0;
  for (const Method& method : methods()) {
    if (std::is_same_v<typename S::Scalar, float> && method.settings.integrator != Integrator::euler) continue;
    for (const bool grounded : {false, true}) {
      const std::vector<double> a = run(compiled, method.settings, grounded);
      const std::vector<double> b = run(own, method.settings, grounded);
      EXPECT_EQ(a.size(), b.size()) << compiled << " by " << method.name;
      if (a.size() == b.size()) {
        EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0) << compiled << " by " << method.name;
      }
      ended += a.size() > 1;
    }
  }
  return ended;
}

template <class S>
int expect_same_joints(const std::string& compiled, const std::string& own) {
  const JointType& info = *find_joint_type(S::dimension, compiled);
  return expect_same_runs<S>(compiled, own, [&](const std::string& type, const Settings& settings, bool grounded) {
    return run_of<S>(type, info, settings, grounded);
  });
}

// Two rods on pins, or a block on a rail, with the effect on the first joint.
template <class S>
std::vector<double> run_on_coordinate(const SpecEffect& effect, bool of_turn, const Settings& settings, bool loaded) {
  BasicWorld<S> world(settings);
  const bool planar = S::dimension == Dimension::planar;
  const std::string type = of_turn ? (planar ? "revolute" : "hinge") : (planar ? "prismatic" : "slider");
  std::vector<int> bodies = {world.ground()}, joints;
  for (int k = 0; k < 2; ++k) {
    typename S::BodyDefinition d;
    d.x = 1 + k, d.y = 0.2 * k, d.mass = 1 + k, d.vx = loaded ? 0.5 : 0, d.vy = 0.4;
    bodies.push_back(world.add_body(d));
    joints.push_back(world.add_joint({type,
                                      {bodies[static_cast<std::size_t>(k)], bodies.back()},
                                      some_values(*find_joint_type(S::dimension, type)),
                                      {}}));
  }
  const std::string coordinate = of_turn ? "angle" : "slide";
  if (find_coordinate_effect(effect.type)->acts_on_joint()) add_effect(world, joints[0], effect);
  else add_effect(world, joints[0], coordinate, effect);
  std::vector<double> numbers;
  for (int k = 0; k < 25; ++k) {
    if (!world.step(0.004)) return numbers.push_back(k), numbers;
    for (const int joint : joints) numbers.push_back(world.broken(joint) + world.coordinate(joint, coordinate));
    numbers.push_back(world.energy());
  }
  for (const WorkOfSource& of : world.work_by_source()) numbers.push_back(of.work);
  return numbers;
}

template <class S>
int expect_same_on_coordinate(const std::string& compiled, const std::string& own) {
  const JointType& info = *find_coordinate_effect(compiled);
  std::vector<NamedValue> values;
  for (std::size_t k = 0; k < info.parameters.size(); ++k)
    if (info.coordinate_uses[k] == CoordinateUse::required)
      values.push_back({std::string(info.parameters[k].name), {info.parameters[k].name == "lower" ? -0.01 : 0.02}});
  return expect_same_runs<S>(compiled, own, [&](const std::string& type, const Settings& settings, bool loaded) {
    return run_on_coordinate<S>({type, values}, info.acts_on("rad"), settings, loaded);
  });
}

class InFolder : public testing::TestWithParam<const char*> {};

TEST_P(InFolder, EveryJointMovesAsCompiled) {
  const std::string folder = GetParam();
  int joints = 0, effects = 0, runs = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(CDOT_SOURCE_DIR "/specs") / folder)) {
    const bool is_effect = entry.path().extension() == ".effect";
    if (entry.path().extension() != ".joint" && !is_effect) continue;
    const std::string compiled = entry.path().stem().string();
    const OwnType own = add_own_type(entry.path().string());
    ASSERT_FALSE(own.name.empty()) << own.problems;
    ++(is_effect ? effects : joints);
    EXPECT_TRUE(own.name.starts_with(compiled + "#")) << own.name;
    runs += folder == "planar" ? expect_same_joints<Planar<double>>(compiled, own.name) +
                                     expect_same_joints<Planar<float>>(compiled, own.name)
                               : expect_same_joints<Spatial<double>>(compiled, own.name) +
                                     expect_same_joints<Spatial<float>>(compiled, own.name);
  }
  fmt::print("{}: {} joints and {} effects in {} runs\n", folder, joints, effects, runs);
  EXPECT_GT(joints, 20);
  EXPECT_GT(effects, 10);
  EXPECT_GT(runs, 10 * (joints + effects));
}

// Effects on the coordinate of any joint: those of specs/coordinate.
TEST(Own, EveryEffectOnACoordinateActsAsCompiled) {
  int effects = 0, runs = 0;
  for (const auto& entry : fs::directory_iterator(CDOT_SOURCE_DIR "/specs/coordinate")) {
    const std::string compiled = entry.path().stem().string();
    const OwnType own = add_own_type(entry.path().string());
    ASSERT_EQ(own.name, compiled + "#2") << own.problems;
    EXPECT_FALSE(own.has_bodies);
    ++effects;
    runs += expect_same_on_coordinate<Planar<double>>(compiled, own.name) +
            expect_same_on_coordinate<Planar<float>>(compiled, own.name) +
            expect_same_on_coordinate<Spatial<double>>(compiled, own.name);
  }
  fmt::print("{} effects in {} runs\n", effects, runs);
  EXPECT_GT(effects, 10);
  EXPECT_GT(runs, 20 * effects);
}

// Effects that the build compiled into this program (cdot_add_joints): on coordinates, on the coordinates of the
// effect's own bodies too, and on a joint itself. They act as those of the catalogue.
TEST(Own, EffectsOfAProgramActOnCoordinates) {
  for (const std::string compiled : {"burning", "creeping_grip", "pull_back"}) {
    const JointType* const info = find_coordinate_effect(compiled);
    ASSERT_TRUE(info) << compiled;
    const OwnType own = add_own_type(CDOT_SOURCE_DIR "/tests/runtime/own/specs/" + compiled + ".effect");
    ASSERT_EQ(own.name, compiled + "#2") << own.problems;
    const int runs = expect_same_on_coordinate<Planar<double>>(compiled, own.name) +
                     expect_same_on_coordinate<Planar<float>>(compiled, own.name) +
                     expect_same_on_coordinate<Spatial<double>>(compiled, own.name);
    EXPECT_GT(runs, 20) << compiled;
  }
  EXPECT_TRUE(find_joint_type(Dimension::planar, "pull_back")) << "it acts between bodies, too";
}

// A weight on a cord that burns: its strength of 101 N falls to the weight of 20 N after 0.802 s.
World<double> weight_on_a_cord(const Settings& settings, const std::string& burning = "burning") {
  World<double> world(settings);
  BodyDefinition d;
  d.y = -1, d.mass = 2, d.inertia = 1;
  const int weight = world.add_body(d);
  const int cord = world.add_joint({"distance", {weight, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}});
  add_effect(world, cord, SpecEffect{burning, {{"strength", {101}}, {"life", {1}}}});
  return world;
}

TEST(Own, AJointBreaksByAnEffectOfAProgram) {
  World<double> world = weight_on_a_cord(settings(Solver::direct, Drift::projection, -10));
  for (int k = 1; k <= 90; ++k) {
    world.step(0.01);
    EXPECT_EQ(world.broken(0), k >= 81) << k;
  }
  Settings located = settings(Solver::direct, Drift::projection, -10);
  located.integrator = Integrator::dop853;
  World<double> falls = weight_on_a_cord(located);
  for (int k = 0; k < 9; ++k) falls.step(0.1);
  EXPECT_NEAR(falls.velocity(0).y, -10 * (0.9 - (1 - 20.0 / 101)), 1e-8);
}

// Two effects with the same numbers are two mechanisms.
TEST(Own, ASnapshotKnowsWhichEffectBreaksAJoint) {
  const Settings direct = settings(Solver::direct, Drift::projection, -10);
  const OwnType other = add_own_type(CDOT_SOURCE_DIR "/tests/runtime/own/specs/burning.effect");
  World<double> world = weight_on_a_cord(direct);
  EXPECT_NO_THROW(world.restore(weight_on_a_cord(direct).snapshot()));
  EXPECT_THROW(world.restore(weight_on_a_cord(direct, other.name).snapshot()), Error);
}

INSTANTIATE_TEST_SUITE_P(Own, InFolder, testing::Values("planar", "spatial"));

// A motor acts on the coordinate of a joint without a compiler, in the plane and beyond half a turn in space.
TEST(Own, EffectsActOnItsCoordinates) {
  const auto turned = [](const std::string& type) {
    BasicWorld<Spatial<double>> world{Settings{}};
    SpatialBodyDefinition d;
    d.mass = 1, d.inertia = {1, 1, 1};
    const int body = world.add_body(d);
    const int joint =
        world.add_joint({type, {world.ground(), body}, {{"pa", {0, 0, 0}}, {"fa", {1, 0, 0, 0, 1, 0}}}, {}});
    add_motor(world, joint, "angle", {2.0, 50.0});
    for (int k = 0; k < 400; ++k) world.step(0.01);
    return world.coordinate(joint, "angle");
  };
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/specs/spatial/hinge.joint");
  ASSERT_EQ(own.problems.find("error"), std::string::npos) << own.problems;
  EXPECT_GT(turned("hinge"), 7);
  EXPECT_EQ(turned("hinge"), turned(own.name));
}

// Two wheels on hinges, geared 1 : -2, which a motor turns by 20 rad: the parameters of the gear count the turns, as
// does its own coordinate under a limit. They agree bit for bit with those of the compiled gear.
std::vector<double> turned_by_gear(const std::string& gear, const Settings& settings) {
  BasicWorld<Spatial<double>> world(settings);
  std::vector<int> wheels, hinges;
  for (int k = 0; k < 2; ++k) {
    SpatialBodyDefinition d;
    d.x = k, d.mass = 1, d.inertia = {1, 1, 2};
    wheels.push_back(world.add_body(d));
    hinges.push_back(world.add_joint(
        {"hinge", {world.ground(), wheels.back()}, {{"pa", {double(k), 0, 0}}, {"fa", {0, 0, 1, 1, 0, 0}}}, {}}));
  }
  const NamedValue axes[] = {{"fa", {0, 0, 1, 1, 0, 0}}, {"fb", {0, 0, 1, 1, 0, 0}}, {"ratio", {2}}};
  const int joint = world.add_joint({gear, wheels, {axes[0], axes[1], axes[2]}, {}});
  add_motor(world, hinges[0], "angle", {10.0, 50.0});
  add_limit(world, joint, "angle_a", {.lower = -1, .upper = 15});
  for (int k = 0; k < 400; ++k)
    if (!world.step(0.005)) return {};
  return {world.coordinate(hinges[0], "angle"), world.coordinate(hinges[1], "angle"),
          world.coordinate(joint, "angle_a"), world.coordinate(joint, "angle_b")};
}

TEST(Own, AGearCountsItsTurns) {
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/specs/spatial/gear.joint");
  ASSERT_FALSE(own.name.empty()) << own.problems;
  for (const Method& method : methods()) {
    const std::vector<double> turned = turned_by_gear(own.name, method.settings);
    ASSERT_EQ(turned.size(), 4) << method.name;
    EXPECT_NEAR(turned[0], 15, 0.05) << method.name;  // stopped by the limit, beyond two turns
    EXPECT_NEAR(std::remainder(turned[0] + 2 * turned[1], 4 * M_PI), 0, 0.05)
        << method.name;  // of b: within half a turn
    EXPECT_EQ(turned, turned_by_gear("gear", method.settings)) << method.name;
  }
}

// A drive far from its target pushes with its limit, and the work is that of the limited force.
TEST(Own, AForceAtItsLimitDoesTheSameWork) {
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/specs/planar/position_drive.effect");
  const auto work_of = [](const std::string& type) {
    Settings by_rk4 = settings(Solver::direct);
    by_rk4.integrator = Integrator::rk4;
    World<double> world(by_rk4);
    BodyDefinition d;
    d.mass = 1, d.inertia = 1;
    const int body = world.add_body(d);
    const int joint = world.add_joint({"revolute", {world.ground(), body}, {{"pa", {0, 0}}}, {}});
    add_effect(world, joint, "angle", SpecEffect{type, {{"k", {50}}, {"most", {0.5}}, {"target", {3}}}});
    for (int k = 0; k < 100; ++k) world.step(0.01);
    return world.work_by_source().at(0).work;
  };
  EXPECT_NEAR(work_of("position_drive"), 0.5 * 0.25, 1e-9);  // half a newton metre over a quarter of a radian in 1 s
  EXPECT_EQ(work_of("position_drive"), work_of(own.name));
}

// The energy of a spring that is stiffer where its joint is heavier changes without a force. A rod slides along a line
// by its end; the mass that the slide moves changes as the rod turns.
TEST(Own, AStiffnessByTheMassPutsInWhatItChanges) {
  const OwnType own = add_own_type(CDOT_SOURCE_DIR "/tests/runtime/own/specs/hardening.effect");
  ASSERT_EQ(own.problems, "");
  double exact = 0;
  for (const Integrator integrator : {Integrator::dop853, Integrator::rk4, Integrator::rattle, Integrator::euler}) {
    Settings by = settings(Solver::direct, Drift::projection, -9.81);
    by.integrator = integrator;
    World<double> world(by);
    const int rod = world.add_body({.x = 0.5, .mass = 1, .inertia = 1.0 / 12});
    const int line =
        world.add_joint({"line", {rod, world.ground()}, {{"pa", {-0.5, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}}, {}});
    add_effect(world, line, "slide", SpecEffect{own.name, {{"frequency", {1}}, {"a", {0.5}}, {"rest", {0.2}}}});
    BalanceWatch seen;
    for (int k = 0; k < 2000; ++k) {
      ASSERT_TRUE(world.step(1e-3));
      seen.look(world.balance());
    }
    const int order = row_of(integrator).order;
    if (exact == 0) exact = seen.last.put_in;
    EXPECT_GT(exact, 2);
    EXPECT_NEAR(seen.last.put_in, exact, order == 1 ? 0.5 : order == 2 ? 1e-2 : 1e-6) << order;
    EXPECT_LT(seen.energy.share(), order == 1 ? 0.02 : order == 2 ? 1e-4 : 1e-9) << order;
  }
}

// A second route finds a wrong derivation: here a spoiled number of J.
TEST(Own, AWrongRateIsFound) {
  const OwnReading reading = read_own_kernel(CDOT_SOURCE_DIR "/specs/planar/line.joint");
  ASSERT_TRUE(reading.kernel) << reading.problems;
  EXPECT_EQ(wrong_rate(*reading.kernel), "");
  OwnKernel spoiled = *reading.kernel;
  Tape& tape = spoiled.rows.functions[static_cast<std::size_t>(OwnFunctionName::velocity)].tape;
  const auto minus = std::ranges::find(tape.steps, Tape::Code::subtract, &Tape::Step::code);
  ASSERT_NE(minus, tape.steps.end());
  minus->code = Tape::Code::add;
  EXPECT_NE(wrong_rate(spoiled).find("row line: its derived rate is"), std::string::npos) << wrong_rate(spoiled);
}

// Likewise a wrong slope, and an energy that is not that of the force: here the sign of a term.
TEST(Own, AWrongLawIsFound) {
  const OwnReading reading = read_own_kernel(CDOT_SOURCE_DIR "/specs/planar/duffing_spring.effect");
  ASSERT_TRUE(reading.kernel) << reading.problems;
  EXPECT_EQ(wrong_law(*reading.kernel), "");
  const auto spoiled = [&](OwnFunction OwnLaw::*function) {
    OwnKernel kernel = *reading.kernel;
    for (Tape::Step& step : ((*kernel.law).*function).tape.steps)
      if (step.code == Tape::Code::add) step.code = Tape::Code::subtract;
    return wrong_law(kernel);
  };
  EXPECT_NE(spoiled(&OwnLaw::slopes).find("1 1: derived it is"), std::string::npos) << spoiled(&OwnLaw::slopes);
  EXPECT_NE(spoiled(&OwnLaw::energy).find("stored force 1: derived it is"), std::string::npos);
}

TEST(Own, AFileThatChangedIsAnotherType) {
  const fs::path file = fs::temp_directory_path() / "own_that_changes.joint";
  const auto write = [&](const char* length) {
    std::ofstream(file) << fmt::format(
        "joint own_that_changes planar\n  \"x\"\n  point pa on a\n  point pb on b\n"
        "  norm(pa - pb) = {}\n",
        length);
  };
  write("1 [m]");
  const std::string first = add_own_type(file.string()).name;
  EXPECT_EQ(first, "own_that_changes");
  EXPECT_EQ(add_own_type(file.string()).name, first);
  write("2 [m]");
  EXPECT_EQ(add_own_type(file.string()).name, "own_that_changes#2");
  fs::remove(file);
}

}  // namespace
}  // namespace cdot::test
