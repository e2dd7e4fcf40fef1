// A custom Simbody force that damps one body's motion relative to the world; Simbody has none.
#pragma once

#include <Simbody.h>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

inline SimTK::Vec3 vec(const Vec3& a) { return {a[0], a[1], a[2]}; }
inline Vec3 vec(const SimTK::Vec3& a) { return {a[0], a[1], a[2]}; }

class BodyDamper final : public SimTK::Force::Custom::Implementation {
 public:
  BodyDamper(const SimTK::MobilizedBody& on, const Body& body) : on_(on), body_(body) {}
  void calcForce(const SimTK::State& s, SimTK::Vector_<SimTK::SpatialVec>& on_bodies, SimTK::Vector_<SimTK::Vec3>&,
                 SimTK::Vector&) const override {
    const SimTK::Quaternion q = on_.getBodyRotation(s).convertRotationToQuaternion();
    const Push push = damping(
        body_, {{}, {q[0], q[1], q[2], q[3]}, vec(on_.getBodyOriginVelocity(s)), vec(on_.getBodyAngularVelocity(s))});
    on_.applyBodyTorque(s, vec(push.torque), on_bodies);
    on_.applyForceToBodyPoint(s, SimTK::Vec3(0), vec(push.force), on_bodies);
  }
  SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0; }

 private:
  const SimTK::MobilizedBody on_;
  const Body& body_;
};

}  // namespace cdot::peers
