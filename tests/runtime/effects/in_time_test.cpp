// Numbers that follow functions of time: forces, targets, speeds, lengths and places, by closed forms with every
// integrator; jumps of tables; the balance; snapshots.
#include <cmath>
#include <fmt/format.h>

#include "tests/runtime/effects/generated_effects.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {

extern long allocations;  // counting_new.cpp

namespace {

using effects::ball;
using effects::expect_orders;
using effects::unaccounted;
using effects::wheel;
using effects::with;

template <class World>
void run(World& world, double duration, double h) {
  for (long k = 0; k < std::lround(duration / h); ++k) ASSERT_TRUE(world.step(h));
}

// a + b sin(w t)
Profile swing(double a, double b, double w) {
  return Profile::function([=](double t) -> ProfileValue {
    return {a + b * std::sin(w * t), b * w * std::cos(w * t), -b * w * w * std::sin(w * t)};
  });
}
Profile table(std::vector<double> times, std::vector<double> values, Interpolation interpolation) {
  return Profile::table({.times = std::move(times), .values = std::move(values), .interpolation = interpolation});
}

// x = A/(m w) (t - sin(w t)/w) under a force A sin(w t).
double error_of_push(Integrator integrator, double h) {
  World<double> world(with(integrator));
  const int body = ball(world, 0, 0, 0, 0, 2);
  world.add_joint({"push", {body}, {{"pa", {0, 0}}, in_time("F", {swing(0, 3, 4), 0.0})}, {}});
  run(world, 1, h);
  return std::abs(world.pose(body).x - 3.0 / (2 * 4) * (1 - std::sin(4.0) / 4));
}

TEST(InTime, AForceSwings) { expect_orders("push", 0.02, 0.1, error_of_push); }

// Constant pieces 4, -6 and 1 N with jumps at 0.37 and 0.731 s, within steps.
double error_of_jumps(Integrator integrator, double h, double* velocity = nullptr) {
  World<double> world(with(integrator));
  const int body = ball(world, 0, 0, 0, 0, 2);
  const Profile force = table({0, 0.37, 0.731}, {4, -6, 1}, Interpolation::step);
  world.add_joint({"push", {body}, {{"pa", {0, 0}}, in_time("F", {force, 0.0})}, {}});
  run(world, 1, h);
  double x = 0, v = 0;
  for (const auto& [F, t] : {std::pair{4.0, 0.37}, {-6.0, 0.361}, {1.0, 0.269}})
    x += v * t + F / 4 * t * t, v += F / 2 * t;
  if (velocity) *velocity = std::abs(world.velocity(body).x - v);
  return std::abs(world.pose(body).x - x);
}

// Steps end at jumps: the velocity is exact by all methods, and the place by all but Euler's.
TEST(InTime, StepsEndAtJumps) {
  for (const IntegratorRow& row : integrator_rows) {
    double velocity = 1;
    const double error = error_of_jumps(row.integrator, 0.05, &velocity);
    EXPECT_LT(velocity, 1e-12) << row.name;
    if (row.order > 1) EXPECT_LT(error, 1e-12) << row.name;
    else EXPECT_GT(error / error_of_jumps(row.integrator, 0.0125), 3) << row.name;
  }
  Settings adaptive = with(Integrator::dop853);
  adaptive.local_error = 1e-6;
  World<double> world(adaptive);
  const int body = ball(world, 0, 0, 0, 0, 2);
  world.add_joint({"push",
                   {body},
                   {{"pa", {0, 0}}, in_time("F", {table({0, 0.37, 0.731}, {4, -6, 1}, Interpolation::step), 0.0})},
                   {}});
  run(world, 1, 0.01);
  EXPECT_NEAR(world.velocity(body).x, (4 * 0.37 - 6 * 0.361 + 0.269) / 2, 1e-12);
  EXPECT_LT(world.step_counts().rejected, 3);
}

// A force with kinks at 0.3 and 0.61 s: the methods of accelerations end steps there and keep their order.
double error_of_kinks(Integrator integrator, double h) {
  World<double> world(with(integrator));
  const int body = ball(world, 0, 0);
  const Profile force = table({0, 0.3, 0.61, 1}, {1, 5, -2, 3}, Interpolation::linear);
  world.add_joint({"push", {body}, {{"pa", {0, 0}}, in_time("F", {0.0, force})}, {}});
  run(world, 1, h);
  double y = 0, v = 0;
  for (const auto& [from, to, t] : {std::tuple{1.0, 5.0, 0.3}, {5.0, -2.0, 0.31}, {-2.0, 3.0, 0.39}})
    y += v * t + (2 * from + to) / 6 * t * t, v += (from + to) / 2 * t;
  return std::abs(world.pose(body).y - y);
}

TEST(InTime, KinksLeaveTheOrder) {
  EXPECT_LT(error_of_kinks(Integrator::rk4, 0.05), 1e-12);
  EXPECT_LT(error_of_kinks(Integrator::dop853, 0.05), 1e-12);
  EXPECT_LT(error_of_kinks(Integrator::radau5, 0.05), 1e-12);
  for (const Integrator integrator : {Integrator::rattle, Integrator::implicit}) {
    EXPECT_LT(error_of_kinks(integrator, 0.01), 1e-3);
    EXPECT_LT(error_of_kinks(integrator, 0.00125), 3e-5);
  }
}

// m x'' = -k (x - L), L = 1 + 0.3 sin(w t), from rest: x = 1 + A (sin(w t) - w/w0 sin(w0 t)), A = 0.3 w0^2/(w0^2 -
// w^2).
double error_of_moving_rest(Integrator integrator, double h, double* share = nullptr) {
  constexpr double m = 2, k = 50, w = 3, w0 = 5, A = 0.3 * w0 * w0 / (w0 * w0 - w * w);
  World<double> world(with(integrator));
  const int body = ball(world, 1, 0, 0, 0, m);
  world.add_joint({"spring",
                   {body, world.ground()},
                   {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {k}}, in_time("rest", {swing(1, 0.3, w)})},
                   {}});
  const double lost = unaccounted(world, 1, h);
  if (share) *share = lost;
  return std::abs(world.pose(body).x - (1 + A * (std::sin(w) - w / w0 * std::sin(w0))));
}

