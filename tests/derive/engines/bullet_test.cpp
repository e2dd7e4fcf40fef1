// Emitted joints in Bullet, beside Bullet's own and closed forms.
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "bullet/constant_velocity.hpp"
#include "bullet/distance.hpp"
#include "bullet/driven.hpp"
#include "bullet/gear.hpp"
#include "bullet/hinge.hpp"
#include "bullet/max_distance.hpp"
#include "tests/derive/engines/bevel_gear.hpp"

namespace {

namespace bullet = cdot::bullet;
namespace spatial = cdot::spatial;

constexpr double pi = 3.14159265358979323846;

// Bodies without shapes, so that only joints act.
class BulletJoints : public testing::Test {
 protected:
  BulletJoints() {
    world_.setGravity({0, 0, -10});
    world_.getSolverInfo().m_numIterations = 50;
  }
  ~BulletJoints() override {
    for (const auto& constraint : constraints_) world_.removeConstraint(constraint.get());
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  btRigidBody& body(const btVector3& x, double mass = 2, const btVector3& inertia = {0.3, 0.4, 0.5}) {
    bodies_.push_back(std::make_unique<btRigidBody>(mass, nullptr, &shape_, inertia));
    btRigidBody& made = *bodies_.back();
    made.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), x));
    made.setDamping(0, 0);
    made.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&made);
    return made;
  }
  template <class Constraint, class... Arguments>
  Constraint& add(Arguments&&... arguments) {
    auto made = std::make_unique<Constraint>(std::forward<Arguments>(arguments)...);
    Constraint& constraint = *made;
    constraints_.push_back(std::move(made));
    world_.addConstraint(&constraint);
    return constraint;
  }
  void run(double seconds, double h = 1.0 / 60) {
    for (int n = 0; n < int(seconds / h + 0.5); ++n) world_.stepSimulation(h, 0, h);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btEmptyShape shape_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> constraints_;
};

// About the x axis of the world, through a point of b; everything else by default.
bullet::hinge_joint::Parameters hinge_at(const btVector3& in_a) {
  bullet::hinge_joint::Parameters p{};
  p.pa_x = in_a.x(), p.pa_y = in_a.y(), p.pa_z = in_a.z();
  p.fa_x_x = p.fa_y_y = p.fa_z_z = 1;
  return p;
}

// Its point and frame on b follow from the poses.
void complete(bullet::hinge_joint& made) { made.by_default(spatial::hinge::index_of_pb); }

// A double pendulum that swings across its axis' plane as well: by emitted hinges, and by btHingeConstraint.
TEST_F(BulletJoints, AHingeMovesAsBulletsOwn) {
  btRigidBody& world = btTypedConstraint::getFixedBody();
  world_.getSolverInfo().m_numIterations = 200;  // the rows are the same space, swept in another order
  btRigidBody *first[2], *second[2];
  for (int k = 0; k < 2; ++k) {
    first[k] = &body({0, 1, 0});
    second[k] = &body({0, 3, 0});
  }
  complete(add<bullet::hinge_joint>(world, *first[0], hinge_at({0, 0, 0})));
  complete(add<bullet::hinge_joint>(*first[0], *second[0], hinge_at({0, 1, 0})));
  const btVector3 x(1, 0, 0);
  add<btHingeConstraint>(world, *first[1], btVector3(0, 0, 0), btVector3(0, -1, 0), x, x);
  add<btHingeConstraint>(*first[1], *second[1], btVector3(0, 1, 0), btVector3(0, -1, 0), x, x);
  double apart = 0, moved = 0;
  for (int n = 0; n < 240; ++n) {
    run(1.0 / 120, 1.0 / 120);
    apart = std::max(apart, (second[0]->getCenterOfMassPosition() - second[1]->getCenterOfMassPosition()).length());
    moved = std::max(moved, (second[0]->getCenterOfMassPosition() - btVector3(0, 3, 0)).length());
  }
  EXPECT_GT(moved, 3);
  EXPECT_LT(apart, 1e-6);
}

