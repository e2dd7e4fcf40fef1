// Emitted joints in ODE, beside ODE's own and closed forms.
#include <cmath>
#include <gtest/gtest.h>
#include <ode/ode.h>

#include "ode/constant_velocity.hpp"
#include "ode/distance.hpp"
#include "ode/driven.hpp"
#include "ode/gear.hpp"
#include "ode/hinge.hpp"
#include "ode/max_distance.hpp"
#include "ode/spherical.hpp"
#include "tests/derive/engines/bevel_gear.hpp"

namespace {

namespace ode = cdot::ode;
namespace spatial = cdot::spatial;

constexpr double pi = 3.14159265358979323846;

struct Vector {
  double x, y, z;
};
double distance(const Vector& a, const Vector& b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }
Vector place(dBodyID body) { return {dBodyGetPosition(body)[0], dBodyGetPosition(body)[1], dBodyGetPosition(body)[2]}; }
Vector velocity(dBodyID body) {
  return {dBodyGetLinearVel(body)[0], dBodyGetLinearVel(body)[1], dBodyGetLinearVel(body)[2]};
}
Vector spin(dBodyID body) {
  return {dBodyGetAngularVel(body)[0], dBodyGetAngularVel(body)[1], dBodyGetAngularVel(body)[2]};
}

// Bodies without shapes, so that only joints act; by both steppers.
struct OdeJoints : testing::TestWithParam<bool> {
  dWorldID world;

