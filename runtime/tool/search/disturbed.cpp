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

void disturb_pose(SceneBody& body, Shares& shares) {
  const auto planar = [&](auto& at) { shares.disturb(at.x, at.y, at.angle); };
  const auto spatial = [&](auto& at) { shares.disturb(at.x, at.y, at.z, at.e0, at.e1, at.e2, at.e3); };
  planar(body.definition), planar(body.planar_start.place);
  spatial(body.spatial), spatial(body.spatial_start.place);
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