TEST_F(BulletJoints, MotorsAndLimitsOfACoordinate) {
  world_.setGravity({0, 0, 0});
  btRigidBody& b = body({0, 0, 0});
  auto& hinge = add<bullet::hinge_joint>(btTypedConstraint::getFixedBody(), b, hinge_at({0, 0, 0}));
  complete(hinge);
  hinge.angle().speed = 4;
  hinge.angle().most = 0.6;  // 2 rad/s^2 about the axis of inertia 0.3
  run(1);
  EXPECT_NEAR(b.getAngularVelocity().x(), 2, 1e-9);
  run(2);
  EXPECT_NEAR(b.getAngularVelocity().x(), 4, 1e-9);
  hinge.angle().upper = 4 * pi;  // beyond a whole turn
  run(3);
  EXPECT_NEAR(b.getAngularVelocity().x(), 0, 1e-9);
  EXPECT_NEAR(std::cos(b.getOrientation().getAngle()), 1, 1e-6);
  hinge.angle().speed = -1;
  run(1);
  EXPECT_NEAR(b.getAngularVelocity().x(), -1, 1e-9) << "a limit does not hold back";
}

// The door of the README, thrown open.
TEST_F(BulletJoints, ADoorStopsAtItsLimit) {
  btDiscreteDynamicsWorld& world = world_;
  world.setGravity({0, 0, 0});
  btRigidBody &wall = btTypedConstraint::getFixedBody(), &leaf = body({0, 0.5, 0});
  bullet::hinge_joint::Parameters parameters = hinge_at({0, 0, 0});
  parameters.pb_y = -0.5;
  parameters.fb_x_x = parameters.fb_y_y = parameters.fb_z_z = 1;
  leaf.setAngularVelocity({1, 0, 0});
  leaf.setLinearVelocity({0, 0, 0.5});
  cdot::bullet::hinge_joint door(wall, leaf, parameters);
  door.angle().upper = 1.5;
  world.addConstraint(&door);
  run(1);
  EXPECT_NEAR(leaf.getOrientation().getAngle(), 1, 1e-3);
  run(1);
  EXPECT_NEAR(leaf.getOrientation().getAngle(), 1.5, 1e-6);
  EXPECT_NEAR(leaf.getAngularVelocity().x(), 0, 1e-6);
  world.removeConstraint(&door);
}

// A mass on a soft rod sags by g / w^2 and swings up and down with its frequency, whatever the mass.
TEST_F(BulletJoints, SoftRowsHaveTheirFrequency) {
  for (const double hertz : {1.0, 3.0, 12.0}) {  // the first two as impulses, the last one by CFM
    for (const double mass : {0.1, 50.0}) {
      btRigidBody& b = body({0, 0, -2}, mass);
      bullet::distance_joint::Parameters p{};
      p.l = 2;
      auto& rod = add<bullet::distance_joint>(btTypedConstraint::getFixedBody(), b, p);
      rod.stiffness.hertz = hertz;
      rod.stiffness.damping_ratio = 1;
      run(4);
      const double w = 2 * pi * hertz;
      EXPECT_NEAR(-2 - b.getCenterOfMassPosition().z(), 10 / (w * w), 1e-4 * 10 / (w * w)) << hertz << " Hz, " << mass;
    }
  }
  btRigidBody& b = body({0, 0, -2}, 7);
  bullet::distance_joint::Parameters p{};
  p.l = 2;
  auto& rod = add<bullet::distance_joint>(btTypedConstraint::getFixedBody(), b, p);
  rod.stiffness.hertz = 2;
  rod.stiffness.damping_ratio = 0;
  int turns = 0;
  double last = 0;
  for (int n = 0; n < 4000; ++n) {
    run(1e-3, 1e-3);
    const double now = b.getLinearVelocity().z();
    turns += last < 0 && now >= 0;
    last = now;
  }
  EXPECT_NEAR(turns, 8, 1) << "4 s at 2 Hz";
}

