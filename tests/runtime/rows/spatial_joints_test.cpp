// Joints in space: conservation laws, loads, and angles beyond half a turn.
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

using spatial::Vector;

TEST(SpatialJoints, MomentumOfAFreeMechanism) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    for (Drift drift : {Drift::none, Drift::baumgarte, Drift::projection}) {
      SpatialWorld<double> world(settings(solver, drift));
      add_free_mechanism(world);
      const SpatialMomentum before = momentum(world);
      run(world, 3, 1.0 / 240);
      const SpatialMomentum after = momentum(world);
      EXPECT_LT(norm(after.linear - before.linear), 1e-11);
      // Without projection the two points of a joint differ, and impulses have a lever arm.
      if (solver == Solver::direct && drift == Drift::projection) {
        EXPECT_LT(norm(after.angular - before.angular), 1e-12);
      }
    }
  }
}

// A heavy brick on a ball joint: the energy oscillates at first order and does not drift.
TEST(SpatialJoints, EnergyOfAPendulumHasNoDrift) {
  double before = 0;
  for (double h : {2e-3, 1e-3}) {
    Settings s = settings(Solver::direct);
    s.gravity_z = -9.81;
    SpatialWorld<double> world(s);
    const int body = world.add_body(brick(0.5, 0, 0.3));
    join(world, "spherical", world.ground(), body, {{"pa", {0, 0, 0}}});
    world.set_velocity(body, {0, 1.5, 0, -0.3 / 0.34 * 1.5, 0, 0.5 / 0.34 * 1.5});
    world.project(1e-10);
    const EnergyOff off = energy_off(world, 20, h);
    EXPECT_LT(off.late, 2 * off.early) << "h = " << h;
    if (before > 0) {
      EXPECT_NEAR(before / off.early, 2, 0.5) << "h = " << h;
    }
    before = off.early;
  }
}

TEST(SpatialJoints, ReactionsOfAHangingChain) {
  Settings s = settings(Solver::direct);
  s.gravity_z = -10;
  SpatialWorld<double> world(s);
  int above = world.ground();
  for (int i = 0; i < 4; ++i) {
    const int link = world.add_body(brick(0, 0, -0.5 - i, 2));
    join(world, "spherical", above, link, {{"pa", {0, 0, i ? -0.5 : 0.0}}});
    above = link;
  }
  run(world, 1, 0.01);
  for (int i = 0; i < 4; ++i) {
    const auto carried = world.reaction(i, world.joint_bodies(i)[1]);
    EXPECT_NEAR(carried.force_z, 20 * (4 - i), 1e-9);
    EXPECT_NEAR(carried.force_x, 0, 1e-9);
  }
}

