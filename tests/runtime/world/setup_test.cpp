// Sets Worlds up: refusals and their messages, definitions without influence, inconsistent starts.
#include <fmt/format.h>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

template <class F>
std::string message_of(F f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

JointDefinition revolute_with(std::vector<int> bodies, std::vector<NamedValue> parameters) {
  return {"revolute", std::move(bodies), std::move(parameters), {}};
}

TEST(Setup, MistakesInJointsAreNamed) {
  World<double> world;
  const int g = world.ground(), b = world.add_body({.mass = 1, .inertia = 1});
  const auto say = [&](const JointDefinition& joint) { return message_of([&] { world.add_joint(joint); }); };
  EXPECT_EQ(say({"revolut", {g, b}, {}, {}}), "there is no joint `revolut`; did you mean `revolute`?");
  EXPECT_EQ(say({"knee", {g, b}, {}, {}}), "there is no joint `knee`");
  EXPECT_EQ(say(revolute_with({g}, {})), "joint `revolute` connects 2 bodies, not 1");
  EXPECT_EQ(say(revolute_with({g, 7}, {})), "there is no body number 7");
  EXPECT_EQ(say(revolute_with({b, b}, {})), "joint `revolute` names the same movable body twice");
  EXPECT_EQ(say(revolute_with({g, b}, {{"pc", {0, 0}}})),
            "joint `revolute` has no parameter `pc`; its parameters are `pa`, `pb`");
  EXPECT_EQ(say(revolute_with({g, b}, {{"pa", {0}}})), "parameter `pa` of joint `revolute` takes 2 numbers, not 1");
  EXPECT_EQ(say(revolute_with({g, b}, {{"pa", {0, NAN}}})), "parameter `pa` of joint `revolute` is not finite");
  EXPECT_EQ(say(revolute_with({g, b}, {{"pa", {0, 0}}, {"pa", {1, 0}}})),
            "parameter `pa` of joint `revolute` is given twice");
  EXPECT_EQ(say(revolute_with({g, b}, {})), "joint `revolute` needs its parameter `pa` (it has no default)");
  EXPECT_EQ(say({"prismatic", {b, g}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 0}}}, {}}),
            "parameter `t` of joint `prismatic` is a direction and must not be zero");
  EXPECT_EQ(world.joint_count(), 0);
}

TEST(Setup, MistakesInBodiesAreNamed) {
  World<double> world;
  EXPECT_EQ(message_of([&] { world.add_body({.mass = 0, .inertia = 1}); }),
            "a body that is not static needs a mass > 0");
  EXPECT_EQ(message_of([&] { world.add_body({.mass = -1, .inertia = 1}); }),
            "a body that is not static needs a mass > 0");
  EXPECT_EQ(message_of([&] { world.add_body({.x = NAN, .mass = 1}); }), "every number of a body must be finite");
  EXPECT_EQ(message_of([&] { world.add_body({.vx = 1, .is_static = true}); }), "a static body has no velocity");
  EXPECT_EQ(world.body_count(), 0);
  EXPECT_THROW(World<double>({.iterations = 0}), Error);
  EXPECT_THROW(World<double>({.baumgarte = 2}), Error);
  EXPECT_THROW(World<double>({.local_error = 1e-6}), Error);
  EXPECT_THROW(World<double>({.integrator = Integrator::rk4, .local_error = -1}), Error);
  EXPECT_THROW(World<double>({.integrator = Integrator::rk4, .local_error = 1e-300}), Error);
  EXPECT_NO_THROW(World<double>({.integrator = Integrator::rk4, .local_error = 1e-18}));
  EXPECT_THROW(World<double>({.integrator = Integrator::rattle, .drift = Drift::none}), Error);
  EXPECT_THROW(World<double>({.integrator = Integrator::rk4, .drift = Drift::baumgarte}), Error);
  EXPECT_THROW(World<double>({.solver = Solver::iterative, .integrator = Integrator::radau5}), Error);
  EXPECT_THROW(World<double>({.solver = Solver::iterative, .integrator = Integrator::dop853, .drift = Drift::none}),
               Error);
}

