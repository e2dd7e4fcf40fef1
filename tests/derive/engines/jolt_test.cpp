// Emitted joints in Jolt, beside Jolt's own and closed forms.
// clang-format off
#include <Jolt/Jolt.h>  // before all others of Jolt
// clang-format on
#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/Constraints/HingeConstraint.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/StateRecorderImpl.h>
#include <Jolt/RegisterTypes.h>
#include <gtest/gtest.h>

#include "jolt/constant_velocity.hpp"
#include "jolt/distance.hpp"
#include "jolt/gear.hpp"
#include "jolt/hinge.hpp"
#include "tests/derive/engines/bevel_gear.hpp"

namespace {

namespace jolt = cdot::jolt;
namespace spatial = cdot::spatial;
using JPH::Vec3;

// One layer, in which nothing collides.
class OneLayer final : public JPH::BroadPhaseLayerInterface {
 public:
  JPH::uint GetNumBroadPhaseLayers() const override { return 1; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer) const override { return JPH::BroadPhaseLayer(0); }
#if defined(JPH_EXTERNAL_PROFILE) || defined(JPH_PROFILE_ENABLED)
  const char* GetBroadPhaseLayerName(JPH::BroadPhaseLayer) const override { return "one"; }
#endif
};
class NoBroadCollision final : public JPH::ObjectVsBroadPhaseLayerFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer, JPH::BroadPhaseLayer) const override { return false; }
};
class NoCollision final : public JPH::ObjectLayerPairFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer, JPH::ObjectLayer) const override { return false; }
};

class JoltJoints : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory();
    JPH::RegisterTypes();
  }
  JoltJoints() {
    system_.Init(64, 0, 64, 64, layer_, broad_, narrow_);
    system_.SetGravity(Vec3(0, 0, -10));
    JPH::PhysicsSettings settings = system_.GetPhysicsSettings();
    settings.mNumVelocitySteps = 60;
    settings.mNumPositionSteps = 10;
    system_.SetPhysicsSettings(settings);
  }
  JPH::Body& body(Vec3 x, float angle_about_z = 0) {
    JPH::BodyCreationSettings made(new JPH::BoxShape(Vec3(0.5f, 0.3f, 0.2f)), x,
                                   JPH::Quat::sRotation(Vec3::sAxisZ(), angle_about_z), JPH::EMotionType::Dynamic, 0);
    made.mLinearDamping = made.mAngularDamping = 0;
    made.mOverrideMassProperties = JPH::EOverrideMassProperties::CalculateInertia;
    made.mMassPropertiesOverride.mMass = 2;
    JPH::BodyInterface& bodies = system_.GetBodyInterfaceNoLock();
    JPH::Body& body = *bodies.CreateBody(made);
    bodies.AddBody(body.GetID(), JPH::EActivation::Activate);
    body.SetAllowSleeping(false);
    return body;
  }
  void run(float seconds, float h = 1.0f / 240) {
    for (int n = 0; n < int(seconds / h + 0.5f); ++n) system_.Update(h, 1, &temporary_, &jobs_);
  }
  template <class Joint, class... Arguments>
  Joint& add(Arguments&&... arguments) {
    auto* made = new Joint(std::forward<Arguments>(arguments)...);
    system_.AddConstraint(made);
    return *made;
  }

  OneLayer layer_;
  NoBroadCollision broad_;
  NoCollision narrow_;
  JPH::TempAllocatorImpl temporary_{4 << 20};
  JPH::JobSystemSingleThreaded jobs_{256};
  JPH::PhysicsSystem system_;
};

// About the x axis of the world.
jolt::hinge_joint::Parameters hinge_at(Vec3 in_a) {
  jolt::hinge_joint::Parameters p{};
  p.pa_x = in_a.GetX(), p.pa_y = in_a.GetY(), p.pa_z = in_a.GetZ();
  p.fa_x_x = p.fa_y_y = p.fa_z_z = 1;
  return p;
}

TEST_F(JoltJoints, AHingeMovesAsJoltsOwn) {
  JPH::Body &world = JPH::Body::sFixedToWorld, *first[2], *second[2];
  for (int k = 0; k < 2; ++k) {
    first[k] = &body(Vec3(0, 1, 0));
    second[k] = &body(Vec3(0, 3, 0));
  }
  add<jolt::hinge_joint>(world, *first[0], hinge_at(Vec3::sZero())).by_default(spatial::hinge::index_of_pb);
  add<jolt::hinge_joint>(*first[0], *second[0], hinge_at(Vec3(0, 1, 0))).by_default(spatial::hinge::index_of_pb);
  JPH::HingeConstraintSettings own;
  own.mHingeAxis1 = own.mHingeAxis2 = Vec3::sAxisX();
  own.mNormalAxis1 = own.mNormalAxis2 = Vec3::sAxisY();
  system_.AddConstraint(own.Create(world, *first[1]));
  own.mPoint1 = own.mPoint2 = JPH::RVec3(0, 2, 0);
  system_.AddConstraint(own.Create(*first[1], *second[1]));
  float apart = 0, moved = 0;
  for (int n = 0; n < 480; ++n) {
    run(1.0f / 240);
    apart = std::max(apart, Vec3(second[0]->GetPosition() - second[1]->GetPosition()).Length());
    moved = std::max(moved, (Vec3(second[0]->GetPosition()) - Vec3(0, 3, 0)).Length());
  }
  EXPECT_GT(moved, 3);
  EXPECT_LT(apart, 2e-3f);
}