// An angle between axes jumps where the axes are antiparallel: effects on it are refused. Effects are accepted at small
// and large angles and at kinks.
template <class T>
std::string refusal_of(const char* type, const char* coordinate, double lean) {
  SpatialWorld<T> world(settings(Solver::direct));
  const int body = world.add_body(brick(0.5, 0, 0));
  const int joint = join(world, type, world.ground(), body,
                         {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}, {"fb", {std::sin(lean), 0, std::cos(lean)}}});
  try {
    add_motor(world, joint, coordinate, {.speed = 1});
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(SpatialJoints, AnAngleWithoutValueIsRefused) {
  const auto check = [](auto refusal) {
    for (const auto& [type, coordinate] : {std::pair{"hinge", "angle"}, std::pair{"cylindrical", "angle"},
                                           std::pair{"planar_joint", "angle"}, std::pair{"swing_twist", "twist"}}) {
      const std::string against = refusal(type, coordinate, pi);
      EXPECT_EQ(against.find(std::string("coordinate `") + coordinate + "` of joint `" + type + "` has no value here"),
                0u)
          << type << ": \"" << against << '"';
      EXPECT_EQ(refusal(type, coordinate, 0), "");
    }
    EXPECT_EQ(refusal("swing_twist", "twist", pi - 0.1), "");
    for (const double lean : {0.0, 0.1, pi - 0.1}) EXPECT_EQ(refusal("swing_twist", "swing", lean), "") << lean;
    for (const double lean : {0.0, 0.1}) EXPECT_EQ(refusal("six_dof", "turn_x", lean), "") << lean;
  };
  check(refusal_of<double>);
  check(refusal_of<float>);
}

// The same for a row and for changed parameters of a running World: a refusal changes nothing.
TEST(SpatialJoints, ChangesThatMakeAnAngleJumpAreRefused) {
  SpatialWorld<double> world(settings(Solver::direct));
  const int body = world.add_body(brick(0.5, 0, 0));
  const int wheel = world.add_body(brick(0, 2, 0));
  const std::vector<double> up = {0, 0, 1}, down = {0, 0, -1};
  const int hinge = join(world, "hinge", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", up}});
  EXPECT_THROW(join(world, "gear", body, wheel, {{"fa", up}, {"fb", up}, {"ga", down}, {"gb", up}, {"ratio", {1}}}),
               Error);
  EXPECT_EQ(world.joint_count(), 1);
  world.set_parameters(hinge, {{"fb", down}});  // no effect acts on its angle
  world.set_parameters(hinge, {{"fb", up}});
  add_motor(world, hinge, "angle", {.speed = 1});
  EXPECT_THROW(world.set_parameters(hinge, {{"fb", down}}), Error);
  run(world, 1, 0.01);
  EXPECT_NEAR(world.coordinate_rate(hinge, "angle"), 1, 1e-9);
}

// A motor turns a hinge to a limit three turns away: an angle of the kernel ends at pi.
TEST(SpatialJoints, AnglesGoOnBeyondHalfATurn) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    SpatialWorld<double> world(settings(solver));
    const int body = world.add_body(brick(0.5, 0, 0));
    const int hinge = join(world, "hinge", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", {0, 0.6, 0.8}}});
    add_motor(world, hinge, "angle", {.speed = 5, .max_force = 20});
    add_limit(world, hinge, "angle", {.lower = -1, .upper = 19});
    run(world, 2, 0.005);
    EXPECT_NEAR(world.coordinate(hinge, "angle"), 9.7, 0.1);  // 10 except for the start
    run(world, 3, 0.005);
    EXPECT_NEAR(world.coordinate(hinge, "angle"), 19, 1e-6);
    EXPECT_NEAR(world.coordinate_rate(hinge, "angle"), 0, 1e-9);
  }
}

// Wheels that stand at half a turn, where round-off decides between pi and -pi: C beside J, which Baumgarte's
// correction reads, and C alone tell the same.
TEST(SpatialJoints, AGearAtHalfATurnStandsStill) {
  int seen = 0;
  for (int k = 1; k <= 200; ++k) {
    const double polar = 0.015 * k, azimuth = 1.7 * k, s = std::sin(polar), c = std::cos(polar);
    const double x = s * std::cos(azimuth), y = s * std::sin(azimuth);
    SpatialWorld<double> world(settings(Solver::direct, Drift::baumgarte));
    SpatialBodyDefinition wheel = brick(0, 0, 0);
    wheel.e0 = 0, wheel.e1 = x, wheel.e2 = y, wheel.e3 = c;
    const int body = world.add_body(wheel);
    const std::vector<double> frame = {x, y, c, c * std::cos(azimuth), c * std::sin(azimuth), -s};
    const int gear =
        join(world, "gear", world.ground(), body, {{"fa", frame}, {"fb", frame}, {"gb", frame}, {"ratio", {1.5}}});
    if (std::abs(world.position_error(gear)[0]) > 1) continue;  // the default of phi rounds to the other side
    ++seen;
    world.step(0.01);
    EXPECT_LT(std::abs(world.velocity(body).wz), 1e-9) << k;
  }
  EXPECT_GT(seen, 100);
}

// The first attempt at a step turns a fast rotor many times and is taken back with its turns.
TEST(SpatialJoints, StepsThatAreTakenBackCountNoTurns) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853}) {
    for (const double speed : {3.0, 30.0, 300.0}) {
      SpatialWorld<double> world({.integrator = integrator, .local_error = 1e-10});
      SpatialBodyDefinition d{.wz = speed, .mass = 1};
      d.inertia = {1, 1, 2};
      const int body = world.add_body(d);
      const int hinge = join(world, "hinge", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}});
      add_limit(world, hinge, "angle", {.lower = -1e6, .upper = 1e6});
      for (int k = 1; k <= 3; ++k) {
        world.step(1);
        EXPECT_NEAR(world.coordinate(hinge, "angle"), speed * k, 1e-5) << speed;
      }
    }
  }
}

