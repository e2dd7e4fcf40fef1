// Removes joints and changes joints and effects in a running World. It must then move like a World built that way, from
// the same poses and velocities, with every method.
#include <fmt/format.h>

#include "tests/methods.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {

extern long allocations;  // counting_new.cpp

namespace {

// Copies poses and velocities of `from` to `to`.
template <class S>
void follow(const BasicWorld<S>& from, BasicWorld<S>& to) {
  for (int body = 0; body < from.body_count(); ++body) {
    if (from.is_static(body)) continue;
    to.set_pose(body, from.place(body));
    typename S::Scalar numbers[S::freedom];
    S::write(from.velocity(body), numbers);
    double exact[S::freedom];
    std::copy_n(numbers, S::freedom, exact);
    to.set_velocity(body, S::Exact::read_velocity(exact));
  }
}

// The largest difference of their poses [m] or velocities [m/s, rad/s], by number.
template <class S>
double apart(const BasicWorld<S>& a, const BasicWorld<S>& b) {
  double worst = 0;
  const auto compare = [&](const auto& of_a, const auto& of_b, int count) {
    for (int k = 0; k < count; ++k) worst = std::max(worst, std::abs(double(of_a[k]) - double(of_b[k])));
  };
  typename S::Scalar of_a[S::pose_numbers], of_b[S::pose_numbers];
  for (int body = 0; body < a.body_count(); ++body) {
    S::write(a.pose(body), of_a), S::write(b.pose(body), of_b);
    compare(of_a, of_b, S::pose_numbers);
    S::write(a.velocity(body), of_a), S::write(b.velocity(body), of_b);
    compare(of_a, of_b, S::freedom);
  }
  return worst;
}

constexpr double dt = 0.004;

// build(world, changed) adds the same bodies in both cases; change(world) must turn the unchanged World into the
// changed one.
template <class S, class Build, class Change>
void check_change(const Settings& base, Build build, Change change) {
  Settings without_history = base;
  without_history.warm_start = false;
  without_history.iterations = 200;  // makes the result independent of the sweeps' start
  const int methods = for_each_method(without_history, [&](const Settings& s, const std::string& name) {
    BasicWorld<S> world(s), twin(s);
    build(world, false), build(twin, true);
    run(world, 25 * dt, dt);
    BasicWorld<S> unchanged(s);
    build(unchanged, false);
    for (BasicWorld<S>* each : {&world, &twin, &unchanged})
      follow(world, *each);  // a state that is not the end of a step
    change(world);
    for (BasicWorld<S>* each : {&world, &twin, &unchanged}) run(*each, 25 * dt, dt);
    // Adaptive steps begin with different lengths, and a new World has no impulses for `implicit`.
    const bool history = s.local_error > 0 || s.integrator == Integrator::implicit;
    const double tolerance = history ? 2e-3 : std::is_same_v<typename S::Scalar, double> ? 1e-8 : 1e-3;
    EXPECT_LT(apart(world, twin), tolerance) << name;
    EXPECT_GT(apart(world, unchanged), 10 * tolerance) << name << ": the change does nothing";
  });
  std::printf("%d methods\n", methods);
}

const Settings heavy = settings(Solver::direct, Drift::projection, -9.81);

Settings heavy_in_space() {
  Settings s = heavy;
  s.gravity_y = 0, s.gravity_z = -9.81;
  return s;
}

// --- a joint is removed: its island splits ---

template <class T>
void chain_without(World<T>& world, bool cut) {
  int before = world.ground();
  for (int i = 0; i < 5; ++i) {
    const int next = world.add_body(rod(i * std::cos(0.3), -i * std::sin(0.3), -0.3));
    if (i != 2 || !cut) {
      const int pin = revolute(world, before, next, i ? 0.5 : 0.0, 0, -0.5, 0);
      if (i == 2) add_motor(world, pin, "angle", {.speed = 1, .max_force = 3});
    }
    before = next;
  }
}

template <class T>
void bricks_without(SpatialWorld<T>& world, bool cut) {
  int before = world.ground();
  for (int i = 0; i < 4; ++i) {
    const int next = world.add_body(brick(i + 0.5, 0.1 * i, 0));
    const char* const type = i % 2 ? "hinge" : "spherical";
    std::vector<NamedValue> values = {{"pa", {i ? 0.5 : 0.0, 0, 0}}};
    if (i % 2) values.push_back({"fa", {0, 1, 0.2}});
    if (i != 2 || !cut) join(world, type, before, next, values);
    before = next;
  }
}

const auto remove_third = [](auto& world) { world.remove_joint(2); };

TEST(Changes, AJointRemovedIsAsIfItHadNeverBeenInThePlane) {
  check_change<Planar<double>>(heavy, chain_without<double>, remove_third);
  check_change<Planar<float>>(heavy, chain_without<float>, remove_third);
}

TEST(Changes, AJointRemovedIsAsIfItHadNeverBeenInSpace) {
  check_change<Spatial<double>>(heavy_in_space(), bricks_without<double>, remove_third);
  check_change<Spatial<float>>(heavy_in_space(), bricks_without<float>, remove_third);
}

TEST(Changes, AJointRemovedIsNoMoreAndCanBeNamed) {
  World<double> world(heavy);
  add_chain(world, 3, 0.3);
  run(world, 0.1, 0.01);
  EXPECT_EQ(world.island_count(), 1);
  world.remove_joint(1);
  world.remove_joint(1);  // no effect the second time
  EXPECT_TRUE(world.broken(1));
  EXPECT_FALSE(world.broken(0) || world.broken(2));
  run(world, 0.1, 0.01);
  EXPECT_EQ(world.island_count(), 2);
  for (double impulse : world.impulse(1)) EXPECT_EQ(impulse, 0);
}

// A spring of rest length 0 is two joints: a soft pin, and a damper along its direction.
TEST(Changes, ASpringWithoutLengthGoesWithItsDamper) {
  World<double> world;
  const int body = world.add_body({.x = 1, .vx = 2, .mass = 1, .inertia = 1});
  const int spring =
      world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = 5, .rest_length = 0, .damping = 3});
  run(world, 0.1, 0.01);
  const double speed = world.velocity(body).x;
  EXPECT_LT(speed, 1.8);
  world.remove_joint(spring);
  run(world, 0.1, 0.01);
  EXPECT_EQ(world.velocity(body).x, speed);
}