TEST_F(JoltJoints, MotorsLimitsAndSoftness) {
  system_.SetGravity(Vec3::sZero());
  JPH::Body& b = body(Vec3::sZero());
  auto& hinge = add<jolt::hinge_joint>(JPH::Body::sFixedToWorld, b, hinge_at(Vec3::sZero()));
  hinge.by_default(spatial::hinge::index_of_pb);
  const float inertia = 2.0f / 3 * (0.3f * 0.3f + 0.2f * 0.2f);
  hinge.angle().speed = 4;
  hinge.angle().most = 2 * inertia;
  run(1);
  EXPECT_NEAR(b.GetAngularVelocity().GetX(), 2, 1e-3f);
  hinge.angle().upper = 12;  // beyond a turn
  run(4);
  EXPECT_NEAR(b.GetAngularVelocity().GetX(), 0, 1e-3f);
  EXPECT_NEAR((b.GetRotation() * Vec3::sAxisY()).GetY(), std::cos(12.0f), 2e-3f);

  system_.SetGravity(Vec3(0, 0, -10));
  JPH::Body& mass = body(Vec3(0, 0, -2));
  jolt::distance_joint::Parameters p{};
  p.l = 2;
  add<jolt::distance_joint>(JPH::Body::sFixedToWorld, mass, p).stiffness.hertz = 2;
  run(4);
  const float w = 2 * 3.14159265f * 2;
  EXPECT_NEAR(-2 - mass.GetPosition().GetZ(), 10 / (w * w), 1e-3f);
}

// Two shafts at 60 degrees; a universal joint would let the second one run between half and twice the speed.
TEST_F(JoltJoints, AConstantVelocityJointThatJoltLacks) {
  system_.SetGravity(Vec3::sZero());
  const float bend = 3.14159265f / 3;
  JPH::Body &world = JPH::Body::sFixedToWorld, &a = body(Vec3::sZero()), &b = body(Vec3::sZero(), bend);
  auto& input = add<jolt::hinge_joint>(world, a, hinge_at(Vec3::sZero()));
  input.by_default(spatial::hinge::index_of_pb);
  jolt::hinge_joint::Parameters p{};
  p.fa_x_x = p.fa_y_y = std::cos(bend), p.fa_x_y = std::sin(bend), p.fa_y_x = -p.fa_x_y, p.fa_z_z = 1;
  add<jolt::hinge_joint>(world, b, p).by_default(spatial::hinge::index_of_pb);
  jolt::constant_velocity_joint::Parameters shafts{};
  shafts.fa_x_x = shafts.fa_y_y = shafts.fa_z_z = shafts.fb_x_x = shafts.fb_y_y = shafts.fb_z_z = 1;
  add<jolt::constant_velocity_joint>(a, b, shafts);
  input.angle().speed = 3;
  input.angle().most = 20;
  run(1);
  float worst = 0;
  for (int n = 0; n < 480; ++n) {
    run(1.0f / 240);
    const Vec3 shaft = b.GetRotation() * Vec3::sAxisX();
    worst = std::max(worst, std::fabs(b.GetAngularVelocity().Dot(shaft) - a.GetAngularVelocity().GetX()));
  }
  EXPECT_NEAR(a.GetAngularVelocity().GetX(), 3, 1e-2f);
  EXPECT_LT(worst, 1e-2f);
}

// A bevel gear, driven through many turns: a about x, b about y.
TEST_F(JoltJoints, AGearCountsWholeTurns) {
  system_.SetGravity(Vec3::sZero());
  JPH::Body &a = body(Vec3::sZero()), &b = body(Vec3::sZero());
  jolt::gear_joint::Parameters p{};
  cdot::test::make_bevel_gear(p);
  auto& gear = add<jolt::gear_joint>(a, b, p);
  cdot::test::drive_bevel_gear(gear, spatial::gear::index_of_angle_a_turns);
  float worst = 0;
  for (int n = 0; n < 2400; ++n) {
    run(1.0f / 240);
    worst = std::max(worst, std::fabs(a.GetAngularVelocity().GetX() + 1.3f * b.GetAngularVelocity().GetY()));
  }
  EXPECT_NEAR(a.GetAngularVelocity().GetX(), 12, 1e-3f);
  EXPECT_GT(gear.parameters.angle_a_turns, 50);
  EXPECT_LT(worst, 1e-3f);
}

// A saved state has the impulses: the same steps follow, to the bit.
TEST_F(JoltJoints, SavesItsImpulses) {
  JPH::Body& b = body(Vec3(0, 1, 0));
  add<jolt::hinge_joint>(JPH::Body::sFixedToWorld, b, hinge_at(Vec3::sZero())).by_default(spatial::hinge::index_of_pb);
  run(0.5f);
  JPH::StateRecorderImpl saved;
  system_.SaveState(saved);
  run(0.5f);
  const Vec3 once = b.GetPosition();
  saved.Rewind();
  EXPECT_TRUE(system_.RestoreState(saved));
  run(0.5f);
  EXPECT_TRUE(once == b.GetPosition());
}

}  // namespace