// The midpoint rule takes back what is too long for it: at first, more than a turn of an arm in one part.
TEST(SpatialJoints, PartsThatAreTakenBackCountNoTurns) {
  for (double speed = 1; speed < 12; speed += 0.5) {
    Settings s = settings(Solver::direct);
    s.integrator = Integrator::implicit;
    SpatialWorld<double> world(s);
    SpatialBodyDefinition arm{.x = 1, .vy = speed, .wz = speed, .mass = 1};
    arm.inertia = {1, 1, 1};
    const int body = world.add_body(arm);
    const int hinge = join(world, "hinge", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}});
    add_limit(world, hinge, "angle", {.lower = -1e6, .upper = 1e6});
    for (int k = 1; k <= 3; ++k) {
      world.step(1);
      EXPECT_NEAR(world.coordinate(hinge, "angle"), speed * k, 1) << speed;
    }
  }
}

// RATTLE seeks the end of a step by Newton's method. Rounds that go astray leave no turn behind: no step of this double
// pendulum turns an arm by more than half a turn.
TEST(SpatialJoints, RoundsOfNewtonCountNoTurns) {
  for (double speed = 0.5; speed < 12; speed += 0.5) {
    Settings s = settings(Solver::direct);
    s.integrator = Integrator::rattle;
    SpatialWorld<double> world(s);
    SpatialBodyDefinition upper{.x = 1, .vy = speed, .wz = speed, .mass = 1};
    upper.inertia = {1, 1, 1};
    SpatialBodyDefinition lower{.x = 2, .y = -1, .vx = speed, .vy = 2 * speed, .mass = 0.1};
    lower.inertia = {0.01, 0.01, 0.01};
    const int a = world.add_body(upper), b = world.add_body(lower);
    const int hinges[] = {join(world, "hinge", world.ground(), a, {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}}),
                          join(world, "hinge", a, b, {{"pa", {2, 0, 0}}, {"fa", {0, 0, 1}}})};
    for (int hinge : hinges) add_limit(world, hinge, "angle", {.lower = -1e6, .upper = 1e6});
    double before[] = {0, 0};
    for (int k = 0; k < 100 && world.step(0.1); ++k) {
      for (int i : {0, 1}) {
        const double now = world.coordinate(hinges[i], "angle");
        EXPECT_LT(std::abs(now - before[i]), pi) << speed;
        before[i] = now;
      }
    }
  }
}

// Two wheels on hinges and a gear between them, for many turns.
TEST(SpatialJoints, AGearCountsTurns) {
  SpatialWorld<double> world(settings(Solver::direct));
  SpatialBodyDefinition wheel;
  wheel.mass = 1;
  wheel.inertia = {0.5, 0.5, 0.9};
  const int a = world.add_body(wheel);
  wheel.x = 3;
  const int b = world.add_body(wheel);
  const int first = join(world, "hinge", world.ground(), a, {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}});
  join(world, "hinge", world.ground(), b, {{"pa", {3, 0, 0}}, {"fa", {0, 0, 1}}});
  const int gear = join(world, "gear", a, b, {{"fa", {0, 0, 1}}, {"fb", {0, 0, 1}}, {"ratio", {2.5}}});
  add_motor(world, first, "angle", {.speed = 4, .max_force = 100});
  run(world, 20, 0.01);
  EXPECT_NEAR(world.velocity(a).wz, 4, 1e-9);
  EXPECT_NEAR(world.velocity(b).wz, -1.6, 1e-9);
  EXPECT_LT(std::abs(world.position_error(gear)[0]), 1e-9);
  EXPECT_NEAR(world.pose(b).xx, std::cos(32.0), 0.05);  // except for the first step
}