// --- new numbers for every effect at once ---

template <class T>
void with_effects(World<T>& world, bool other) {
  add_chain(world, 5, -0.4);
  const int apart = world.add_body(rod(0, 9, 0));  // its effects come first in their lists
  const int pin = revolute(world, world.ground(), apart, 0, 9, -0.5, 0);
  add_motor(world, pin, "angle", {1, 5});
  add_limit(world, pin, "angle", {.lower = -1, .upper = 1});
  add_spring(world, pin, "angle", {.softness = {.by_frequency = false, .stiffness = 3}, .rest = 0});
  add_motor(world, 0, "angle", other ? Motor{-2, 30} : Motor{1, 20});
  add_limit(world, 1, "angle", {.lower = -0.1, .upper = other ? 0.5 : 0.02});
  add_friction(world, 2, "angle", {other ? 2.0 : 0.1});
  add_spring(world, 3, "angle",
             {.softness = {.by_frequency = false, .stiffness = other ? 60.0 : 20.0, .damping = 1}, .rest = 0.2});
  add_limit(world, 4, "angle", {.lower = other ? -0.1 : 0.1, .upper = other ? -0.1 : 0.1});
}

TEST(Changes, EffectsTakeOtherNumbers) {
  const auto change = [](auto& world) {
    set_motor(world, 0, 1, {-2, 30});
    set_limit(world, 1, 1, {.lower = -0.1, .upper = 0.5});
    set_friction(world, 2, 1, {2});
    set_spring(world, 3, 1, {.softness = {.by_frequency = false, .stiffness = 60, .damping = 1}, .rest = 0.2});
    set_limit(world, 4, 1, {.lower = -0.1, .upper = -0.1});
  };
  check_change<Planar<double>>(heavy, with_effects<double>, change);
}

// A wheel of inertia I under the torque m: the speed changes by m t / I until it equals the motor's.
TEST(Changes, AMotorTurnsBack) {
  World<double> world(settings(Solver::direct));
  const int wheel = world.add_body({.mass = 1, .inertia = 0.5});
  const int hinge = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
  const int motor = add_motor(world, hinge, "angle", {.speed = 2, .max_force = 4});
  EXPECT_EQ(motor, 1);
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, 2, 1e-12);
  set_motor(world, hinge, motor, {.speed = -3, .max_force = 4});
  run(world, 0.25, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, 2 - 4 * 0.25 / 0.5, 1e-12);
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, -3, 1e-12);
  set_motor(world, hinge, motor, {.speed = 9, .max_force = 0});
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(wheel).w, -3, 1e-12);
}