// A length below 0 and a pitch of 0 are known by what they do to the rows, whatever the joint.
TEST(Setup, ParametersThatNoPoseSatisfiesAreRefused) {
  World<double> world;
  const int body = world.add_body({.x = 1, .mass = 1, .inertia = 1});
  const auto refused = [&](auto& in, const JointDefinition& joint, const char* why) {
    try {
      in.add_joint(joint);
      ADD_FAILURE() << joint.type << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  for (const char* type : {"distance", "max_distance"}) {
    const auto of_length = [&](double l) {
      return JointDefinition{type, {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {l}}}, {}};
    };
    refused(world, of_length(-1), "can hold at no pose: C is ");
    refused(world, of_length(-1e-3), "(l = -0.001)");
    const int joint = world.add_joint(of_length(1e-3));  // far from its pose, but there is one
    EXPECT_THROW(world.set_parameters(joint, {{"l", {-1}}}), Error);
    EXPECT_EQ(world.joint_parameters(joint).back(), 1e-3);
    world.add_joint(of_length(100));
  }
  SpatialWorld<double> space;
  const int nut = space.add_body({.mass = 1, .inertia = {1, 1, 1}});
  refused(
      space,
      {"screw", {space.ground(), nut}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"fa", {0, 0, 1}}, {"pitch", {0}}}, {}},
      "has no meaning at pitch = 0, by which it divides");
  EXPECT_THROW(
      space.add_joint({"distance", {space.ground(), nut}, {{"pa", {1, 0, 0}}, {"pb", {0, 0, 0}}, {"l", {-1}}}, {}}),
      Error);
}

// A cone of 7 rad would act as one of 0.72 rad. Both bounds are outside.
TEST(Setup, NumbersOutsideTheirRangesAreRefused) {
  SpatialWorld<double> space;
  const int body = space.add_body({.mass = 1, .inertia = {1, 1, 1}});
  const auto cone = [&](double half) {
    return JointDefinition{"cone", {space.ground(), body}, {{"na", {1, 0, 0}}, {"half", {half}}}, {}};
  };
  for (const double half : {7.0, -0.5, 0.0, 3.15})
    EXPECT_EQ(
        message_of([&] { space.add_joint(cone(half)); }),
        fmt::format("parameter `half` of joint `cone` is {:.6g} [rad]. Likely fix: a number between 0 and 3.14159",
                    half));
  const int joint = space.add_joint(cone(3.14));
  EXPECT_THROW(space.set_parameters(joint, {{"half", {7}}}), Error);
  EXPECT_EQ(space.joint_parameters(joint).back(), 3.14);
  EXPECT_EQ(
      message_of([&] {
        space.add_joint({"pulley",
                         {space.ground(), body},
                         {{"pa", {0, 1, 0}}, {"pb", {1, 0, 0}}, {"ga", {0, 2, 0}}, {"gb", {1, 2, 0}}, {"ratio", {-1}}},
                         {}});
      }),
      "parameter `ratio` of joint `pulley` is -1 [1]. Likely fix: a number above 0");
}

TEST(Setup, MissingParametersTakeTheSpecsDefaults) {
  World<double> world;
  const int a = world.add_body({.x = 1, .y = 2, .angle = 0.5, .mass = 1, .inertia = 1});
  const int b = world.add_body({.x = 3, .y = 1, .angle = -1, .mass = 1, .inertia = 1});
  const int joint = world.add_joint(revolute_with({a, b}, {{"pa", {0.7, -0.2}}}));
  for (double C : world.position_error(joint)) EXPECT_NEAR(C, 0, 1e-15);
  EXPECT_EQ(world.joint_parameters(joint).size(), 4u);
}

TEST(Setup, DirectionsAreNormalised) {
  for (double scale : {1.0, 10.0, 1e-6, 1e-200}) {
    World<double> world;
    const int b = world.add_body({.mass = 1, .inertia = 1});
    const int joint = world.add_joint(
        {"prismatic", {b, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0.6 * scale, 0.8 * scale}}}, {}});
    const auto p = world.joint_parameters(joint);
    const int offset = world.joint_type(joint).parameters[2].offset;
    EXPECT_NEAR(p[offset], 0.6, 1e-15);
    EXPECT_NEAR(p[offset + 1], 0.8, 1e-15);
  }
}

