// A copy of a scene with another size and mass and the same motion in angles and time: lengths, velocities and gravity
// scale with the size.
#pragma once

#include "runtime/tool/scene/scene.hpp"

namespace cdot::hard {

inline void scale(Scene& scene, double length, double mass) {
  for (SceneBody& body : scene.bodies) {
    BodyDefinition& b = body.definition;
    SpatialBodyDefinition& s = body.spatial;
    for (double* x : {&b.x, &b.y, &s.x, &s.y, &s.z, &b.vx, &b.vy, &s.vx, &s.vy, &s.vz}) *x *= length;
    for (double* m : {&b.mass, &s.mass}) *m *= mass;
    for (double* I : {&b.inertia, &s.inertia.xx, &s.inertia.yy, &s.inertia.zz}) *I *= mass * length * length;
  }
  for (SceneJoint& joint : scene.joints)
    for (NamedValue& value : joint.definition.parameters)
      if (value.name == "pa" || value.name == "pb" || value.name == "l")
        for (double& number : value.numbers) number *= length;
  scene.settings.gravity_y *= length;
  scene.settings.gravity_z *= length;
}

}  // namespace cdot::hard