TEST(SpatialJoints, EqualBitsOnRepetition) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    const auto hash = [&] {
      SpatialWorld<double> world(settings(solver));
      add_free_mechanism(world);
      run(world, 2, 0.005);
      return world.hash();
    };
    EXPECT_EQ(hash(), hash());
  }
}

TEST(SpatialJoints, InFloats) {
  SpatialWorld<float> world(settings(Solver::iterative));
  add_free_mechanism(world);
  run(world, 3, 1.0 / 240);
  EXPECT_LT(world.worst_position_error().value, 1e-3);
}

// A triad given by one axis, by two axes and by three.
TEST(SpatialJoints, FramesInEveryWayOfGivingThem) {
  SpatialWorld<double> world;
  const int body = world.add_body(brick(1, 0, 0));
  const auto frame = [&](std::vector<double> fa) {
    const int joint = join(world, "revolute", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", std::move(fa)}});
    const auto numbers = world.joint_parameters(joint);
    for (const ParameterInfo& info : world.joint_type(joint).parameters)
      if (info.name == "fa")
        return std::vector<double>(numbers.begin() + info.offset, numbers.begin() + info.offset + info.size);
    return std::vector<double>{};
  };
  const auto triad = [](const std::vector<double>& f) {
    const Vector<double> x = {f[0], f[1], f[2]}, y = {f[3], f[4], f[5]}, z = {f[6], f[7], f[8]};
    EXPECT_NEAR(norm(x), 1, 1e-15);
    EXPECT_NEAR(norm(y), 1, 1e-15);
    EXPECT_NEAR(dot(x, y), 0, 1e-15);
    EXPECT_LT(norm(cross(x, y) - z), 1e-15);
  };
  for (const std::vector<double>& x : {std::vector<double>{0, 0, 3}, {0, -1, 0}, {2, 0, 0}, {0.3, -0.2, 0.9}})
    triad(frame(x));
  EXPECT_EQ(frame({0, 0, 1, 1, 0, 0.5}), frame({0, 0, 1, 1, 0, 0, 0, 1, 0}));
  EXPECT_THROW(frame({0, 0, 0}), Error);
  EXPECT_THROW(frame({0, 0, 1, 0, 0, 2}), Error);  // two parallel axes
  EXPECT_THROW(frame({0, 0}), Error);
}

// six_dof with each coordinate locked, free or limited, compared with the joints of the same rows.
struct SixDof {
  const char* like;
  std::vector<const char*> free;
};

// Two bricks in gravity, the first on a ball, joined by `type`; the pose of the second at the end.
spatial::Pose<double> pose_at_the_end(const char* type, const std::vector<const char*>& locked) {
  Settings s = settings(Solver::direct);
  s.gravity_z = -9.81;
  SpatialWorld<double> world(s);
  const int first = world.add_body(brick(0.5, 0, 0)), second = world.add_body(brick(1.5, 0.2, 0));
  join(world, "spherical", world.ground(), first, {{"pa", {0, 0, 0}}});
  std::vector<NamedValue> values = {{"pa", {0.5, 0.1, 0}}};
  if (std::string_view(type) != "spherical") values.push_back({"fa", {0.3, 1, 0.2}});
  const int joint = join(world, type, first, second, values);
  for (const char* coordinate : locked) add_limit(world, joint, coordinate, {.lower = 0, .upper = 0});
  world.apply_impulse(second, {0.3, 0.5, -0.2, 0.1, 0.2, -0.1});
  run(world, 0.5, 1e-3);
  for (const char* coordinate : locked)
    EXPECT_NEAR(world.coordinate(joint, coordinate), 0, 1e-9) << type << " " << coordinate;
  return world.pose(second);
}

TEST(SpatialJoints, SixDofWithLocksIsTheJointWithThoseRows) {
  const std::vector<const char*> all = {"slide_x", "slide_y", "slide_z", "turn_x", "turn_y", "turn_z"};
  for (const SixDof& c :
       {SixDof{"fixed", {}}, SixDof{"revolute", {"turn_x"}}, SixDof{"prismatic", {"slide_x"}},
        SixDof{"cylindrical", {"slide_x", "turn_x"}}, SixDof{"planar_joint", {"slide_y", "slide_z", "turn_x"}},
        SixDof{"spherical", {"turn_x", "turn_y", "turn_z"}}}) {
    std::vector<const char*> locked;
    for (const char* coordinate : all)
      if (std::none_of(c.free.begin(), c.free.end(), [&](std::string_view name) { return name == coordinate; }))
        locked.push_back(coordinate);
    const auto ours = pose_at_the_end("six_dof", locked), theirs = pose_at_the_end(c.like, {});
    EXPECT_NEAR(ours.x, theirs.x, 1e-6) << c.like;
    EXPECT_NEAR(ours.y, theirs.y, 1e-6) << c.like;
    EXPECT_NEAR(ours.z, theirs.z, 1e-6) << c.like;
    const double same = ours.e0 * theirs.e0 + ours.e1 * theirs.e1 + ours.e2 * theirs.e2 + ours.e3 * theirs.e3;
    EXPECT_NEAR(std::abs(same), 1, 1e-9) << c.like;
  }
}

TEST(SpatialJoints, SixDofStaysWithinItsLimits) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    Settings s = settings(solver);
    s.gravity_z = -9.81;
    s.iterations = 50;
    SpatialWorld<double> world(s);
    const int body = world.add_body(brick(0, 0, 0));
    const int joint = join(world, "six_dof", world.ground(), body, {{"pa", {0, 0, 0}}, {"fa", {1, 0, 0}}});
    for (const char* slide : {"slide_x", "slide_y"}) add_limit(world, joint, slide, {.lower = 0, .upper = 0});
    add_limit(world, joint, "slide_z", {.lower = -0.5, .upper = 0.2});
    for (const char* turn : {"turn_x", "turn_y"}) add_limit(world, joint, turn, {.lower = -0.3, .upper = 0.3});
    world.apply_impulse(body, {0, 0, 0, 0.2, -0.3, 0.1});
    double lowest = 0, widest = 0;
    for (int i = 0; i < 2000; ++i) {
      world.step(1e-3);
      lowest = std::min(lowest, world.coordinate(joint, "slide_z"));
      for (const char* turn : {"turn_x", "turn_y"}) widest = std::max(widest, std::abs(world.coordinate(joint, turn)));
    }
    EXPECT_NEAR(lowest, -0.5, 1e-6);
    EXPECT_NEAR(world.coordinate(joint, "slide_z"), -0.5, 1e-6);
    EXPECT_NEAR(world.coordinate_rate(joint, "slide_z"), 0, 1e-6);
    EXPECT_NEAR(widest, 0.3, 1e-5);
    EXPECT_GT(std::abs(world.coordinate_rate(joint, "turn_z")), 0.05);  // left free
  }
}

// Heavy loads on light links in space stay stable with the geometric stiffness.
TEST(SpatialJoints, GeometricStiffnessHoldsAHeavyLoad) {
  Settings s = settings(Solver::direct);
  s.gravity_z = -9.81;
  s.integrator = Integrator::implicit;
  SpatialWorld<double> world(s);
  int above = world.ground(), body = -1;
  for (int i = 0; i < 6; ++i) {
    body = world.add_body(brick(0, 0, -0.5 - i, i == 5 ? 1e4 : 1));
    join(world, "spherical", above, body, {{"pa", {0, 0, i ? -0.5 : 0.0}}});
    above = body;
  }
  world.apply_impulse(body, {1e4, 0, 0, 0, 0, 0});
  const double start = world.energy();
  for (int i = 0; i < 300; ++i) {
    world.step(1.0 / 60);
    ASSERT_LT(world.energy(), 1.01 * start) << i;
  }
  EXPECT_LT(world.worst_position_error().value, 1e-3);
}

}  // namespace
}  // namespace cdot::test