// Its energy follows the rest length: what that puts in is booked.
TEST(InTime, ASpringWithAMovingRest) {
  expect_orders("rest", 0.02, 0.1, [](Integrator integrator, double h) { return error_of_moving_rest(integrator, h); });
  for (const IntegratorRow& row : integrator_rows) {
    double share = 1;
    error_of_moving_rest(row.integrator, 0.005, &share);
    fmt::print("  {}: {:.1e} of the energy unaccounted\n", row.name, share);
    EXPECT_LT(share, row.order == 1 ? 0.03 : row.order == 2 ? 3e-3 : 1e-7) << row.name;
  }
}

// On a rod whose length grows as l = 1 + u t a ball turns by (1/u) w0 (1 - 1/l): it keeps l^2 w.
double error_of_rod(Integrator integrator, double h) {
  constexpr double u = 0.5, w0 = 2;
  World<double> world(with(integrator));
  const int body = ball(world, 1, 0, u, w0);
  const Profile length = Profile::function([](double t) -> ProfileValue { return {1 + u * t, u, 0}; });
  world.add_joint({"distance", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {length})}, {}});
  run(world, 1, h);
  const double angle = w0 / u * (1 - 1 / (1 + u)), l = 1 + u;
  return std::hypot(world.pose(body).x - l * std::cos(angle), world.pose(body).y - l * std::sin(angle));
}

TEST(InTime, ARodGrows) { expect_orders("l", 0.02, 0.1, error_of_rod); }