// Setting the present force, motor, friction and spring again after every step does not change the motion. The bits are
// equal unless a step computes the accelerations for the next one (rk4, dop853).
TEST(Changes, ToTheSameForcesDoNothing) {
  Settings base = heavy;
  base.iterations = 200;
  const int methods = for_each_method(base, [&](const Settings& s, const std::string& name) {
    World<double> alone(s), pushed(s);
    with_effects(alone, false), with_effects(pushed, false);
    for (int i = 0; i < 50; ++i) {
      alone.step(dt), pushed.step(dt);
      for (int body = 0; body < pushed.body_count(); ++body) pushed.set_force(body, {});
      set_motor(pushed, 0, 1, {1, 20});
      set_friction(pushed, 2, 1, {0.1});
      set_spring(pushed, 3, 1, {.softness = {.by_frequency = false, .stiffness = 20, .damping = 1}, .rest = 0.2});
    }
    const bool accelerations = works_on_accelerations(s.integrator);
    EXPECT_LE(apart(alone, pushed), s.local_error > 0 ? 2e-3 : accelerations ? 1e-6 : 0) << name;
  });
  std::printf("%d methods\n", methods);
}

// --- every parameter of every joint ---

// Changes a number or a direction slightly.
NamedValue nudged(const ParameterInfo& info, const std::vector<double>& numbers) {
  NamedValue value{std::string(info.name), {}};
  const int size = info.size == 9 ? 6 : info.size;  // of a triad: x and the direction of y
  for (int k = 0; k < size; ++k) value.numbers.push_back(1.01 * numbers[size_t(info.offset + k)] + 0.004 * (k + 1));
  return value;
}

template <class S>
std::vector<int> add_bodies(BasicWorld<S>& world, const JointType& type) {
  std::vector<int> bodies;
  for (int i = 0; i < type.bodies; ++i) {
    if constexpr (S::dimension == Dimension::planar)
      bodies.push_back(
          world.add_body({.x = 0.8 * i, .y = 0.3 * i * i, .angle = 0.1 * i, .mass = 1, .inertia = 0.1 + 0.1 * i}));
    else bodies.push_back(world.add_body(brick(0.8 * i, 0.3 * i * i, -0.2 * i, 1 + 0.5 * i)));
  }
  return bodies;
}

// The joint with a spring on every coordinate.
template <class S>
int add_sprung(BasicWorld<S>& world, const JointType& type, std::vector<NamedValue> values) {
  const std::vector<int> bodies = add_bodies(world, type);
  const int joint = world.add_joint({std::string(type.name), bodies, std::move(values), {}});
  const CoordinateSpring spring{{.by_frequency = false, .stiffness = 3, .damping = 0.1}, 0.1};
  for (const CoordinateInfo& coordinate : type.coordinates) add_spring(world, joint, coordinate.name, spring);
  return joint;
}

std::vector<NamedValue> named(const JointType& type, const std::vector<double>& numbers) {
  std::vector<NamedValue> values;
  for (const ParameterInfo& info : type.parameters)
    values.push_back(
        {std::string(info.name), {numbers.begin() + info.offset, numbers.begin() + info.offset + info.size}});
  return values;
}

template <class S>
int check_parameters(const JointType& type, Integrator integrator) {
  Settings s = S::dimension == Dimension::planar ? heavy : heavy_in_space();
  s.integrator = integrator;
  int checked = 0;
  for (size_t k = 0; k < type.parameters.size(); ++k) {
    const ParameterInfo& info = type.parameters[k];
    if (info.name.ends_with("_turns")) continue;  // counted by the runtime
    BasicWorld<S> world(s), twin(s);
    const int joint = add_sprung(world, type, some_values(type));
    world.project(1e-9);
    run(world, 10 * dt, dt);
    std::vector<NamedValue> values = named(type, world.joint_parameters(joint));
    values[k] = nudged(info, world.joint_parameters(joint));
    add_sprung(twin, type, values);
    follow(world, twin);
    world.set_parameters(joint, {values[k]});
    const std::vector<double> now = world.joint_parameters(joint), wanted = twin.joint_parameters(0);
    for (size_t i = 0; i < now.size(); ++i) {
      if (now[i] == wanted[i]) continue;  // infinite numbers have no distance
      EXPECT_NEAR(now[i], wanted[i], 1e-15) << type.name << " " << info.name;
    }
    if (type.explicit_time) continue;  // its twin's time differs
    run(world, 10 * dt, dt), run(twin, 10 * dt, dt);
    EXPECT_LT(apart(world, twin), 1e-8) << type.name << " " << info.name;
    ++checked;
  }
  return checked;
}

