// f(double&) for every number of a scene, which f may change.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

template <class F>
void each_number(BodyDefinition& d, F f) {
  for (double* x : {&d.x, &d.y, &d.angle, &d.vx, &d.vy, &d.w, &d.mass, &d.inertia, &d.force_x, &d.force_y, &d.torque,
                    &d.linear_damping, &d.angular_damping})
    f(*x);
}

template <class F>
void each_number(SpatialBodyDefinition& d, F f) {
  for (double* x : {&d.x,
                    &d.y,
                    &d.z,
                    &d.e0,
                    &d.e1,
                    &d.e2,
                    &d.e3,
                    &d.vx,
                    &d.vy,
                    &d.vz,
                    &d.wx,
                    &d.wy,
                    &d.wz,
                    &d.mass,
                    &d.inertia.xx,
                    &d.inertia.yy,
                    &d.inertia.zz,
                    &d.inertia.xy,
                    &d.inertia.xz,
                    &d.inertia.yz,
                    &d.force_x,
                    &d.force_y,
                    &d.force_z,
                    &d.torque_x,
                    &d.torque_y,
                    &d.torque_z,
                    &d.linear_damping,
                    &d.angular_damping})
    f(*x);
}

template <class F>
void each_number(Softness& s, F f) {
  for (double* x : {&s.frequency, &s.damping_ratio, &s.stiffness, &s.damping}) f(*x);
}

// f(NamedValue&) for those of the joint and of effects of specs on its coordinates.
template <class F>
void each_value(SceneJoint& joint, F f) {
  for (NamedValue& value : joint.definition.parameters) f(value);
  for (CoordinateEffects& effects : joint.effects)
    for (SpecEffect& spec : effects.specs)
      for (NamedValue& value : spec.parameters) f(value);
}

template <class F>
void each_number(CoordinateEffects& effects, F f) {
  if (effects.limit)
    for (auto* end : {&effects.limit->lower, &effects.limit->upper})
      if (*end) f(**end);
  if (effects.motor) {
    f(effects.motor->speed);
    if (effects.motor->max_force != unlimited) f(effects.motor->max_force);
  }
  for (CoordinateSpring& spring : effects.springs) {
    each_number(spring.softness, f);
    if (spring.rest) f(*spring.rest);
  }
  if (effects.friction) f(effects.friction->max_force);
  if (effects.load) f(effects.load->force);
}

template <class F>
void each_number(SceneJoint& joint, F f) {
  each_value(joint, [&](NamedValue& value) {
    for (double& x : value.numbers) f(x);
  });
  for (CoordinateEffects& effects : joint.effects) each_number(effects, f);
  if (joint.definition.soft) each_number(*joint.definition.soft, f);
}

template <class F>
void each_number(SpringDefinition& s, F f) {
  for (double* x : {&s.ax, &s.ay, &s.az, &s.bx, &s.by, &s.bz, &s.stiffness, &s.rest_length, &s.damping}) f(*x);
}

// All except the duration, which depends on the step.
template <class F>
void each_number_of_settings(Scene& scene, F f) {
  Settings& s = scene.settings;
  for (double* x : {&scene.step, &s.gravity_x, &s.gravity_y, &s.gravity_z, &s.local_error, &s.sleep_after}) f(*x);
}

template <class F>
void each_number(Scene& scene, F f) {
  each_number_of_settings(scene, f);
  for (SceneBody& body : scene.bodies) each_number(body.definition, f), each_number(body.spatial, f);
  for (SceneJoint& joint : scene.joints) each_number(joint, f);
  for (SpringDefinition& spring : scene.springs) each_number(spring, f);
}

}  // namespace cdot::torture