// A pendulum whose pivot swings up and down: theta'' = -(g + y'')/l sin(theta), integrated apart in small steps.
double angle_of_shaken_pendulum() {
  constexpr double l = 0.8, b = 0.2, w = 7, h = 1e-4;
  double s[2] = {0.9, 0};
  for (int n = 0; n < 10000; ++n) {
    double k[4][2];
    for (int stage = 0; stage < 4; ++stage) {
      const double c = stage == 0 ? 0 : stage == 3 ? 1 : 0.5, t = (n + c) * h;
      const double angle = s[0] + (stage ? c * h * k[stage - 1][0] : 0);
      k[stage][0] = s[1] + (stage ? c * h * k[stage - 1][1] : 0);
      k[stage][1] = -(9.81 - b * w * w * std::sin(w * t)) / l * std::sin(angle);
    }
    for (int i : {0, 1}) s[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  }
  return s[0];
}

double error_of_shaken_pendulum(Integrator integrator, double h, double right) {
  constexpr double l = 0.8, b = 0.2, w = 7;
  World<double> world(with(integrator, -9.81));
  world.set_origin(10, 20);
  const int body = ball(world, 10 + l * std::sin(0.9), 20 - l * std::cos(0.9), 0, b * w);
  world.add_joint({"distance", {body, world.ground()}, {{"pa", {0, 0}}, in_time("pb", {10.0, swing(20, b, w)})}, {}});
  run(world, 1, h);
  const auto place = world.place(body);
  return std::abs(std::atan2(place.x - 10, 20 + b * std::sin(w) - place.y) - right);
}

TEST(InTime, APivotSwings) {
  const double right = angle_of_shaken_pendulum();
  expect_orders("pivot", 0.01, 0.1,
                [&](Integrator integrator, double h) { return error_of_shaken_pendulum(integrator, h, right); });
}

// A phase that grows at a rate is a rate: by the kernel's dC/dt, and by jets.
TEST(InTime, APhaseThatGrowsIsARate) {
  for (const IntegratorRow& row : integrator_rows) {
    const auto place = [&](bool by_phase) {
      World<double> world(with(row.integrator, -9.81));
      const int crank = world.add_body(rod(0, 0, 0.3)), next = world.add_body(rod(std::cos(0.3), std::sin(0.3), 1));
      const Profile phase = Profile::function([](double t) -> ProfileValue { return {0.3 + 4 * t, 4, 0}; });
      std::vector<NamedValue> values = {{"pa", {0, 0}}, {"pb", {-0.5, 0}}, {"rate", {by_phase ? 0.0 : 4.0}}};
      values.push_back(by_phase ? in_time("phase", {phase}) : NamedValue{"phase", {0.3}});
      world.add_joint({"driven_crank", {world.ground(), crank}, values, {}});
      revolute(world, crank, next, 0.5, 0, -0.5, 0);
      world.project(1e-9);
      run(world, 1, 0.01);
      return std::array{world.pose(next).x, world.pose(next).y, world.velocity(next).w};
    };
    const auto one = place(false), other = place(true);
    for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], other[k], 1e-9) << row.name;
  }
}

// In space, about an axis in any direction, with arms on both bodies.
TEST(InTime, APhaseThatGrowsIsARateInSpace) {
  for (const IntegratorRow& row : integrator_rows) {
    const auto place = [&](bool by_phase) {
      SpatialWorld<double> world(with(row.integrator));
      SpatialBodyDefinition d = brick(0.4, 0.1, -0.2);
      d.e0 = 0.9, d.e1 = 0.2, d.e2 = -0.3, d.e3 = 0.4;
      const int crank = world.add_body(d), base = world.add_body(brick(1, 0, 0, 3));
      const Profile phase = Profile::function([](double t) -> ProfileValue { return {2 * t + t * t, 2 + 2 * t, 2}; });
      const Profile slow = Profile::function([](double t) -> ProfileValue { return {t * t, 2 * t, 2}; });
      std::vector<NamedValue> values = {{"pa", {-0.3, 0.2, 0.1}}, {"fa", {1, 2, -1}}, {"rate", {by_phase ? 0.0 : 2.0}}};
      values.push_back(in_time("phase", {by_phase ? phase : slow}));
      world.add_joint({"driven", {base, crank}, values, {}});
      world.project(1e-9);
      run(world, 1, 0.01);
      const auto p = world.place(crank);
      return std::array{p.x, p.y, p.z, p.e0, p.e1, p.e2, p.e3};
    };
    const auto one = place(false), other = place(true);
    for (std::size_t k = 0; k < one.size(); ++k) EXPECT_NEAR(one[k], other[k], 1e-9) << row.name;
  }
}

// The rate of a driven joint puts work in, whoever prescribes it.
TEST(InTime, TheBalanceBooksPrescribedLengths) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -9.81));
    const int body = ball(world, 1, 0, 0, 1);
    world.add_joint(
        {"distance", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {swing(1, 0.2, 5)})}, {}});
    world.project(1e-9);
    EXPECT_LT(unaccounted(world, 1, 0.002), row.order == 1 ? 0.03 : row.order == 2 ? 2e-3 : 1e-7) << row.name;
    ASSERT_EQ(world.work_by_source().size(), 1u);
    EXPECT_EQ(world.work_by_source()[0].name, "distance");
  }
}