// Two shafts at 60 degrees: a universal joint would let the second one run between half and twice the speed.
TEST_F(BulletJoints, AConstantVelocityJointThatBulletLacks) {
  world_.setGravity({0, 0, 0});
  world_.getSolverInfo().m_numIterations = 200;
  btRigidBody &world = btTypedConstraint::getFixedBody(), &a = body({0, 0, 0}), &b = body({0, 0, 0});
  const double bend = pi / 3;
  b.setCenterOfMassTransform(btTransform(btQuaternion(btVector3(0, 0, 1), bend), btVector3(0, 0, 0)));
  auto& input = add<bullet::hinge_joint>(world, a, hinge_at({0, 0, 0}));
  complete(input);
  bullet::hinge_joint::Parameters p{};
  p.fa_x_x = std::cos(bend), p.fa_x_y = std::sin(bend), p.fa_y_x = -std::sin(bend), p.fa_y_y = std::cos(bend);
  p.fa_z_z = 1;
  auto& output = add<bullet::hinge_joint>(world, b, p);
  output.by_default(spatial::hinge::index_of_fb);
  bullet::constant_velocity_joint::Parameters shafts{};
  shafts.fa_x_x = shafts.fa_y_y = shafts.fa_z_z = 1;
  auto& joint = add<bullet::constant_velocity_joint>(a, b, shafts);
  joint.parameters.fb_x_x = joint.parameters.fb_y_y = joint.parameters.fb_z_z = 1;
  input.angle().speed = 3;
  input.angle().most = 10;
  run(1);
  double worst = 0;
  for (int n = 0; n < 240; ++n) {
    run(1.0 / 120, 1.0 / 120);
    const btVector3 shaft = b.getWorldTransform().getBasis().getColumn(0);
    worst = std::max(worst, std::fabs(b.getAngularVelocity().dot(shaft) - a.getAngularVelocity().x()));
  }
  EXPECT_NEAR(a.getAngularVelocity().x(), 3, 1e-6);
  EXPECT_LT(worst, 1e-4);
}

// A string: C >= 0, slack until the mass has fallen 1 m.
TEST_F(BulletJoints, ABoundOnlyPulls) {
  btRigidBody& b = body({0, 0, 0});
  bullet::max_distance_joint::Parameters p{};
  p.l = 1;
  add<bullet::max_distance_joint>(btTypedConstraint::getFixedBody(), b, p);
  run(0.25, 1e-3);
  EXPECT_NEAR(b.getLinearVelocity().z(), -2.5, 1e-9) << "it falls freely";
  run(0.75, 1e-3);
  EXPECT_NEAR(b.getCenterOfMassPosition().z(), -1, 1e-3);
  EXPECT_NEAR(b.getLinearVelocity().z(), 0, 1e-6);
}

// A bevel gear, driven through many turns: a about x, b about y.
TEST_F(BulletJoints, AGearCountsWholeTurns) {
  world_.setGravity({0, 0, 0});
  btRigidBody &a = body({0, 0, 0}), &b = body({0, 0, 0});
  bullet::gear_joint::Parameters p{};
  cdot::test::make_bevel_gear(p);
  auto& gear = add<bullet::gear_joint>(a, b, p);
  cdot::test::drive_bevel_gear(gear, spatial::gear::index_of_angle_a_turns);
  double worst = 0;
  for (int n = 0; n < 1200; ++n) {
    run(0.01, 0.01);
    worst = std::max(worst, std::fabs(a.getAngularVelocity().x() + 1.3 * b.getAngularVelocity().y()));
  }
  EXPECT_NEAR(a.getAngularVelocity().x(), 12, 1e-6);
  EXPECT_GT(gear.parameters.angle_a_turns, 100);
  EXPECT_LT(worst, 1e-6);
}

// A row that depends on time, and Bullet's own words: breaking, feedback, CFM.
TEST_F(BulletJoints, TakesTimeAndBulletsSettings) {
  btRigidBody& b = body({0, 0, 0});
  bullet::driven_joint::Parameters p{};
  p.fa_x_x = p.fa_y_y = p.fa_z_z = p.fb_x_x = p.fb_y_y = p.fb_z_z = 1;
  p.rate = 2;
  auto& joint = add<bullet::driven_joint>(btTypedConstraint::getFixedBody(), b, p);
  btJointFeedback felt;
  joint.setJointFeedback(&felt);
  for (; joint.time < 1; joint.time += 0.01) run(0.01, 0.01);
  EXPECT_NEAR(b.getAngularVelocity().x(), 2, 1e-6);
  EXPECT_NEAR(b.getOrientation().getAngle(), 2, 0.03) << "without dC/dt it would trail by 0.1";
  EXPECT_NEAR(felt.m_appliedForceBodyB.z(), 20, 1e-6) << "it carries the weight";
  joint.setParam(BT_CONSTRAINT_CFM, 0.25);
  EXPECT_EQ(joint.getParam(BT_CONSTRAINT_CFM), 0.25);
  joint.setBreakingImpulseThreshold(0.1);  // less than the weight over a step
  run(0.1, 0.01);
  EXPECT_FALSE(joint.isEnabled());
}

}  // namespace
