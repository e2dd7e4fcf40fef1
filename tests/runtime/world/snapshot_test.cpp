// A run that continues from a snapshot has the same bits as one without a break: in another World, after another
// history, with every solver, integrator, drift correction, space and precision, with breaking and sleep.
#include <fmt/format.h>

#include <cdot/snapshot.hpp>

#include "tests/methods.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {

extern long allocations;  // counting_new.cpp

namespace {

// Rows of every kind, a joint that breaks early, one that breaks later, a chain that falls asleep.
template <class T>
void build_all_kinds(World<T>& world) {
  const auto rods = add_chain(world, 6, -0.4);
  add_motor(world, 1, "angle", {.speed = 1, .max_force = 2});
  add_limit(world, 2, "angle", {.lower = -0.1, .upper = 0.1});
  add_friction(world, 3, "angle", {.max_force = 0.1});
  add_spring(world, 4, "angle", {.softness = {.by_frequency = true, .frequency = 2}, .rest = 0.2});
  distance(world, rods[0], rods[3], 2.5, Softness{.by_frequency = true, .frequency = 3, .damping_ratio = 0.2});
  world.add_spring({.body_a = rods[1], .body_b = rods[4], .stiffness = 5, .rest_length = 3});
  world.add_joint({"max_distance", {rods[2], rods[5]}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {3.0}}}, {}});
  set_breaking_load(world, 1, 60);
  set_breaking_load(world, 4, 25);
  add_chain(world, 2, -pi / 2);
  // A four-bar with its last joint twice: redundant rows.
  const int crank = world.add_body(rod(0, 0, 1.2)), coupler = world.add_body(rod(std::cos(1.2), std::sin(1.2), 0.3));
  revolute(world, world.ground(), crank, 0, 0, -0.5, 0);
  revolute(world, crank, coupler, 0.5, 0, -0.5, 0);
  const double x = std::cos(1.2) + std::cos(0.3), y = std::sin(1.2) + std::sin(0.3);
  const int rocker = world.add_body(rod(x, y, -1));
  revolute(world, coupler, rocker, 0.5, 0, -0.5, 0);
  for (int i = 0; i < 2; ++i) revolute(world, rocker, world.ground(), 0.5, 0, x + std::cos(-1.0), y + std::sin(-1.0));
  const int driven = world.add_body(rod(0, 7, 0));
  world.add_joint({"driven_crank", {world.ground(), driven}, {{"pa", {0, 7}}, {"rate", {3}}}, {}});
  BodyDefinition damped = rod(0, 5, 0);
  damped.linear_damping = damped.angular_damping = 0.3;
  world.add_body(damped);
}

// Inertias that turn, an angle beyond whole turns, a gear that counts turns, a joint that breaks.
template <class T>
void build_all_kinds(SpatialWorld<T>& world) {
  add_free_mechanism(world);
  const int wheel = world.add_body(brick(0, 5, 0)), other = world.add_body(brick(1, 5, 0));
  const int hinge = join(world, "hinge", world.ground(), wheel, {{"pa", {0, 5, 0}}, {"fa", {0, 0, 1}}});
  for (int i = 0; i < 2; ++i)  // twice: redundant rows
    join(world, "hinge", world.ground(), other, {{"pa", {1, 5, 0}}, {"fa", {0, 0, 1}}});
  join(world, "gear", wheel, other, {{"fa", {0, 0, 1}}, {"fb", {0, 0, 1}}, {"ratio", {1}}});
  const int rotor = world.add_body(brick(0, 7, 0));
  join(world, "driven", world.ground(), rotor, {{"pa", {0, 7, 0}}, {"fa", {0, 0, 1}}, {"rate", {3}}});
  add_motor(world, hinge, "angle", {.speed = 20, .max_force = 50});
  add_limit(world, hinge, "angle", {.lower = -30, .upper = 30});
  set_breaking_load(world, 1, 12);
  world.apply_impulse(wheel, {0, 0, 0, 0.3, 0.1, 4});
  const int resting = world.add_body(brick(0, 0, 9));
  join(world, "spherical", world.ground(), resting, {{"pa", {0, 0, 9}}});
}

