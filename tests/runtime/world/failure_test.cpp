// A failed step restores the World and reports place and cause. The World refuses numbers that are not finite.
#include <fmt/format.h>
#include <limits>

#include "tests/methods.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {

extern long allocations;  // counting_new.cpp

namespace {

void expect_same_state(const Snapshot& before, const Snapshot& after, const std::string& name) {
  EXPECT_EQ(after.differences(before), std::vector<std::string>{}) << name;
}

template <class S>
typename S::Wrench huge() {
  typename S::Wrench force{};
  force.force_x = 0.9 * double(std::numeric_limits<typename S::Scalar>::max());
  return force;
}

template <class T>
int build(World<T>& world) {
  const auto rods = add_chain(world, 5, -0.4);
  add_motor(world, 1, "angle", {.speed = 1, .max_force = 2});
  add_limit(world, 2, "angle", {.lower = -0.1, .upper = 0.1});
  BodyDefinition light = rod(0, 5, 0);
  light.mass = 0.01;
  const int body = world.add_body(light);
  revolute(world, world.ground(), body, 0, 5, -0.5, 0);
  add_chain(world, 2, 0.3);
  return body;
}

template <class T>
int build(SpatialWorld<T>& world) {
  add_free_mechanism(world);
  SpatialBodyDefinition light = brick(0, 5, 0, 0.01);
  const int body = world.add_body(light);
  const int hinge = join(world, "hinge", world.ground(), body, {{"pa", {0, 5, 0.3}}, {"fa", {0, 0, 1}}});
  add_motor(world, hinge, "angle", {.speed = 20, .max_force = 0.1});
  return body;
}

// An infinite impulse times the inverse mass 0 of the ground is NaN, which no step would ever take away.
template <class S>
void expect_that_the_ground_stands(BasicWorld<S>& world, const std::string& name) {
  typename S::Scalar numbers[S::freedom];
  S::write(world.velocity(world.ground()), numbers);
  for (const auto number : numbers) EXPECT_EQ(number, 0) << name;
}

// The acceleration overflows, so the step fails in the second of three islands. After the removal of the force the run
// has the bits of one without the failure.
template <class S>
void check_a_failure(const Settings& settings, const std::string& name) {
  BasicWorld<S> world(settings), spared(settings);
  const int body = build(world);
  build(spared);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(world.step(0.005)) << name;
    spared.step(0.005);
  }
  const Snapshot before = world.snapshot();
  world.set_force(body, huge<S>());
  spared.set_force(body, {});
  world.prepare();
  const Snapshot pushed = world.snapshot();
  const long made = allocations;
  const StepResult result = world.step(0.005);
  EXPECT_EQ(allocations - made, 0);
  EXPECT_FALSE(result) << name;
  EXPECT_EQ(result.problem, StepProblem::not_finite);
  EXPECT_EQ(result.island, 1);
  EXPECT_EQ(result.body, body);
  EXPECT_EQ(world.joint_bodies(result.joint)[1], body);
  EXPECT_EQ(result.time, world.time());
  expect_same_state(pushed, world.snapshot(), name);
  expect_that_the_ground_stands(world, name);
  EXPECT_FALSE(world.step(0.005));
  world.set_force(body, {});
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(world.step(0.005)) << name;
    spared.step(0.005);
  }
  EXPECT_EQ(world.snapshot().differences(spared.snapshot()), std::vector<std::string>{}) << name;
}

template <class S>
void check_failures() {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.substeps = 2;
  for_each_method(s, [](const Settings& method, const std::string& name) { check_a_failure<S>(method, name + " "); });
}

TEST(Failure, LeavesTheStateInThePlane) {
  check_failures<Planar<double>>();
  check_failures<Planar<float>>();
}
TEST(Failure, LeavesTheStateInSpace) {
  check_failures<Spatial<double>>();
  check_failures<Spatial<float>>();
}

// A joint breaks in the first part of the step. The second part fails, because the place of a body is no double. The
// rollback restores the joint, and the run has the bits of one without the failure.
TEST(Failure, RestoresAJointThatBrokeInTheSameStep) {
  for (const Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::rk4}) {
    Settings s = settings(Solver::direct, Drift::projection, -9.81);
    s.integrator = integrator;
    const auto made = [](const Settings& method) {
      World<double> world(method);
      add_chain(world, 4, 0);
      add_limit(world, 1, "angle", {.lower = -1, .upper = 1});
      world.add_body({.x = 1.79e308, .y = -1.7e308, .vx = 1e308, .mass = 1, .inertia = 1});
      world.prepare();
      for (int joint : {1, 2}) set_breaking_load(world, joint, 1e-3);  // set when the World is already prepared
      return world;
    };
    World<double> half = made(s);
    EXPECT_TRUE(half.step(0.005));
    ASSERT_NE(half.broken(1), half.broken(2));  // without the first one the other carries nothing
    s.substeps = 2;
    World<double> world = made(s), spared = made(s);
    const Snapshot before = world.snapshot();
    const StepResult result = world.step(0.01);
    EXPECT_EQ(result.problem, StepProblem::not_finite);
    EXPECT_EQ(result.island, 1);
    EXPECT_FALSE(world.broken(1) || world.broken(2));
    expect_same_state(before, world.snapshot(), "breaking");
    for (World<double>* one : {&world, &spared}) {
      one->set_velocity(5, {});
      EXPECT_TRUE(one->step(0.01));
    }
    EXPECT_NE(world.broken(1), world.broken(2));
    expect_same_state(spared.snapshot(), world.snapshot(), "after breaking");
  }
}