  OdeJoints() {
    dInitODE2(0);
    world = dWorldCreate();
    dWorldSetGravity(world, 0, 0, -10);
    dWorldSetQuickStepNumIterations(world, 200);
    dRandSetSeed(1);
  }
  ~OdeJoints() override {
    dWorldDestroy(world);
    dCloseODE();
  }
  dBodyID body(const Vector& x, double mass = 2) {
    const dBodyID made = dBodyCreate(world);
    dMass m;
    dMassSetParameters(&m, mass, 0, 0, 0, 0.3, 0.4, 0.5, 0, 0, 0);
    dBodySetMass(made, &m);
    dBodySetPosition(made, x.x, x.y, x.z);
    dBodySetGyroscopicMode(made, 0);
    dBodySetFiniteRotationMode(made, 1);  // turns by h w exactly
    return made;
  }
  void step(double h) { GetParam() ? dWorldQuickStep(world, h) : dWorldStep(world, h); }
  void run(double seconds, double h = 1e-2) {
    for (int n = 0; n < int(seconds / h + 0.5); ++n) step(h);
  }
};
INSTANTIATE_TEST_SUITE_P(Steppers, OdeJoints, testing::Bool(),
                         [](const auto& of) { return of.param ? "QuickStep" : "Step"; });

// About the x axis of the world, through a point of a.
ode::hinge_joint::Parameters hinge_at(const Vector& in_a) {
  ode::hinge_joint::Parameters p{};
  p.pa_x = in_a.x, p.pa_y = in_a.y, p.pa_z = in_a.z;
  p.fa_x_x = p.fa_y_y = p.fa_z_z = 1;
  return p;
}
ode::hinge_joint& hinge(dWorldID world, dBodyID a, dBodyID b, const Vector& in_a) {
  auto* const made = new ode::hinge_joint(world, a, b, hinge_at(in_a));
  made->by_default(spatial::hinge::index_of_pb);
  return *made;
}

// The furthest that two bodies part.
struct Apart {
  dBodyID one, other;
  Vector from = place(one);
  double apart = 0, moved = 0;
  void look() {
    apart = std::max(apart, distance(place(one), place(other)));
    moved = std::max(moved, distance(place(one), from));
  }
};

// A body that swings on a ball joint which starts 1 cm open, and another one under it.
TEST_P(OdeJoints, ASphericalJointMovesAsOdesOwn) {
  dBodyID first[2], second[2];
  for (int k = 0; k < 2; ++k) {
    first[k] = body({0.2, 1, 0});
    second[k] = body({0.2, 3, 0});
  }
  new ode::spherical_joint(world, nullptr, first[0], {0, 0, 0, -0.2, -1, 0.01});
  new ode::spherical_joint(world, first[0], second[0], {0.3, 1, 0, 0.3, -1, 0});
  const dJointID upper = dJointCreateBall(world, nullptr), lower = dJointCreateBall(world, nullptr);
  dJointAttach(upper, nullptr, first[1]);
  dBodySetPosition(first[1], 0.2, 1, -0.01);
  dJointSetBallAnchor(upper, 0, 0, 0);
  dBodySetPosition(first[1], 0.2, 1, 0);
  dJointAttach(lower, first[1], second[1]);
  dJointSetBallAnchor(lower, 0.5, 2, 0);
  Apart bodies{second[0], second[1]};
  for (int n = 0; n < 1000; ++n, bodies.look()) step(1e-3);
  EXPECT_GT(bodies.moved, 1);
  EXPECT_LT(bodies.apart, 1e-9);
}

// A double pendulum that swings across the plane of its axes as well.
TEST_P(OdeJoints, AHingeMovesAsOdesOwn) {
  dBodyID first[2], second[2];
  for (int k = 0; k < 2; ++k) {
    first[k] = body({0, 1, 0});
    second[k] = body({0.5, 3, 0});
  }
  hinge(world, nullptr, first[0], {0, 0, 0});
  hinge(world, first[0], second[0], {0, 1, 0});
  for (const bool lower : {false, true}) {
    const dJointID own = dJointCreateHinge(world, nullptr);
    dJointAttach(own, lower ? first[1] : nullptr, lower ? second[1] : first[1]);
    dJointSetHingeAnchor(own, 0, lower ? 2 : 0, 0);
    dJointSetHingeAxis(own, 1, 0, 0);
  }
  Apart bodies{second[0], second[1]};
  for (int n = 0; n < 1000; ++n, bodies.look()) step(1e-3);
  EXPECT_GT(bodies.moved, 3);
  EXPECT_LT(bodies.apart, GetParam() ? 1e-6 : 1e-9);
}

TEST_P(OdeJoints, MotorsAndLimitsOfACoordinate) {
  dWorldSetGravity(world, 0, 0, 0);
  const dBodyID b = body({0, 0, 0});
  ode::hinge_joint& pin = hinge(world, nullptr, b, {0, 0, 0});
  dJointFeedback felt;
  dJointSetFeedback(pin.drive_joint(0), &felt);
  pin.angle().speed = 4;
  pin.angle().most = 0.6;  // 2 rad/s^2 about the axis of inertia 0.3
  run(1);
  EXPECT_NEAR(spin(b).x, 2, 1e-6);
  EXPECT_NEAR(felt.t1[0], 0.6, 1e-6);
  run(2);
  EXPECT_NEAR(spin(b).x, 4, 1e-6);
  pin.angle().upper = 4 * pi;  // beyond a whole turn
  run(3);
  EXPECT_NEAR(spin(b).x, 0, 1e-6);
  EXPECT_NEAR(dBodyGetRotation(b)[5], 1, 1e-6);
  pin.angle().speed = -1;
  run(1);
  EXPECT_NEAR(spin(b).x, -1, 1e-6) << "a limit does not hold back";
}

// A mass on a soft rod sags by g / w^2, whatever the mass. A soft hinge turns by the inertia about its rows.
TEST_P(OdeJoints, SoftRowsHaveTheirFrequency) {
  const double w = 2 * pi * 2;
  for (const double mass : {0.1, 50.0}) {
    const dBodyID b = body({0, 0, -2}, mass);
    ode::distance_joint::Parameters p{};
    p.l = 2;
    (new ode::distance_joint(world, nullptr, b, p))->stiffness.hertz = 2;
    run(4);
    EXPECT_NEAR(-2 - place(b).z, 10 / (w * w), 1e-6) << mass;
  }
  dWorldSetGravity(world, 0, 0, 0);
  const dBodyID b = body({0, 0, 0});
  hinge(world, nullptr, b, {0, 0, 0}).stiffness.hertz = 2;
  for (int n = 0; n < 400; ++n) {
    dBodyAddTorque(b, 0, 0.4 * w * w * 0.01, 0);  // 0.01 rad against the inertia 0.4
    step(1e-2);
  }
  EXPECT_NEAR(dBodyGetRotation(b)[2], std::sin(0.01), 1e-5);
}

// Two shafts at 60 degrees; a universal joint would let the second one run between half and twice the speed.
TEST_P(OdeJoints, AConstantVelocityJointThatOdeLacks) {
  dWorldSetGravity(world, 0, 0, 0);
  const double bend = pi / 3, c = std::cos(bend), s = std::sin(bend);
  const dBodyID a = body({0, 0, 0}), b = body({0, 0, 0});
  dQuaternion turned;
  dQFromAxisAndAngle(turned, 0, 0, 1, bend);
  dBodySetQuaternion(b, turned);
  ode::hinge_joint& input = hinge(world, nullptr, a, {0, 0, 0});
  auto p = hinge_at({0, 0, 0});
  p.fa_x_x = p.fa_y_y = c, p.fa_x_y = s, p.fa_y_x = -s;
  (new ode::hinge_joint(world, nullptr, b, p))->by_default(spatial::hinge::index_of_pb);
  ode::constant_velocity_joint::Parameters shafts{};
  shafts.fa_x_x = shafts.fa_y_y = shafts.fa_z_z = shafts.fb_x_x = shafts.fb_y_y = shafts.fb_z_z = 1;
  new ode::constant_velocity_joint(world, a, b, shafts);
  input.angle().speed = 3;
  input.angle().most = 10;
  run(1);
  double worst = 0;
  for (int n = 0; n < 500; ++n) {
    step(5e-3);
    const dReal* const R = dBodyGetRotation(b);
    worst = std::max(worst, std::fabs(spin(b).x * R[0] + spin(b).y * R[4] + spin(b).z * R[8] - spin(a).x));
  }
  EXPECT_NEAR(spin(a).x, 3, 1e-6);
  EXPECT_LT(worst, 1e-9);
}

// A string: C >= 0, slack until the mass has fallen 1 m.
TEST_P(OdeJoints, ABoundOnlyPulls) {
  const dBodyID b = body({0, 0, 0});
  ode::max_distance_joint::Parameters p{};
  p.l = 1;
  new ode::max_distance_joint(world, nullptr, b, p);
  run(0.25, 1e-3);
  EXPECT_NEAR(velocity(b).z, -2.5, 1e-9) << "it falls freely";
  run(0.75, 1e-3);
  EXPECT_NEAR(place(b).z, -1, 1e-3);
  EXPECT_NEAR(velocity(b).z, 0, 1e-6);
}

// A bevel gear, driven through many turns: a about x, b about y.
TEST_P(OdeJoints, AGearCountsWholeTurns) {
  dWorldSetGravity(world, 0, 0, 0);
  const dBodyID a = body({0, 0, 0}), b = body({0, 0, 0});
  ode::gear_joint::Parameters p{};
  cdot::test::make_bevel_gear(p);
  auto& gear = *new ode::gear_joint(world, a, b, p);
  cdot::test::drive_bevel_gear(gear, spatial::gear::index_of_angle_a_turns);
  double worst = 0;
  for (int n = 0; n < 1200; ++n) {
    step(0.01);
    worst = std::max(worst, std::fabs(spin(a).x + 1.3 * spin(b).y));
  }
  EXPECT_NEAR(spin(a).x, 12, 1e-6);
  EXPECT_GT(gear.parameters.angle_a_turns, 100);
  EXPECT_LT(worst, 1e-6);
}

// A row that depends on time, and ODE's own words: feedback, ERP, CFM.
TEST_P(OdeJoints, TakesTimeAndOdesSettings) {
  const dBodyID b = body({0, 0, 0});
  ode::driven_joint::Parameters p{};
  p.fa_x_x = p.fa_y_y = p.fa_z_z = p.fb_x_x = p.fb_y_y = p.fb_z_z = 1;
  p.rate = 2;
  auto& joint = *new ode::driven_joint(world, nullptr, b, p);
  dJointFeedback felt;
  dJointSetFeedback(&joint, &felt);
  for (; joint.time < 1; joint.time += 0.01) step(0.01);
  EXPECT_NEAR(spin(b).x, 2, 1e-6);
  EXPECT_NEAR(std::atan2(dBodyGetRotation(b)[9], dBodyGetRotation(b)[5]), 2, 0.03);
  EXPECT_NEAR(felt.f1[2], 20, 1e-6) << "it carries the weight";
  joint.cfm = 1e-2;  // a velocity of cfm times force
  joint.erp = 0;
  joint.parameters.rate = 0;
  run(1);
  EXPECT_NEAR(velocity(b).z, -20e-2, 1e-6);
}

// Joints that are switched off, attached anew, and destroyed before and after their bodies.
TEST_P(OdeJoints, LivesInTheListsOfTheWorld) {
  const dBodyID a = body({0, 0, 0});
  ode::hinge_joint* pin = &hinge(world, nullptr, a, {0, 0, 0});
  pin->angle().speed = 1;
  pin->angle().most = 100;
  dJointDisable(pin);
  run(0.1);
  EXPECT_NEAR(velocity(a).z, -1, 1e-9) << "neither the hinge nor its motor acts";
  EXPECT_EQ(spin(a).x, 0);
  dJointEnable(pin);
  run(2);
  EXPECT_NEAR(velocity(a).z, 0, 1e-6) << "the gap of the fall is closed";
  EXPECT_NEAR(spin(a).x, 1, 1e-6);
  EXPECT_EQ(dJointGetType(pin), dJointTypeNone);
  EXPECT_EQ(dBodyGetNumJoints(a), 2) << "the hinge, and its drive";
  const dBodyID b = body({0, 1, 0});
  dJointAttach(pin, nullptr, b);
  pin->by_default(spatial::hinge::index_of_pb);
  EXPECT_EQ(dBodyGetNumJoints(a), 0);
  EXPECT_EQ(dBodyGetNumJoints(b), 2);
  run(0.1);
  EXPECT_NEAR(spin(b).x, 1, 1e-6);
  const double before = velocity(b).z;
  dJointDestroy(pin);
  EXPECT_EQ(dBodyGetNumJoints(b), 0);
  run(0.1);
  EXPECT_NEAR(velocity(b).z - before, -1, 1e-9) << "it falls again";
  hinge(world, a, b, {0, 0, 0}).angle().upper = 1;
  dBodyDestroy(b);
  EXPECT_EQ(dBodyGetNumJoints(a), 0);
  run(0.1);
  hinge(world, nullptr, a, {0, 0, 0});  // dWorldDestroy() ends it
}

// The comparison with the library sees each part that it is for.
TEST_P(OdeJoints, ComparesItsDeclarationWithTheLibrary) {
  ode::HingeOfTheLibrary found;
  EXPECT_TRUE(found.has_the_members() && found.has_the_functions() && found.has_the_rows());
  dJointSetHingeParam(found.hinge, dParamFMax, 12);
  EXPECT_TRUE(found.has_the_functions());
  EXPECT_FALSE(found.has_the_rows());
  dJointSetHingeParam(found.hinge, dParamFMax, 0);
  EXPECT_FALSE(found.has_the_functions());
  EXPECT_TRUE(found.has_the_members());
  dJointSetFeedback(found.hinge, nullptr);
  EXPECT_FALSE(found.has_the_members());
}

}  // namespace