template <class S>
void touch(BasicWorld<S>& world, int step) {
  const int body = world.body_count() - 2;
  typename S::Exact::Velocity impulse{};
  impulse.x = 0.1;
  typename S::Wrench force{};
  force.force_x = 2, force.force_y = 1;
  if constexpr (requires { force.torque; }) force.torque = 0.7;
  else force.torque_x = 0.7, force.torque_z = -0.4;
  if (step % 37 == 36) world.apply_impulse(body, impulse);
  if (step == 40) world.set_force(0, force);
}

template <class S>
void run_on(BasicWorld<S>& world, int from, int to) {
  for (int i = from; i < to; ++i) {
    world.step(i % 7 == 3 ? 0.004 : 0.005);
    touch(world, i);
  }
}

const std::vector<std::string> same;

struct Seen {
  bool broke = false, slept = false, dependent = false;
};

// A run with snapshots: each is restored into a World with another history, or with none.
template <class S>
void check_runs(const Settings& settings, const std::string& name, Seen& seen) {
  const auto made = [&] {
    BasicWorld<S> world(settings);
    build_all_kinds(world);
    return world;
  };
  constexpr int steps = 120, stops[] = {0, 1, 17, 60, 95};
  BasicWorld<S> one = made();
  std::vector<Snapshot> states;
  int at = 0;
  for (int stop : stops) {
    run_on(one, at, stop);
    states.push_back(one.snapshot());
    at = stop;
    seen.broke |= one.broken(1) && stop > 0;
    seen.slept |= one.sleeping_islands() > 0;
    seen.dependent |= one.redundant_rows() > 0;
  }
  run_on(one, at, steps);
  const Snapshot end = one.snapshot();
  ASSERT_TRUE(std::isfinite(one.energy())) << name;
  for (size_t k = 0; k < std::size(stops); ++k) {
    const size_t way = (k + name.size()) % 3;  // into a fresh World, one with a past, from text
    BasicWorld<S> other = made();
    if (way == 1) run_on(other, 0, 30);
    other.restore(way == 2 ? Snapshot::read(states[k].text()) : states[k]);
    ASSERT_EQ(other.snapshot().differences(states[k]), same) << name << ", at once, way " << way;
    run_on(other, stops[k], steps);
    ASSERT_EQ(other.snapshot().differences(end), same) << name << ", from step " << stops[k] << ", way " << way;
    ASSERT_EQ(other.snapshot(), end);
  }
  one.restore(states[2]);
  run_on(one, stops[2], steps);
  EXPECT_EQ(one.snapshot(), end) << name;
}

template <class S>
void check_all_methods() {
  Seen seen;
  Settings base = settings(Solver::direct, Drift::projection, -9.81);
  base.sleep_after = 0.1;
  base.substeps = 2;
  const int combinations = for_each_method(base, [&](const Settings& s, const std::string& name) {
    if (!testing::Test::HasFatalFailure()) check_runs<S>(s, name, seen);
  });
  for (const auto& [name, kernels] : kernel_forms) {
    Settings s = settings(Solver::iterative, Drift::projection, -9.81);
    s.kernels = kernels;
    check_runs<S>(s, std::string(name), seen);
  }
  EXPECT_TRUE(seen.broke && seen.slept && seen.dependent) << seen.broke << seen.slept << seen.dependent;
  std::printf("%d methods: the same bits from 5 snapshots each\n", combinations);
}

TEST(Snapshot, ARunGoesOnWithTheSameBitsInThePlane) { check_all_methods<Planar<double>>(); }
TEST(Snapshot, ARunGoesOnWithTheSameBitsInFloats) { check_all_methods<Planar<float>>(); }
TEST(Snapshot, ARunGoesOnWithTheSameBitsInSpace) { check_all_methods<Spatial<double>>(); }
TEST(Snapshot, ARunGoesOnWithTheSameBitsInSpaceInFloats) { check_all_methods<Spatial<float>>(); }

// --- refusals and allocations ---

