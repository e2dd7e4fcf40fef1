// Emitted joints in Simbody, beside Simbody's own and closed forms.
#include <Simbody.h>
#include <gtest/gtest.h>

#include "simbody/constant_velocity.hpp"
#include "simbody/driven.hpp"
#include "simbody/gear.hpp"
#include "simbody/rolling_sphere.hpp"
#include "simbody/spherical.hpp"

namespace {

namespace simbody = cdot::simbody;
using SimTK::MobilizedBody;
using SimTK::Vec3;

struct System {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::Force::Gravity gravity{forces, matter, -SimTK::YAxis, 9.81};

  // The state after `seconds`, to an accuracy.
  SimTK::State run(const SimTK::State& start, double seconds, double accuracy = 1e-9) const {
    SimTK::RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(accuracy);
    SimTK::TimeStepper stepper(system, integrator);
    stepper.initialize(start);
    stepper.stepTo(seconds);
    return integrator.getState();
  }
};

const SimTK::Body::Rigid brick(SimTK::MassProperties(2, Vec3(0), SimTK::UnitInertia(0.2, 0.3, 0.4)));

// A brick that hangs by its corner and spins: by spherical, and by Constraint::Ball.
TEST(SimbodyJoints, ASphericalJointMovesAsSimbodysOwn) {
  Vec3 end[2];
  for (int own = 0; own < 2; ++own) {
    System s;
    MobilizedBody::Free body(s.matter.Ground(), brick);
    const Vec3 corner(-0.5, 0.3, 0.2);
    if (own == 1) SimTK::Constraint::Ball(s.matter.Ground(), Vec3(0), body, corner);
    else simbody::spherical_joint({0, 0, 0, corner[0], corner[1], corner[2]}, s.matter.Ground(), body);
    SimTK::State start = s.system.realizeTopology();
    body.setQToFitTranslation(start, -corner);
    body.setUToFitAngularVelocity(start, Vec3(1, 2, 3));
    body.setUToFitLinearVelocity(start, SimTK::cross(Vec3(1, 2, 3), -corner));
    const SimTK::State later = s.run(start, 2);
    s.system.realize(later, SimTK::Stage::Position);
    end[own] = body.getBodyOriginLocation(later);
  }
  EXPECT_GT((end[0] - Vec3(0.5, -0.3, -0.2)).norm(), 0.1);
  EXPECT_LT((end[0] - end[1]).norm(), 1e-6);
}

// Two shafts at 60 degrees, an input driven at a prescribed rate: no constraint of Simbody joins them so.
TEST(SimbodyJoints, AConstantVelocityJointThatSimbodyLacks) {
  System s;
  const double bend = SimTK::Pi / 3;
  const SimTK::Rotation tilted(bend, SimTK::YAxis);
  MobilizedBody::Pin input(s.matter.Ground(), brick);  // about z
  MobilizedBody::Pin output(s.matter.Ground(), SimTK::Transform(tilted), brick, SimTK::Transform());
  simbody::constant_velocity_joint::Parameters p{};
  p.fa_x_z = p.fb_x_z = p.fa_y_x = p.fb_y_x = p.fa_z_y = p.fb_z_y = 1;  // the shafts along z
  simbody::constant_velocity_joint joint(p, input, output);
  SimTK::Constraint::ConstantSpeed(input, 3);
  SimTK::State start = s.system.realizeTopology();
  s.system.realizeModel(start);
  input.setRate(start, 3);
  output.setRate(start, 3);
  for (const double t : {0.3, 1.0, 2.2}) {
    const SimTK::State later = s.run(start, t);
    EXPECT_NEAR(output.getRate(later), 3, 1e-6) << t;
  }
}

// A ball that rolls without slip on a slope of 30 degrees: a = 5/7 g sin(30 degrees). Rows at velocity level.
TEST(SimbodyJoints, ABallRollsDownASlope) {
  System s;
  s.gravity.setDefaultDownDirection(SimTK::UnitVec3(std::sin(SimTK::Pi / 6), 0, -std::cos(SimTK::Pi / 6)));
  const SimTK::Body::Rigid ball(SimTK::MassProperties(3, Vec3(0), SimTK::UnitInertia::sphere(0.5)));
  MobilizedBody::Free body(s.matter.Ground(), ball);
  simbody::rolling_sphere_joint::Parameters p{};
  p.fa_x_z = p.fa_y_x = p.fa_z_y = 1;  // the plane's normal along z
  p.radius = 0.5;
  simbody::rolling_sphere_joint joint(p, s.matter.Ground(), body);
  SimTK::State start = s.system.realizeTopology();
  body.setQToFitTranslation(start, Vec3(0, 0, 0.5));
  const SimTK::State later = s.run(start, 1);
  s.system.realize(later, SimTK::Stage::Velocity);
  EXPECT_NEAR(body.getBodyOriginVelocity(later)[0], 5. / 7 * 9.81 * 0.5, 1e-6);
  EXPECT_NEAR(body.getBodyOriginLocation(later)[2], 0.5, 1e-6);
}

// A row that depends on time.
TEST(SimbodyJoints, FollowsAPrescribedMotion) {
  System s;
  MobilizedBody::Free body(s.matter.Ground(), brick);
  simbody::driven_joint::Parameters p{};
  p.fa_x_x = p.fa_y_y = p.fa_z_z = p.fb_x_x = p.fb_y_y = p.fb_z_z = 1;
  p.rate = 2;
  simbody::driven_joint joint(p, s.matter.Ground(), body);
  SimTK::State start = s.system.realizeTopology();
  body.setUToFitAngularVelocity(start, Vec3(2, 0, 0));
  const SimTK::State later = s.run(start, 1.5);
  s.system.realize(later, SimTK::Stage::Velocity);
  EXPECT_NEAR(body.getBodyAngularVelocity(later)[0], 2, 1e-8);
  EXPECT_NEAR(body.getBodyRotation(later)[2][1], std::sin(3), 1e-6);
}

// A bevel gear, driven through many turns: a about z, b about x.
TEST(SimbodyJoints, AGearCountsWholeTurns) {
  System s;
  MobilizedBody::Pin a(s.matter.Ground(), brick);
  MobilizedBody::Pin b(s.matter.Ground(), SimTK::Rotation(SimTK::Pi / 2, SimTK::YAxis), brick, SimTK::Transform());
  simbody::gear_joint::Parameters p{};
  for (double* frame : {&p.fa_x_x, &p.ga_x_x, &p.fb_x_x}) frame[2] = frame[3] = frame[7] = 1;  // x: z of the body
  p.gb_x_x = p.gb_z_y = 1, p.gb_y_z = -1;  // where the frame of b stands at angle 0
  p.ratio = 1.3;
  simbody::gear_joint gear(p, a, b);
  SimTK::Force::MobilityConstantForce motor(s.forces, a, SimTK::MobilizerUIndex(0), 3);
  SimTK::State state = s.system.realizeTopology();
  state = s.run(state, 10);
  EXPECT_GT(a.getAngle(state), 50);
  EXPECT_NEAR(a.getAngle(state) + 1.3 * b.getAngle(state), 0, 1e-6);
  const double inertia = 2 * 0.4 * (1 + 1 / (1.3 * 1.3));
  EXPECT_NEAR(a.getRate(state), 10 * 3 / inertia, 1e-6);
}

}  // namespace
