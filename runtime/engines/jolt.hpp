// A joint as a constraint of Jolt: a TwoBodyConstraint that any PhysicsSystem takes by AddConstraint().
//
// Impulses are warm-started and sleep, islands, priorities, numbers of steps and saved states work as for Jolt's own.
// In a rigid joint Jolt's position solver closes gaps, by its Baumgarte factor. Points of `parameters` are from the
// centres of mass; directions are those of the bodies. Body::sFixedToWorld is the world.
#pragma once

#include <Jolt/Jolt.h>
#include <Jolt/Physics/Body/Body.h>
#include <Jolt/Physics/Constraints/TwoBodyConstraint.h>
#include <Jolt/Physics/StateRecorder.h>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"

namespace cdot::jolt {

// Of the base class; an emitted joint has its numbers in itself, so it is not made from settings.
class Settings final : public JPH::TwoBodyConstraintSettings {
 public:
  JPH::TwoBodyConstraint* Create(JPH::Body&, JPH::Body&) const override { return nullptr; }
};

inline spatial::Pose<float> pose_of(const JPH::Body& body) {
  const JPH::RVec3 x = body.GetCenterOfMassPosition();
  const JPH::Quat e = body.GetRotation();
  return plain::pose<float>(float(x.GetX()), float(x.GetY()), float(x.GetZ()), e.GetW(), e.GetX(), e.GetY(), e.GetZ());
}
inline spatial::InverseMass<float> inverse_mass_of(const JPH::Body& body) {
  if (!body.IsDynamic()) return {};
  const JPH::Mat44 I = body.GetInverseInertia();
  return {body.GetMotionProperties()->GetInverseMass(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
}

// With `stiffness` and `drives` of plain::Joint.
template <class Block, class... Coordinates>
class Constraint : public JPH::TwoBodyConstraint, public plain::Joint<float, Block, Coordinates...> {
  static_assert(Block::bodies <= 2, "a constraint of Jolt joins two bodies");
  using Plain = plain::Joint<float, Block, Coordinates...>;
  static constexpr int bodies = Block::bodies;

 public:
  JPH_OVERRIDE_NEW_DELETE
  using Parameters = typename Block::template Parameters<float>;

  float time = 0;  // yours to set before a step, where C depends on time

  // The bodies a and b of the joint; of a joint of one body, b is Body::sFixedToWorld.
  Constraint(JPH::Body& a, JPH::Body& b, const Parameters& p) : TwoBodyConstraint(a, b, Settings()) {
    this->parameters = p;
    this->stiffness.error_reduction = 0;
  }

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) {
    read_poses();
    Plain::by_default(first, q_, time);
  }

  JPH::EConstraintSubType GetSubType() const override { return JPH::EConstraintSubType::User1; }
  void NotifyShapeChanged(const JPH::BodyID& id, JPH::Vec3Arg moved) override {
    for (int i = 0; i < bodies; ++i)
      if (body(i).GetID() == id) Block::move_origin(this->parameters, i, {moved.GetX(), moved.GetY(), moved.GetZ()});
  }
  void ResetWarmStart() override { this->forget(); }

  void SetupVelocityConstraint(float h) override {
    read_poses();
    this->prepare(q_, m_, time, h);
  }
  void WarmStartVelocityConstraint(float ratio) override {
    if (!(ratio > 0)) this->forget();  // prepare() minds the length of the step
    read_velocities();
    this->warm_start(m_, v_);
    write_velocities();
  }
  bool SolveVelocityConstraint(float) override {
    read_velocities();
    this->solve(m_, v_);
    write_velocities();
    return true;
  }
  bool SolvePositionConstraint(float, float baumgarte) override {
    read_poses();
    spatial::Velocity<float> shift[bodies] = {};
    const float worst = this->correct(q_, m_, time, baumgarte, shift);
    for (int i = 0; i < bodies; ++i) {
      if (!body(i).IsDynamic()) continue;
      body(i).AddPositionStep({shift[i].x, shift[i].y, shift[i].z});
      body(i).AddRotationStep({shift[i].wx, shift[i].wy, shift[i].wz});
    }
    return worst > 0;
  }

  void SaveState(JPH::StateRecorder& stream) const override {
    TwoBodyConstraint::SaveState(stream);
    stream.WriteBytes(static_cast<const Plain*>(this), sizeof(Plain));
  }
  void RestoreState(JPH::StateRecorder& stream) override {
    TwoBodyConstraint::RestoreState(stream);
    stream.ReadBytes(static_cast<Plain*>(this), sizeof(Plain));
  }
  JPH::Ref<JPH::ConstraintSettings> GetConstraintSettings() const override {
    auto* settings = new Settings;
    ToConstraintSettings(*settings);
    return settings;
  }
  JPH::Mat44 GetConstraintToBody1Matrix() const override { return JPH::Mat44::sIdentity(); }
  JPH::Mat44 GetConstraintToBody2Matrix() const override { return JPH::Mat44::sIdentity(); }
#ifdef JPH_DEBUG_RENDERER
  void DrawConstraint(JPH::DebugRenderer*) const override {}
#endif

 private:
  JPH::Body& body(int i) const { return i == 0 ? *mBody1 : *mBody2; }
  void read_poses() {
    for (int i = 0; i < bodies; ++i) {
      q_[i] = pose_of(body(i));
      m_[i] = inverse_mass_of(body(i));
    }
  }
  void read_velocities() {
    for (int i = 0; i < bodies; ++i) {
      const JPH::Vec3 v = body(i).GetLinearVelocity(), w = body(i).GetAngularVelocity();
      v_[i] = {v.GetX(), v.GetY(), v.GetZ(), w.GetX(), w.GetY(), w.GetZ()};
    }
  }
  void write_velocities() {
    for (int i = 0; i < bodies; ++i) {
      if (!body(i).IsDynamic()) continue;
      body(i).GetMotionProperties()->SetLinearVelocity({v_[i].x, v_[i].y, v_[i].z});
      body(i).GetMotionProperties()->SetAngularVelocity({v_[i].wx, v_[i].wy, v_[i].wz});
    }
  }

  spatial::Pose<float> q_[bodies];
  spatial::InverseMass<float> m_[bodies];
  spatial::Velocity<float> v_[bodies];
};

}  // namespace cdot::jolt