TEST(Setup, JointBetweenStaticBodiesDoesNothingAndSaysSo) {
  World<double> world;
  const int wall = world.add_body({.x = 5, .is_static = true});
  revolute(world, world.ground(), wall, 0, 0, 1, 1);
  ASSERT_EQ(world.notes().size(), 1u);
  EXPECT_EQ(world.notes()[0].joint, 0);
  EXPECT_EQ(world.notes()[0].text, "connects only immovable bodies and does nothing");
  run(world, 1, 0.01);
  EXPECT_EQ(world.pose(wall).x, 5);
  EXPECT_TRUE(finite(world));
}

// A motor on the angle of a body that never turns, and a torque on it: one note each.
TEST(Setup, EffectsThatMoveNothingAreNoted) {
  World<double> world;
  const int body = world.add_body({.mass = 1, .fixed_rotation = true});
  const int pin = revolute(world, world.ground(), body, 0, 0, 0, 0);
  add_motor(world, pin, "angle", {.speed = 1});
  add_friction(world, pin, "angle", DryFriction{.max_force = 2});
  const int torque = world.add_joint({"couple", {body}, {{"M", {3}}}, {}});
  const int force = world.add_joint({"push", {body}, {{"pa", {0, 1}}, {"F", {3, 0}}}, {}});
  ASSERT_EQ(world.notes().size(), 2u) << force;
  EXPECT_EQ(world.notes()[0].joint, pin);
  EXPECT_EQ(world.notes()[0].text, "has effects on `angle`, which cannot change: they do nothing");
  EXPECT_EQ(world.notes()[1].joint, torque);
  EXPECT_EQ(world.notes()[1].text, "pushes its bodies where they cannot move, and does nothing");
}

TEST(Setup, InconsistentStartIsReportedAndProjected) {
  for (Solver solver : {Solver::direct, Solver::iterative}) {
    World<double> world(settings(solver));
    const auto rods = add_chain(world, 4, -0.4);
    EXPECT_TRUE(world.inconsistencies(1e-9).empty());
    const auto q = world.pose(rods[2]);
    world.set_pose(rods[2], {q.x + 0.1, q.y - 0.05, q.angle + 0.1});
    world.set_velocity(rods[0], {0, 0, 1});
    const auto found = world.inconsistencies(1e-9);
    bool position = false, velocity = false;
    for (const Inconsistency& item : found) (item.velocity ? velocity : position) = true;
    EXPECT_TRUE(position && velocity);
    EXPECT_TRUE(world.project(1e-9));
    EXPECT_TRUE(world.inconsistencies(1e-9).empty());
    EXPECT_GT(world.energy(), 1e-3) << "the projection keeps what motion the joints allow";
  }
}

TEST(Setup, ProjectionOfContradictingJointsFails) {
  World<double> world;
  const int bob = world.add_body({.x = 1, .mass = 1});
  const int post = world.add_body({.x = 5, .is_static = true});
  distance(world, world.ground(), bob, 1);
  distance(world, post, bob, 1);
  EXPECT_FALSE(world.project(1e-9));
  EXPECT_TRUE(finite(world));
}

TEST(Setup, ProjectionIsTheLeastChangeInTheMetricOfTheMasses) {
  World<double> world;
  const int light = world.add_body({.x = 0, .mass = 1});
  const int heavy = world.add_body({.x = 1.3, .mass = 2});
  distance(world, light, heavy, 1);
  EXPECT_TRUE(world.project(1e-12));
  EXPECT_NEAR(world.pose(light).x, 0.2, 1e-12);  // twice as far as the body of twice the mass
  EXPECT_NEAR(world.pose(heavy).x, 1.2, 1e-12);
}

TEST(Setup, FixedRotationAndPointMassesDoNotTurn) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  const int a = world.add_body({.x = 1, .mass = 1, .inertia = 2, .fixed_rotation = true});
  const int b = world.add_body({.x = 2, .mass = 1});
  revolute(world, world.ground(), a, 0, 0, 0, 0);
  revolute(world, a, b, 0.5, 0, -0.5, 0);
  world.project(1e-12);
  run(world, 1, 1e-2);
  EXPECT_TRUE(finite(world));
  EXPECT_EQ(world.pose(a).angle, 0);
  EXPECT_EQ(world.pose(b).angle, 0);
  EXPECT_LT(world.worst_position_error().value, 1e-9);
}

}  // namespace
}  // namespace cdot::test
