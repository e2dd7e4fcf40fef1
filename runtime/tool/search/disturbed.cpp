#include "runtime/tool/search/disturbed.hpp"

#include <cmath>

namespace cdot {
namespace {

// Shares between -size and size, spread evenly and in no order.
class Shares {
 public:
  explicit Shares(double size) : size_(size) {}
  double next() { return size_ * (2 * std::fmod(golden * ++count_, 1.0) - 1); }
  void disturb(auto&... numbers) { ((numbers *= 1 + next()), ...); }

 private:
  static constexpr double golden = 0.6180339887498949;
  double size_;
  int count_ = 0;
};

void disturb_masses(SceneBody& body, Shares& shares) {
  shares.disturb(body.definition.mass, body.definition.inertia, body.spatial.mass);
  Inertia& inertia = body.spatial.inertia;
  const double factor = 1 + shares.next();  // of all, so that a rigid body can have it
  for (double* number : {&inertia.xx, &inertia.yy, &inertia.zz, &inertia.xy, &inertia.xz, &inertia.yz})
    *number *= factor;
}

// That which a body has without the coordinates of joints.
void start_as_written(SceneBody& body) {
  const BodyDefinition& d = body.definition;
  const SpatialBodyDefinition& s = body.spatial;
  body.planar_start = {{d.x, d.y, d.angle}, {d.vx, d.vy, d.w}};
  body.spatial_start = {{s.x, s.y, s.z, s.e0, s.e1, s.e2, s.e3}, {s.vx, s.vy, s.vz, s.wx, s.wy, s.wz}};
  body.started = true;
}

// The written pose stays: defaults of joints follow from it. Beside it the direction between two points that coincide
// would be any.
void disturb_pose(SceneBody& body, Shares& shares) {
  if (!body.started) start_as_written(body);
  auto& planar = body.planar_start.place;
  auto& spatial = body.spatial_start.place;
  shares.disturb(planar.x, planar.y, planar.angle);
  shares.disturb(spatial.x, spatial.y, spatial.z, spatial.e0, spatial.e1, spatial.e2, spatial.e3);
}

}  // namespace

Scene with_disturbed_masses(Scene scene, double size) {
  Shares shares(size);
  for (SceneBody& body : scene.bodies)
    if (!body.is_static) disturb_masses(body, shares);
  return scene;
}

Scene disturbed(Scene scene, double size) {
  scene = with_disturbed_masses(std::move(scene), size);
  Shares shares(size);
  for (SceneBody& body : scene.bodies)
    if (!body.is_static) disturb_pose(body, shares);
  return scene;
}

}  // namespace cdot
