// Emitted joints in Box2D 2.4, beside Box2D's own and closed forms.
#include <box2d/box2d.h>
#include <gtest/gtest.h>
#include <optional>

#include "box2d/distance.hpp"
#include "box2d/revolute.hpp"
#include "box2d/sine_track.hpp"

namespace {

namespace planar = cdot::planar;
using cdot::box2d::distance_joint;
using cdot::box2d::revolute_joint;
using cdot::box2d::sine_track_joint;

struct Box2dJoints : testing::Test {
  b2World world{{0, -10}};
  b2Body& ground = *world.CreateBody(&still());

  static const b2BodyDef& still() {
    static const b2BodyDef definition;
    return definition;
  }
  // A square of 1 m^2 about `middle` in the frame of the body.
  b2Body& body(float x, float y, float mass = 2, b2Vec2 middle = {0, 0}) {
    b2BodyDef definition;
    definition.type = b2_dynamicBody;
    definition.position = {x, y};
    b2Body& made = *world.CreateBody(&definition);
    b2PolygonShape square;
    square.SetAsBox(0.5f, 0.5f, middle, 0);
    made.CreateFixture(&square, mass);
    return made;
  }
  void run(float seconds, float h = 1.0f / 120, int velocity_iterations = 30) {
    for (int n = 0; n < int(seconds / h + 0.5f); ++n) world.Step(h, velocity_iterations, 10);
  }
};

// Two double pendulums whose centres of mass lie off the origins of their bodies.
TEST_F(Box2dJoints, ARevoluteJointMovesAsBox2dsOwn) {
  const b2Vec2 middle(0.2f, 0.1f);
  b2Body *first[2], *second[2];
  for (int k = 0; k < 2; ++k) {
    first[k] = &body(1, 20.0f * float(k), 2, middle);
    second[k] = &body(3, 20.0f * float(k), 2, middle);
  }
  revolute_joint upper(world, ground, *first[0], {}), lower(world, *first[0], *second[0], {1, 0, 0, 0});
  upper.by_default(planar::revolute::index_of_pb);
  lower.by_default(planar::revolute::index_of_pb);
  EXPECT_FLOAT_EQ(lower.parameters.pb_x, -1) << "from the origin of the body";
  b2RevoluteJointDef own;
  own.Initialize(&ground, first[1], {0, 20});
  world.CreateJoint(&own);
  own.Initialize(first[1], second[1], {2, 20});
  world.CreateJoint(&own);
  float apart = 0, moved = 0;
  for (int n = 0; n < 240; ++n) {
    run(1.0f / 120);
    const b2Vec2 between = second[1]->GetPosition() - second[0]->GetPosition() - b2Vec2(0, 20);
    apart = std::max(apart, between.Length());
    moved = std::max(moved, (second[0]->GetPosition() - b2Vec2(3, 0)).Length());
  }
  EXPECT_GT(moved, 3);
  EXPECT_LT(apart, 1e-3f);
}

TEST_F(Box2dJoints, MotorsLimitsAndReactions) {
  b2Body& b = body(0, -1);  // 2 kg, 1/3 kg m^2
  revolute_joint pin(world, ground, b, {0, 0, 0, 1});
  run(1);
  EXPECT_NEAR(pin.GetReactionForce(120).y, 20, 1e-3f) << "it carries the weight";
  EXPECT_NEAR(pin.GetReactionTorque(120), 0, 1e-3f);
  world.SetGravity({0, 0});
  pin.angle().speed = 1;
  pin.angle().most = 7.0f / 3;  // 1 rad/s^2
  b.SetAwake(true);
  run(0.5f);
  EXPECT_NEAR(b.GetAngularVelocity(), 0.5f, 1e-3f);
  EXPECT_NEAR(pin.GetReactionTorque(120) + pin.GetReactionForce(120).x, 7.0f / 3, 0.1f) << "the motor about the pin";
  pin.angle().upper = 7;  // beyond a turn
  run(8);
  EXPECT_NEAR(b.GetAngle(), 7, 1e-3f);
  EXPECT_NEAR(b.GetAngularVelocity(), 0, 1e-4f);
}

// Warm starting finds the impulse of a resting chain with one sweep a step; without it the chain sags.
TEST_F(Box2dJoints, WarmStartingIsTheWorlds) {
  float gap[2];
  for (int warm = 0; warm < 2; ++warm) {
    b2World hanging({0, -10});
    hanging.SetWarmStarting(warm == 1);
    hanging.SetAllowSleeping(false);
    b2Body* last = hanging.CreateBody(&still());
    std::optional<revolute_joint> joints[5];
    for (int k = 0; k < 5; ++k) {
      b2BodyDef definition;
      definition.type = b2_dynamicBody;
      definition.position = {0, -1.0f - float(k)};
      b2Body* next = hanging.CreateBody(&definition);
      b2CircleShape circle;
      circle.m_radius = 0.2f;
      next->CreateFixture(&circle, 1);
      joints[k].emplace(hanging, *last, *next,
                        revolute_joint::Parameters{0, k == 0 ? 0.0f : -0.5f, 0, k == 0 ? 1.0f : 0.5f});
      last = next;
    }
    for (int n = 0; n < 240; ++n) hanging.Step(1.0f / 60, 1, 1);
    gap[warm] = -5 - last->GetPosition().y;
  }
  EXPECT_LT(gap[1], 1e-4f);
  EXPECT_GT(gap[0], 0.01f);
}

// A soft rod sags by g / w^2.
TEST_F(Box2dJoints, SoftRowsHaveTheirFrequency) {
  b2Body& b = body(0, -2, 5);
  distance_joint rod(world, ground, b, {0, 0, 0, 0, 2});
  rod.stiffness.hertz = 2;
  run(4);
  const float w = 2 * b2_pi * 2;
  EXPECT_NEAR(-2 - b.GetPosition().y, 10 / (w * w), 1e-4f);
}

// A pin on a sine curve: no joint of Box2D. Without friction the energy stays.
TEST_F(Box2dJoints, ACurveThatBox2dLacks) {
  b2Body& b = body(0, 0, 1);
  b.SetFixedRotation(true);
  sine_track_joint::Parameters p{};
  p.f_x = p.amplitude = p.k = 1;
  sine_track_joint track(world, b, ground, p);
  run(1.5f, 1.0f / 1000);
  EXPECT_LT(b.GetPosition().x, -1) << "it slides down";
  EXPECT_NEAR(b.GetPosition().y, std::sin(b.GetPosition().x), 1e-4f);
  EXPECT_NEAR(b.GetLinearVelocity().LengthSquared() / 2 + 10 * b.GetPosition().y, 0, 0.05f);
}

// Joints sleep with their islands; bodies that they join do not collide; a joint that ends leaves no trace.
TEST_F(Box2dJoints, LivesInTheListsOfTheWorld) {
  b2Body &a = body(0, 0), &b = body(0.5f, 0);
  a.SetGravityScale(0);
  b.SetGravityScale(0);
  b2RevoluteJointDef own;
  own.Initialize(&ground, &a, {0, 0});
  b2Joint* before = world.CreateJoint(&own);
  {
    revolute_joint pin(world, a, b, {0.25f, 0, -0.25f, 0});
    b2Joint* after = world.CreateJoint(&own);
    EXPECT_EQ(world.GetJointCount(), 3);
    EXPECT_EQ(after->GetNext(), &pin);
    EXPECT_EQ(pin.GetNext(), before);
    run(2);
    EXPECT_EQ(world.GetContactCount(), 0);
    EXPECT_FALSE(a.IsAwake() || b.IsAwake());
    world.DestroyJoint(after);
    EXPECT_EQ(world.GetJointList(), &pin);
    world.DestroyJoint(before);
    EXPECT_EQ(pin.GetNext(), nullptr);
    before = world.CreateJoint(&own);
  }
  EXPECT_EQ(world.GetJointCount(), 1);
  EXPECT_EQ(world.GetJointList(), before);
  EXPECT_EQ(b.GetJointList(), nullptr);
  run(0.1f);
  EXPECT_GT(world.GetContactCount(), 0) << "they collide again";
}

}  // namespace