template <class F>
std::string error_of(F f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_refused(World<double>& world, const Snapshot& state, const std::string& why) {
  const std::uint64_t before = world.hash();
  const Snapshot whole = world.snapshot();
  EXPECT_NE(error_of([&] { world.restore(state); }).find(why), std::string::npos)
      << error_of([&] { world.restore(state); });
  EXPECT_EQ(world.hash(), before);
  EXPECT_EQ(world.snapshot().differences(whole), same);
}

World<double> chain_of(int links, double mass, const Settings& s, double arm = 0) {
  World<double> world(s);
  add_chain(world, links, 0.3, mass);
  if (arm != 0) distance(world, 1, links - 1, arm, Softness{});
  run(world, 0.1, 0.01);
  return world;
}

TEST(Snapshot, AStateOfAnotherWorldIsRefused) {
  const Settings direct = settings(Solver::direct, Drift::projection, -9.81);
  World<double> world = chain_of(3, 1, direct);
  Settings other = direct;
  other.integrator = Integrator::rk4;
  expect_refused(world, chain_of(3, 1, other).snapshot(), "double, direct, rk4, balanced kernels, the World is");
  other = settings(Solver::iterative, Drift::projection, -9.81);
  expect_refused(world, chain_of(3, 1, other).snapshot(), "double, iterative, euler");
  expect_refused(world, chain_of(4, 1, direct).snapshot(), "5 bodies and 4 joints, the World has 4 and 3");
  expect_refused(world, chain_of(3, 2, direct).snapshot(), "masses or inertias");
  other = direct;
  other.gravity_y = -1.6;
  expect_refused(world, chain_of(3, 1, other).snapshot(), "its joints, their parameters, effects, springs or gravity");
  const auto breakable = [&](double load) {
    World<double> chain = chain_of(3, 1, direct);
    set_breaking_load(chain, 1, load);
    return chain;
  };
  World<double> weak = breakable(500);
  expect_refused(weak, breakable(501).snapshot(), "its joints, their parameters, effects, springs or gravity");
  const auto shortened = [&](double amount) {
    World<double> chain = chain_of(3, 1, direct);
    const Profile length = Profile::function([=, now = chain.time()](double t) -> ProfileValue {
      return {2 - amount * (t - now), -amount, 0};
    });
    chain.add_joint({"distance", {1, chain.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {length})}, {}});
    return chain;
  };
  World<double> slow = shortened(0.1);
  EXPECT_NO_THROW(slow.restore(shortened(0.1).snapshot()));
  expect_refused(slow, shortened(0.2).snapshot(), "its joints, their parameters, effects, springs or gravity");
  expect_refused(world, Snapshot{}, "the snapshot is empty");
  World<float> floats(direct);
  add_chain(floats, 3, 0.3);
  expect_refused(world, floats.snapshot(), "planar float");
}

TEST(Snapshot, TheHashTellsPosesAndVelocitiesApart) {
  World<double> world(settings(Solver::direct));
  const int body = world.add_body(rod(0, 0, 0));
  const std::uint64_t at_rest = world.hash();
  world.set_velocity(body, {0, 0, 1e-300});
  const std::uint64_t turning = world.hash();
  EXPECT_NE(turning, at_rest);
  world.set_pose(body, {0, 0, 1e-300});
  EXPECT_NE(world.hash(), turning);
}

// A joint that broke before a body was added is not in the order of rows prepared afterwards.
TEST(Snapshot, AJointThatBrokeLongAgoStaysBroken) {
  const auto made = [](bool late) {
    World<double> world(settings(Solver::direct, Drift::projection, -9.81));
    add_chain(world, 4, 0);
    set_breaking_load(world, 2, 3);
    if (late) run(world, 0.1, 0.01);
    world.add_body(rod(0, 9, 0));
    return world;
  };
  World<double> one = made(true), other = made(false);
  ASSERT_TRUE(one.broken(2));
  run(one, 0.1, 0.01);
  other.restore(one.snapshot());
  run(one, 0.5, 0.01), run(other, 0.5, 0.01);
  EXPECT_EQ(one.snapshot().differences(other.snapshot()), same);
  EXPECT_TRUE(other.broken(2));
}

// One joint is gone before the islands are analysed again, another one breaks afterwards: only the first is left out.
TEST(Snapshot, JointsThatAreGoneBeforeAndAfterAnAnalysis) {
  const auto made = [] {
    World<double> world(settings(Solver::direct, Drift::projection, -9.81));
    add_chain(world, 6, 0);
    set_breaking_load(world, 1, 60);
    return world;
  };
  World<double> one = made(), other = made();
  run(one, 0.05, 0.01);
  ASSERT_FALSE(one.broken(1));
  one.remove_joint(4);
  for (int k = 0; k < 100 && !one.broken(1); ++k) one.step(0.01);
  ASSERT_TRUE(one.broken(1));
  other.restore(Snapshot::read(one.snapshot().text()));
  for (int joint : {1, 4}) EXPECT_TRUE(other.broken(joint));
  run(one, 0.5, 0.01), run(other, 0.5, 0.01);
  EXPECT_EQ(one.snapshot().differences(other.snapshot()), same);
}