// A belt prescribes v = sin(3 t) to a block that it can hold: x = (1 - cos 3)/3, and the work is m v^2/2.
double error_of_belt(Integrator integrator, double h, double* work = nullptr) {
  World<double> world(with(integrator));
  const int block = ball(world, 0, 0, 0, 0, 2);
  world.add_joint({"conveyor",
                   {block, world.ground()},
                   {{"pa", {0, 0}}, {"t", {1, 0}}, in_time("speed", {swing(0, 1, 3)}), {"most", {50}}},
                   {}});
  run(world, 1, h);
  if (work) *work = world.work_by_source().empty() ? 0 : world.work_by_source()[0].work;
  return std::abs(world.pose(block).x - (1 - std::cos(3.0)) / 3);
}

TEST(InTime, ABeltChangesItsSpeed) {
  expect_orders("speed", 0.02, 0.1, [](Integrator integrator, double h) { return error_of_belt(integrator, h); });
  for (const IntegratorRow& row : integrator_rows) {
    double work = 0;
    error_of_belt(row.integrator, 0.001, &work);
    EXPECT_NEAR(work, std::sin(3.0) * std::sin(3.0), row.order == 1 ? 3e-3 : 1e-4) << row.name;
  }
}

// A servo on the coordinate of a joint follows a target: I a'' = -k (a - target) - d a' within its torque.
TEST(InTime, AServoOfACoordinateFollowsItsTarget) {
  for (const IntegratorRow& row : integrator_rows) {
    const auto angle = [&](bool between_bodies) {
      World<double> world(with(row.integrator));
      const int body = wheel(world, 2);
      const std::vector<NamedValue> values = {
          {"k", {40}}, {"d", {6}}, {"most", {500}}, in_time("target", {swing(0, 1, 2)})};
      if (between_bodies) world.add_joint({"position_drive", {body, world.ground()}, values, {}});
      else add_effect(world, 0, "angle", SpecEffect{"position_drive", values});
      run(world, 1, 0.01);
      return world.pose(body).angle;
    };
    EXPECT_NEAR(angle(true), angle(false), 1e-9) << row.name;
    EXPECT_GT(std::abs(angle(true)), 0.2) << row.name;
  }
}

TEST(InTime, InSpaceForcesAndTorquesSwing) {
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(with(row.integrator));
    SpatialBodyDefinition d;
    d.mass = 2, d.inertia = {0.5, 0.5, 0.5};
    const int body = world.add_body(d);
    const Profile force = table({0, 0.35}, {4, -2}, Interpolation::step);
    world.add_joint({"push", {body}, {{"pa", {0, 0, 0}}, in_time("F", {0.0, force, 0.0})}, {}});
    world.add_joint({"couple", {body}, {in_time("M", {0.0, 0.0, force})}, {}});
    run(world, 1, 0.02);
    EXPECT_NEAR(world.velocity(body).y, (4 * 0.35 - 2 * 0.65) / 2, 1e-12) << row.name;
    EXPECT_NEAR(world.velocity(body).wz, (4 * 0.35 - 2 * 0.65) / 0.5, 1e-11) << row.name;
  }
}

template <class W>
void build_in_time(W& world) {
  const auto rods = add_chain(world, 3, -0.4);
  world.add_joint({"push",
                   {rods[2]},
                   {{"pa", {0.5, 0}}, in_time("F", {table({0, 0.153, 0.4}, {4, -6, 2}, Interpolation::step), 1.0})},
                   {}});
  world.add_joint({"distance",
                   {rods[1], world.ground()},
                   {{"pa", {0, 0}}, {"pb", {3, 2}}, in_time("l", {swing(3.2, 0.01, 9)})},
                   Softness{.by_frequency = true, .frequency = 2}});
  add_effect(world, 0, "angle", SpecEffect{"servo", {{"k", {5}}, {"most", {3}}, in_time("target", {swing(0, 1, 2)})}});
}

