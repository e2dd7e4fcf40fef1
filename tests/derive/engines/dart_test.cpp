// Emitted joints in DART, beside DART's own and closed forms.
#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/TranslationalJoint.hpp>
#include <dart/simulation/World.hpp>
#include <gtest/gtest.h>
#include <memory>

#include "dart/constant_velocity.hpp"
#include "dart/distance.hpp"
#include "dart/driven.hpp"
#include "dart/gear.hpp"
#include "dart/hinge.hpp"
#include "dart/max_distance.hpp"
#include "dart/midpoint.hpp"
#include "dart/spherical.hpp"
#include "tests/derive/engines/bevel_gear.hpp"

namespace {

namespace joints = cdot::dart;
namespace spatial = cdot::spatial;
using dart::dynamics::BodyNode;
using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;

// Bodies without shapes, so that only joints act.
struct DartJoints : testing::Test {
  dart::simulation::WorldPtr world = dart::simulation::World::create();

  DartJoints() {
    world->setGravity({0, 0, -10});
    world->setTimeStep(1e-3);
  }
  void add_body(const dart::dynamics::SkeletonPtr& skeleton, BodyNode* made, double mass) {
    made->setInertia(dart::dynamics::Inertia(mass, Vector3d::Zero(), Vector3d(0.3, 0.4, 0.5).asDiagonal()));
    if (!world->hasSkeleton(skeleton)) world->addSkeleton(skeleton);
  }
  // A free body, a skeleton of its own.
  BodyNode* body(const Vector3d& x, double mass = 2, const Eigen::Matrix3d& R = Eigen::Matrix3d::Identity()) {
    const auto skeleton = dart::dynamics::Skeleton::create("body" + std::to_string(world->getNumSkeletons()));
    const auto made = skeleton->createJointAndBodyNodePair<dart::dynamics::FreeJoint>();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = x;
    T.linear() = R;
    dart::dynamics::FreeJoint::setTransformOf(made.second, T);
    add_body(skeleton, made.second, mass);
    return made.second;
  }
  // A body that turns about the axis x of its frame, at `x` from the middle of its parent, in the parent's skeleton.
  BodyNode* hinged(const dart::dynamics::SkeletonPtr& skeleton, BodyNode* parent, const Vector3d& x,
                   const Vector3d& to_middle) {
    dart::dynamics::RevoluteJoint::Properties p;
    p.mName = p.mName + std::to_string(skeleton->getNumBodyNodes());
    p.mAxis = Vector3d::UnitX();
    p.mT_ParentBodyToJoint.translation() = x;
    p.mT_ChildBodyToJoint.translation() = -to_middle;
    const auto made = skeleton->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(
        parent, p, BodyNode::AspectProperties("of " + p.mName));
    add_body(skeleton, made.second, 2);
    return made.second;
  }
  template <class Joint, class... Bodies>
  Joint& add(const typename Joint::Parameters& p, Bodies... bodies) {
    const auto made = std::make_shared<Joint>(p, bodies...);
    world->getConstraintSolver()->addConstraint(made);
    return *made;
  }
  void run(double seconds) {
    for (int n = 0; n < int(seconds / world->getTimeStep() + 0.5); ++n) world->step();
  }
};

Vector3d place(const BodyNode* body) { return body->getWorldTransform().translation(); }
Vector3d spin(const BodyNode* body) {
  return body->getSpatialVelocity(dart::dynamics::Frame::World(), dart::dynamics::Frame::World()).head<3>();
}

// About the x axis of the world, through a point of a.
joints::hinge_joint::Parameters hinge_at(const Vector3d& in_a) {
  joints::hinge_joint::Parameters p{};
  p.pa_x = in_a[0], p.pa_y = in_a[1], p.pa_z = in_a[2];
  p.fa_x_x = p.fa_y_y = p.fa_z_z = 1;
  return p;
}
joints::hinge_joint& complete(joints::hinge_joint& made) {
  made.by_default(spatial::hinge::index_of_pb);
  return made;
}

// The furthest that two bodies part, from now on.
struct Apart {
  const BodyNode *one, *other;
  Vector3d from = place(one), between = place(one) - place(other);
  double apart = 0, moved = 0;
  void look() {
    apart = std::max(apart, (place(one) - place(other) - between).norm());
    moved = std::max(moved, (place(one) - from).norm());
  }
};

// A body on a point 1 cm off: the gap closes alike.
TEST_F(DartJoints, ASphericalJointMovesAsDartsOwn) {
  BodyNode *const one = body({0.2, 1, 0}), *const other = body({0.2, 1, 0});
  add<joints::spherical_joint>({0, 0, 0.01, -0.2, -1, 0}, nullptr, one);
  world->getConstraintSolver()->addConstraint(
      std::make_shared<dart::constraint::BallJointConstraint>(other, Vector3d(0, 0, 0)));
  dart::dynamics::FreeJoint::setTransformOf(other, Eigen::Isometry3d(Eigen::Translation3d(0.2, 1, -0.01)));
  Apart bodies{one, other};
  for (int n = 0; n < 1000; ++n, bodies.look()) world->step();
  EXPECT_GT(bodies.moved, 1);
  EXPECT_LT(bodies.apart, 1e-9);
}

// Two bodies one under the other. DART's own lever to its second body ends at the point of the first one, so the two
// part as the gap does, with the square of the time step.
TEST_F(DartJoints, AChainMovesAsDartsOwn) {
  double apart[2];
  for (int k = 0; k < 2; ++k) {
    world = dart::simulation::World::create();
    world->setGravity({0, 0, -10});
    world->setTimeStep(k == 0 ? 4e-4 : 1e-4);
    BodyNode *first[2], *second[2];
    for (int i = 0; i < 2; ++i) {
      first[i] = body({0, 1, 0});
      second[i] = body({0, 3, 0});
    }
    add<joints::spherical_joint>({0, 0, 0, 0, -1, 0}, nullptr, first[0]);
    add<joints::spherical_joint>({0.3, 1, 0, 0.3, -1, 0}, first[0], second[0]);
    const auto solver = world->getConstraintSolver();
    solver->addConstraint(std::make_shared<dart::constraint::BallJointConstraint>(first[1], Vector3d(0, 0, 0)));
    solver->addConstraint(
        std::make_shared<dart::constraint::BallJointConstraint>(first[1], second[1], Vector3d(0.3, 2, 0)));
    Apart bodies{second[0], second[1]};
    for (int n = 0; n * world->getTimeStep() < 0.6; ++n, bodies.look()) world->step();
    EXPECT_GT(bodies.moved, 1);
    apart[k] = bodies.apart;
  }
  EXPECT_LT(apart[1], 1e-6);
  EXPECT_NEAR(apart[0] / apart[1], 16, 3);
}

// A loop of four links in one skeleton, closed by spherical and by BallJointConstraint.
TEST_F(DartJoints, ClosesALoopOfOneSkeletonAsDartsOwn) {
  world->setTimeStep(1e-4);
  BodyNode* last[2];
  for (int k = 0; k < 2; ++k) {
    const auto skeleton = dart::dynamics::Skeleton::create("loop" + std::to_string(k));
    BodyNode* const crank = hinged(skeleton, nullptr, {0, 0, 0}, {0, 1, 0});
    BodyNode* const rod = hinged(skeleton, crank, {0, 1, 0}, {0, 0, -1});
    last[k] = hinged(skeleton, rod, {0, 0, -1}, {0, -1.5, 0});
    BodyNode* const other = hinged(skeleton, crank, {0, -1, 0}, {0, 0, -1});
    if (k == 0) add<joints::spherical_joint>({0, -0.5, 0, 0, 0, -1}, last[k], other);
    else
      world->getConstraintSolver()->addConstraint(std::make_shared<dart::constraint::BallJointConstraint>(
          last[k], other, last[k]->getWorldTransform() * Vector3d(0, -0.5, 0)));
  }
  Apart bodies{last[0], last[1]};
  for (int n = 0; n < 7000; ++n, bodies.look()) world->step();
  EXPECT_GT(bodies.moved, 0.4);
  EXPECT_LT(bodies.apart, 1e-6);
}

// A double pendulum of free bodies, beside one whose hinges are DART's coordinates.
TEST_F(DartJoints, AHingeMovesAsARevoluteJointOfTheTree) {
  world->setTimeStep(1e-4);
  const auto tree = dart::dynamics::Skeleton::create("tree");
  BodyNode* const upper = hinged(tree, nullptr, {0, 0, 0}, {0, 1, 0});
  BodyNode* const lower = hinged(tree, upper, {0, 1, 0}, {0, 1, 0});
  BodyNode *const first = body({0, 1, 0}), *const second = body({0, 3, 0});
  complete(add<joints::hinge_joint>(hinge_at({0, 0, 0}), nullptr, first));
  complete(add<joints::hinge_joint>(hinge_at({0, 1, 0}), first, second));
  run(1);
  EXPECT_GT((place(second) - Vector3d(0, 3, 0)).norm(), 3);
  EXPECT_LT((place(second) - place(lower)).norm(), 1e-2);
}

TEST_F(DartJoints, MotorsAndLimitsOfACoordinate) {
  world->setGravity({0, 0, 0});
  BodyNode* const b = body({0, 0, 0});
  auto& hinge = complete(add<joints::hinge_joint>(hinge_at({0, 0, 0}), nullptr, b));
  hinge.angle().speed = 4;
  hinge.angle().most = 0.6;  // 2 rad/s^2 about the axis of inertia 0.3
  run(1);
  EXPECT_NEAR(spin(b).x(), 2, 1e-6);
  run(2);
  EXPECT_NEAR(spin(b).x(), 4, 1e-6);
  EXPECT_NEAR(hinge.impulses()[5], 0, 1e-6) << "at its speed the motor rests";
  hinge.angle().upper = 4 * pi;  // beyond a whole turn
  run(3);
  EXPECT_NEAR(spin(b).x(), 0, 1e-6);
  EXPECT_NEAR(b->getWorldTransform().linear()(1, 1), 1, 1e-6);
  hinge.angle().speed = -1;
  run(1);
  EXPECT_NEAR(spin(b).x(), -1, 1e-6) << "a limit does not hold back";
}

// A mass on a soft rod sags by g / w^2, whatever the mass.
TEST_F(DartJoints, SoftRowsHaveTheirFrequency) {
  for (const double mass : {0.1, 50.0}) {
    BodyNode* const b = body({0, 0, -2}, mass);
    joints::distance_joint::Parameters p{};
    p.l = 2;
    add<joints::distance_joint>(p, nullptr, b).stiffness.hertz = 2;
    run(4);
    const double w = 2 * pi * 2;
    EXPECT_NEAR(-2 - place(b).z(), 10 / (w * w), 1e-6) << mass;
  }
}

// Two shafts at 60 degrees; a universal joint would let the second one run between half and twice the speed.
TEST_F(DartJoints, AConstantVelocityJointThatDartLacks) {
  world->setGravity({0, 0, 0});
  const double bend = pi / 3;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(bend, Vector3d::UnitZ()).toRotationMatrix();
  const auto input = dart::dynamics::Skeleton::create("input");
  BodyNode *const a = hinged(input, nullptr, {0, 0, 0}, {0, 0, 0}), *const b = body({0, 0, 0}, 2, R);
  auto p = hinge_at({0, 0, 0});
  p.fa_x_x = p.fa_y_y = std::cos(bend), p.fa_x_y = std::sin(bend), p.fa_y_x = -p.fa_x_y;
  complete(add<joints::hinge_joint>(p, nullptr, b));
  joints::constant_velocity_joint::Parameters shafts{};
  shafts.fa_x_x = shafts.fa_y_y = shafts.fa_z_z = shafts.fb_x_x = shafts.fb_y_y = shafts.fb_z_z = 1;
  add<joints::constant_velocity_joint>(shafts, a, b);
  input->setCommand(0, 0);
  input->getDof(0)->setForce(0);
  double worst = 0;
  for (int n = 0; n < 3000; ++n) {
    input->getDof(0)->setForce(1);
    world->step();
    worst = std::max(worst, std::fabs(spin(b).dot(b->getWorldTransform().linear().col(0)) - input->getVelocity(0)));
  }
  EXPECT_NEAR(input->getVelocity(0), 3 / 0.6, 1e-2) << "a torque of 1 N m turns both";
  EXPECT_LT(worst, 1e-4);
}

// A string: C >= 0, slack until the mass has fallen 1 m.
TEST_F(DartJoints, ABoundOnlyPulls) {
  BodyNode* const b = body({0, 0, 0});
  joints::max_distance_joint::Parameters p{};
  p.l = 1;
  add<joints::max_distance_joint>(p, nullptr, b);
  run(0.25);
  EXPECT_NEAR(b->getLinearVelocity().z(), -2.5, 1e-9) << "it falls freely";
  run(0.75);
  EXPECT_NEAR(place(b).z(), -1, 1e-3);
  EXPECT_NEAR(b->getLinearVelocity().z(), 0, 1e-6);
}

// A bevel gear, driven through many turns: a about x, b about y.
TEST_F(DartJoints, AGearCountsWholeTurns) {
  world->setGravity({0, 0, 0});
  world->setTimeStep(1e-2);
  BodyNode *const a = body({0, 0, 0}), *const b = body({0, 0, 0});
  joints::gear_joint::Parameters p{};
  cdot::test::make_bevel_gear(p);
  auto& gear = add<joints::gear_joint>(p, a, b);
  cdot::test::drive_bevel_gear(gear, spatial::gear::index_of_angle_a_turns);
  double worst = 0;
  for (int n = 0; n < 1200; ++n) {
    world->step();
    worst = std::max(worst, std::fabs(spin(a).x() + 1.3 * spin(b).y()));
  }
  EXPECT_NEAR(spin(a).x(), 12, 1e-6);
  EXPECT_GT(gear.parameters.angle_a_turns, 100);
  EXPECT_LT(worst, 1e-6);
}

// A row that depends on time.
TEST_F(DartJoints, FollowsTime) {
  BodyNode* const b = body({0, 0, 0});
  joints::driven_joint::Parameters p{};
  p.fa_x_x = p.fa_y_y = p.fa_z_z = p.fb_x_x = p.fb_y_y = p.fb_z_z = 1;
  p.rate = 2;
  auto& joint = add<joints::driven_joint>(p, nullptr, b);
  for (; joint.time < 1; joint.time += 1e-3) world->step();
  EXPECT_NEAR(spin(b).x(), 2, 1e-6);
  EXPECT_NEAR(Eigen::AngleAxisd(b->getWorldTransform().linear()).angle(), 2, 3e-3);
  EXPECT_NEAR(joint.impulses()[2], -2 * 10 * 1e-3, 1e-6) << "b carries its weight on a";
}

// Three bodies, two of one skeleton. A force F on c: 2 F / m_c = (1 / m_a + 1 / m_b + 4 / m_c) lambda.
TEST_F(DartJoints, JoinsThreeBodies) {
  world->setGravity({0, 0, 0});
  BodyNode *const a = body({0, 0, 0}, 2), *const c = body({0, 1, 0}, 5);
  dart::dynamics::TranslationalJoint::Properties p;
  p.mT_ParentBodyToJoint.translation() = Vector3d(0, 2, 0);
  p.mName = "slides";
  const auto skeleton = a->getSkeleton();
  BodyNode* const b =
      skeleton->createJointAndBodyNodePair<dart::dynamics::TranslationalJoint>(a, p, BodyNode::AspectProperties("b"))
          .second;
  add_body(skeleton, b, 3);
  add<joints::midpoint_joint>({}, a, b, c);
  c->addExtForce(Vector3d(7, 0, 0));
  world->step();
  const double lambda = 2 * 7. / 5 / (1. / 2 + 1. / 3 + 4. / 5);
  EXPECT_NEAR(a->getLinearVelocity().x(), 1e-3 * lambda / 2, 1e-9);
  EXPECT_NEAR(b->getLinearVelocity().x(), 1e-3 * lambda / 3, 1e-9);
  EXPECT_NEAR(c->getLinearVelocity().x(), 1e-3 * (7 - 2 * lambda) / 5, 1e-9);
  EXPECT_THROW(joints::midpoint_joint({}, a, b, a), std::invalid_argument) << "three of one skeleton";
}

// One sweep a step holds a chain that hangs at rest, since it starts from the impulses of the last step.
TEST_F(DartJoints, StartsSweepsWithTheLastImpulses) {
  const auto sweeps = std::make_shared<dart::constraint::PgsBoxedLcpSolver>();
  sweeps->setOption({1, 0, 0});
  world->setConstraintSolver(std::make_unique<dart::constraint::BoxedLcpConstraintSolver>(sweeps));
  BodyNode* last = nullptr;
  for (int k = 0; k < 10; ++k) {
    BodyNode* const next = body({0, 0, -1. - k});
    add<joints::spherical_joint>({0, 0, k == 0 ? 0 : -0.5, 0, 0, k == 0 ? 1 : 0.5}, last, next);
    last = next;
  }
  run(2);
  EXPECT_NEAR(place(last).z(), -10, 1e-6);
}

}  // namespace