// By sweeps, too: of two pins at one place the second is gone, and then the first breaks.
TEST(Snapshot, SweepsWithoutAPinThatIsGone) {
  const auto made = [] {
    World<double> world(settings(Solver::iterative, Drift::projection, -9.81));
    const int body = world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
    for (int k = 0; k < 2; ++k) revolute(world, world.ground(), body, 0, 0, -1, 0);
    set_breaking_load(world, 0, 20);
    return world;
  };
  World<double> one = made(), other = made();
  run(one, 0.05, 0.01);
  one.remove_joint(1);
  run(one, 0.05, 0.01);
  other.restore(Snapshot::read(one.snapshot().text()));
  for (int k = 0; k < 100 && !one.broken(0); ++k) {
    one.step(0.01), other.step(0.01);
    ASSERT_EQ(one.snapshot().differences(other.snapshot()), same) << k;
  }
  EXPECT_TRUE(one.broken(0));
}

// One Model and many States: a World steps equal mechanisms in turn, each as in a World of its own.
template <class S>
void check_many_states(const Settings& settings, const std::string& name) {
  constexpr int count = 4, steps = 25;
  const auto made = [&] {
    BasicWorld<S> world(settings);
    build_all_kinds(world);
    return world;
  };
  std::vector<BasicWorld<S>> alone;
  std::vector<Snapshot> states;
  for (int k = 0; k < count; ++k) {
    alone.push_back(made());
    typename S::Exact::Velocity push{};
    push.x = 0.1 * k;
    alone[k].apply_impulse(2, push);
    states.push_back(alone[k].snapshot());
  }
  BasicWorld<S> shared = made();
  for (int step = 0; step < steps; ++step) {
    for (int k = 0; k < count; ++k) {
      shared.restore(states[k]);
      shared.step(0.005);
      shared.snapshot_into(states[k]);
      alone[k].step(0.005);
    }
  }
  for (int k = 0; k < count; ++k)
    EXPECT_EQ(alone[k].snapshot().differences(states[k]), same) << name << ", mechanism " << k;
}

TEST(Snapshot, OneWorldStepsManyStates) {
  const Settings base = settings(Solver::direct, Drift::projection, -9.81);
  const int methods = for_each_method(base, [&](const Settings& s, const std::string& name) {
    check_many_states<Planar<double>>(s, name);
    check_many_states<Spatial<double>>(s, name);
  });
  std::printf("%d methods: 4 mechanisms in one World, as 4 in their own\n", methods);
}

TEST(Snapshot, OneAtHandIsFilledWithoutAllocation) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  build_all_kinds(world);
  Snapshot state = world.snapshot();
  const long before = allocations;
  for (int i = 0; i < 100; ++i) {
    world.step(0.005);
    world.snapshot_into(state);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(state, world.snapshot());
  EXPECT_EQ(state.time(), world.time());
}

TEST(Snapshot, TextComesBackToTheBitAndSaysWhereItIsWrong) {
  SpatialWorld<float> world(settings(Solver::direct, Drift::projection, -9.81));
  build_all_kinds(world);
  run(world, 0.3, 0.01);
  const Snapshot state = world.snapshot();
  const std::string text = state.text();
  EXPECT_EQ(Snapshot::read(text), state);
  EXPECT_EQ(Snapshot::read(text).text(), text);
  const auto wrong = [&](std::string changed) { return error_of([&] { Snapshot::read(changed); }); };
  EXPECT_EQ(wrong("time d 2"), "line 1: it does not begin with \"cdot state 2\": this is not a complete state");
  EXPECT_NE(wrong(text.substr(0, text.size() / 2)).find("not a complete state"), std::string::npos);
  EXPECT_NE(wrong(text.substr(0, text.rfind("end"))).find("the last line is missing"), std::string::npos);
  std::string other = text;
  other.replace(other.find("0x1."), 4, "0x1.0");
  EXPECT_NE(wrong(other).find("its hash differs"), std::string::npos) << wrong(other);
  other = text;
  other.replace(other.find("0x1."), 4, "0x1,");
  EXPECT_NE(wrong(other).find("line 6: \"0x1,"), std::string::npos) << wrong(other);
}

}  // namespace
}  // namespace cdot::test