// In the middle of a piece, at its end and beyond; also where an adaptive step ends later than step(h).
TEST(InTime, SnapshotsGoOnWithTheSameBits) {
  for (const IntegratorRow& row : integrator_rows) {
    for (const double local_error : {0.0, 1e-7}) {
      Settings s = with(row.integrator, -9.81);
      s.local_error = works_on_accelerations(row.integrator) ? local_error : 0;
      s.sleep_after = 0.01;
      World<double> world(s), other(s);
      build_in_time(world), build_in_time(other);
      std::vector<Snapshot> kept;
      std::vector<std::uint64_t> hashes;
      for (int k = 0; k < 60; ++k) {
        kept.push_back(world.snapshot());
        ASSERT_TRUE(world.step(0.01)) << row.name;
        hashes.push_back(world.hash());
      }
      EXPECT_EQ(world.sleeping_islands(), 0);
      for (int k = 0; k < 60; k += 7) {
        other.restore(kept[static_cast<std::size_t>(k)]);
        for (int n = k; n < 60; ++n) {
          ASSERT_TRUE(other.step(0.01));
          ASSERT_EQ(other.hash(), hashes[static_cast<std::size_t>(n)]) << row.name << " from " << k << " at " << n;
        }
      }
    }
  }
}

TEST(InTime, StepsAllocateNothing) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -9.81));
    build_in_time(world);
    world.prepare();
    const long before = allocations;
    for (int k = 0; k < 60; ++k) world.step(0.01);
    EXPECT_EQ(allocations - before, 0) << row.name;
  }
}

// A step that fails leaves the state of its start.
TEST(InTime, ANumberOutsideItsRangeFailsTheStep) {
  World<double> world(with(Integrator::rk4));
  const int body = wheel(world, 1);
  world.add_joint({"brake", {body, world.ground()}, {in_time("torque", {swing(1, 2, 3)})}, {}});
  int steps = 0;
  while (steps < 200 && world.step(0.01)) ++steps;
  EXPECT_GT(steps, 100);
  EXPECT_LT(steps, 125);  // 1 + 2 sin(3 t) = 0 at 1.22 s
  const StepResult failed = world.step(0.01);
  EXPECT_EQ(failed.problem, StepProblem::out_of_range);
  EXPECT_EQ(failed.joint, 1);
  EXPECT_NE(in_words(failed, "", "the brake").find("leaves its range; it belongs to the brake"), std::string::npos);
}

template <class World>
void expect_refused(World& world, const JointDefinition& joint, const std::string& words) {
  try {
    world.add_joint(joint);
    FAIL() << words;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(InTime, NumbersThatCannotFollowAreRefused) {
  World<double> world(with(Integrator::rk4));
  const int body = ball(world, 0, 1), ground = world.ground();
  const Profile f = swing(0, 1, 1);
  expect_refused(world, {"thruster", {body}, {{"pa", {0, 0}}, in_time("n", {f, 1.0}), {"F", {1}}}, {}},
                 "`n` of effect `thruster` is a direction of length 1");
  expect_refused(world,
                 {"brake", {body, ground}, {in_time("torque", {table({0, 1}, {3, -1}, Interpolation::linear)})}, {}},
                 "follows values from -1 to 3 [kg*m^2/s^2]. Likely fix: numbers above 0");
  for (const Profile& jumping :
       {table({0, 0.5}, {1, 2}, Interpolation::step), table({0, 0.5, 0.5, 1}, {1, 1, 2, 2}, Interpolation::linear)})
    expect_refused(world, {"distance", {body, ground}, {{"pa", {0, 0}}, {"pb", {0, 0}}, in_time("l", {jumping})}, {}},
                   "`l` of joint `distance` jumps at t = 0.5 s");
  SpatialWorld<double> space;
  const int sphere = space.add_body(brick(0, 0, 1));
  expect_refused(space, {"rolling_sphere", {sphere, space.ground()}, {{"fa", {0, 0, 1}}, in_time("radius", {f})}, {}},
                 "the joint has rows without a position");
  const std::vector<double> axis = {0, 0, 1};
  JointDefinition gear{"gear", {sphere, space.ground()}, {{"fa", axis}, {"fb", axis}, {"ratio", {1}}}, {}};
  gear.parameters.push_back(in_time("angle_b_turns", {f}));
  expect_refused(space, gear, "counts whole turns");
  const int push = world.add_joint({"push", {body}, {{"pa", {0, 0}}, in_time("F", {f, 0.0})}, {}});
  EXPECT_THROW(world.set_parameters(push, {{"F", {1, 0}}}), Error);
  EXPECT_THROW(world.set_parameters(push, {in_time("pa", {f, 0.0})}), Error);
  world.set_parameters(push, {{"pa", {1, 0}}});
}

}  // namespace
}  // namespace cdot::test