TEST(Failure, IsDescribedInWords) {
  World<double> world(settings(Solver::direct));
  const int body = build(world);
  world.set_force(body, huge<Planar<double>>());
  const StepResult result = world.step(0.01);
  EXPECT_EQ(
      in_words(result, "the arm", "joint 5 (revolute)"),
      "the step of 0.01 s at t = 0 s failed in island 1: a pose or velocity became infinite or NaN; look at joint 5 "
      "(revolute), row 1; the arm moved fastest");
  EXPECT_FALSE(world.step(0));
  EXPECT_FALSE(world.step(-1));
  const StepResult none = world.step(std::nan(""));
  EXPECT_EQ(none.problem, StepProblem::bad_step);
  EXPECT_EQ(in_words(none, "", ""), "a step of nan s is impossible");
  EXPECT_EQ(world.time(), 0);
}

// A gas spring has no energy, and no force, on a slide below 0. The rail is to blame, not the joint that comes first.
TEST(Failure, BlamesAnEffectWithoutAnEnergy) {
  World<double> world(settings(Solver::direct));
  const int wheel = world.add_body(rod(0, 5, 0)), body = world.add_body({.x = 2, .mass = 1, .inertia = 1});
  revolute(world, world.ground(), wheel, 0, 5, 0, 0);
  const int rail =
      world.add_joint({"prismatic", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
  world.add_joint({"distance", {wheel, body}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}});
  const double sign = world.coordinate(rail, "slide") > 0 ? 1 : -1;
  world.set_pose(body, {2 * sign, 0, 0});
  add_effect(world, rail, "slide", SpecEffect{"gas_spring", {{"F", {3}}, {"rest", {1}}}});
  EXPECT_TRUE(world.step(0.001));
  world.set_pose(body, {-2 * sign, 0, 0});
  const StepResult result = world.step(0.001);
  EXPECT_EQ(result.problem, StepProblem::not_finite);
  EXPECT_EQ(result.joint, rail);
}

// --- arguments that are not finite ---

template <class F>
void refused(F f, const char* why) {
  try {
    f();
    ADD_FAILURE() << "accepted: " << why;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

TEST(Failure, NumbersThatAreNotFiniteAreRefused) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {inf, -inf, std::nan(""), 1e300}) {
    World<float> world(settings(Solver::direct));
    const int body = world.add_body(rod(0, 0, 0));
    const auto before = world.hash();
    refused([&] { world.set_pose(body, {bad, 0, 0}); }, "pose must be finite");
    refused([&] { world.set_pose(body, {0, 0, bad}); }, "pose must be finite");
    refused([&] { world.set_velocity(body, {0, bad, 0}); }, "velocity must be finite");
    refused([&] { world.apply_impulse(body, {0, 0, bad}); }, "impulse must be finite");
    refused([&] { world.set_force(body, {.torque = bad}); }, "force must be finite");
    refused([&] { world.add_body({.x = bad, .mass = 1}); }, "finite");
    refused([&] { world.add_body({.mass = 1, .force_y = bad}); }, "every number of a body must be finite");
    EXPECT_EQ(world.hash(), before);
    EXPECT_EQ(world.body_count(), 1);
    SpatialWorld<float> space(settings(Solver::direct));
    space.add_body(brick(0, 0, 0));
    refused([&] { space.set_pose(0, {0, 0, bad}); }, "pose must be finite");
    refused([&] { space.set_pose(0, {0, 0, 0, 0, 0, 0, 0}); }, "not the zero quaternion");
    refused([&] { space.set_velocity(0, {0, 0, 0, 0, 0, bad}); }, "velocity must be finite");
  }
  World<float> world(settings(Solver::direct));
  refused([&] { world.add_body({.mass = 1e-39}); }, "too small");
  refused([&] { world.add_body({.mass = 1, .inertia = 1e-39}); }, "too small");
  refused([&] { world.add_body({.mass = 1e46}); }, "too large");
  World<double> doubles(settings(Solver::direct));
  doubles.add_body({.mass = 1e-39});
}

}  // namespace
}  // namespace cdot::test
