// The parts of a Bullet world for both of its kinds of bodies. Shapes never collide.
#pragma once

#include <btBulletDynamicsCommon.h>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

static_assert(sizeof(btScalar) == sizeof(double));

inline btVector3 bt(const Vec3& a) { return {a[0], a[1], a[2]}; }
inline btQuaternion bt(const Quaternion& q) { return {q[1], q[2], q[3], q[0]}; }
inline Vec3 from(const btVector3& a) { return {a.x(), a.y(), a.z()}; }
inline Quaternion from(const btQuaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }

struct BulletParts {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btEmptyShape shape;
};

template <class World>
class Untouched final : public World {
 public:
  using World::World;
  bool collides = false;
  void performDiscreteCollisionDetection() override {
    if (collides) World::performDiscreteCollisionDetection();
  }
};

}  // namespace cdot::peers