TEST(Changes, EveryParameterOfEveryJointTakesAnotherNumber) {
  int checked = 0;
  for (Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::dop853}) {
    for (const JointType& type : joint_types(Dimension::planar))
      checked += check_parameters<Planar<double>>(type, integrator);
    for (const JointType& type : joint_types(Dimension::spatial))
      checked += check_parameters<Spatial<double>>(type, integrator);
  }
  std::printf("%d changes as if built that way\n", checked);
  EXPECT_GT(checked, 300);
}

// A point of the ground is a point of the world for every origin of poses; unnamed parameters keep their bits.
TEST(Changes, PointsOfTheGroundAreThoseOfTheWorld) {
  World<double> world(heavy);
  world.set_origin(1e6, 2e6);
  BodyDefinition d = rod(1e6, 2e6, 0);
  const int bar = world.add_body(d);
  EXPECT_EQ(world.pose(bar).x, d.x - 1e6);
  EXPECT_EQ(world.pose(bar).y, d.y - 2e6);
  const int pin =
      world.add_joint({"revolute", {world.ground(), bar}, {{"pa", {1e6 + 0.1, 2e6}}, {"pb", {-0.4, 0.1}}}, {}});
  const std::vector<double> before = world.joint_parameters(pin);
  world.set_parameters(pin, {{"pa", {1e6 + 0.25, 2e6 - 0.5}}});
  const std::vector<double> after = world.joint_parameters(pin);
  EXPECT_EQ(after[0], 1e6 + 0.25);
  EXPECT_EQ(after[1], 2e6 - 0.5);
  EXPECT_EQ(after[2], before[2]);
  EXPECT_EQ(after[3], before[3]);
  run(world, 0.1, 0.01);
  EXPECT_LT(world.worst_position_error().value, 1e-9);
}

// --- other effects of a change ---

TEST(Changes, WakeSleepingIslands) {
  Settings s = heavy;
  s.sleep_after = 0.1;
  const auto asleep = [&](auto change) {
    World<double> world(s);
    const int bar = add_chain(world, 1, -pi / 2)[0];
    const int motor = add_motor(world, 0, "angle", {.speed = 0, .max_force = 1});
    run(world, 0.5, 0.01);
    EXPECT_TRUE(world.asleep(bar));
    change(world, motor);
    run(world, 0.05, 0.01);
    const auto v = world.velocity(bar);
    return v.x == 0 && v.y == 0 && v.w == 0;
  };
  EXPECT_TRUE(asleep([](auto&, int) {}));
  EXPECT_FALSE(asleep([](auto& world, int motor) { set_motor(world, 0, motor, {.speed = 1, .max_force = 1}); }));
  EXPECT_FALSE(asleep([](auto& world, int) { world.set_parameters(0, {{"pa", {0.3, 0}}}); }));
  EXPECT_FALSE(asleep([](auto& world, int) { world.remove_joint(0); }));
}

// Changes belong to the State: an earlier snapshot undoes them, including the removal of a joint.
TEST(Changes, AreUndoneByAnEarlierSnapshot) {
  for (Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::dop853}) {
    Settings s = heavy;
    s.integrator = integrator;
    World<double> world(s);
    add_chain(world, 4, -0.4);
    const int motor = add_motor(world, 1, "angle", {.speed = 1, .max_force = 20});
    run(world, 0.1, 0.01);
    const Snapshot before = world.snapshot();
    const std::vector<double> parameters = world.joint_parameters(2);
    run(world, 0.1, 0.01);
    const Snapshot unchanged = world.snapshot();
    world.restore(before);
    set_motor(world, 1, motor, {.speed = -5, .max_force = 20});
    world.set_parameters(2, {{"pa", {0.6, 0.1}}});
    run(world, 0.1, 0.01);
    EXPECT_FALSE(world.snapshot() == unchanged);
    world.remove_joint(3);
    run(world, 0.1, 0.01);
    world.restore(before);
    EXPECT_FALSE(world.broken(3));
    EXPECT_EQ(world.joint_parameters(2), parameters);
    run(world, 0.1, 0.01);
    EXPECT_EQ(world.snapshot().differences(unchanged), std::vector<std::string>{});
  }
}

TEST(Changes, OfEffectsAllocateNothing) {
  World<double> world(heavy);
  add_chain(world, 4, -0.4);
  const int motor = add_motor(world, 1, "angle", {.speed = 1, .max_force = 20});
  run(world, 0.1, 0.01);
  const long before = allocations;
  for (int i = 0; i < 10; ++i) {
    set_motor(world, 1, motor, {.speed = 0.1 * i, .max_force = 20});
    world.step(0.01);
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace cdot::test
