// Scenes in space: compared with elliptic functions and with the same mechanisms in the plane; their files.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/tool/run/output.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::spatial_test {
namespace {

// Compared with elliptic functions: second order, because only the turning tensor acts.
TEST(TorqueFreeBody, FollowsTheEllipticFunctions) {
  const Reference reference = read_reference("torque_free_body", 20);
  double before = 0, now = 0;
  for (double step : {0.02, 0.01, 0.005, 0.0025}) {
    Scene scene = scene_named("spatial/torque_free_body");
    scene.step = step;
    now = distance_to(reference, scene).largest();
    fmt::print("  h = {:.4f}  off by {:.3e}", step, now);
    if (before > 0) {
      const double slope = std::log2(before / now);
      fmt::print("  slope {:.3f}", slope);
      EXPECT_NEAR(slope, 2, 0.1);
    }
    fmt::print("\n");
    before = now;
  }
  EXPECT_LT(now, 1e-4);
}

TEST(SpatialScene, ColumnsOfTheTrajectory) {
  const Scene scene = scene_named("spatial/torque_free_body");
  EXPECT_EQ(csv_head(scene),
            "time,body.x,body.y,body.z,body.e0,body.e1,body.e2,body.e3,body.vx,body.vy,body.vz,"
            "body.wx,body.wy,body.wz\n");
  Frame frame;
  frame.time = 0.5;
  frame.bodies.push_back({});
  EXPECT_EQ(csv_row(scene, frame), "0.5,0,0,0,1,0,0,0,0,0,0,0,0,0\n");
}

// Between two steps the orientation follows the motion to fourth order.
TEST(SpatialScene, FramesBetweenSteps) {
  Scene scene = scene_named("spatial/torque_free_body");
  const Frame fine = run_of(scene, 0.5, 0.25)[1];
  double before = 0;
  for (double step : {0.2, 0.1, 0.05}) {
    const auto at = [&](double time) {
      scene.step = 0.25 / 4096;
      return run_of(scene, time, time).back();
    };
    const Frame middle = between(at(0.25 - step / 2), at(0.25 + step / 2), 0.25);
    const BodyState &a = middle.bodies[0], &b = fine.bodies[0];
    const double off = std::hypot(std::hypot(a.e0 - b.e0, a.e1 - b.e1), std::hypot(a.e2 - b.e2, a.e3 - b.e3));
    if (before > 0) {
      EXPECT_LT(off, before);
    }
    before = off;
  }
  EXPECT_LT(before, 2e-5);
}

Scene one_body(const std::string& lines) {
  return read_scene("dimension = 3\n[[body]]\nname = \"b\"\nmass = 2\n" + lines, "b.toml");
}

TEST(SpatialScene, OrientationAndInertiaInEveryWayOfWritingThem) {
  const Scene turned = one_body("inertia = 1\naxis = [0, 0, 2]\nangle = \"90 deg\"\n");
  EXPECT_NEAR(turned.bodies[0].spatial.e0, std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(turned.bodies[0].spatial.e3, std::sqrt(0.5), 1e-15);
  const Scene quaternion = one_body("inertia = [1, 2, 2.5]\norientation = [0, 2, 0, 0]\n");
  EXPECT_EQ(quaternion.bodies[0].spatial.e1, 2);
  EXPECT_EQ(quaternion.bodies[0].spatial.inertia.zz, 2.5);
  const Scene tensor = one_body("inertia = [[2, 0.1, 0], [0.1, 2, 0.2], [0, 0.2, 3]]\n");
  EXPECT_EQ(tensor.bodies[0].spatial.inertia.xy, 0.1);
  EXPECT_EQ(tensor.bodies[0].spatial.inertia.yz, 0.2);
  EXPECT_DOUBLE_EQ(one_body("shape = { ball = 0.5 }\n").bodies[0].spatial.inertia.xx, 0.2);
  EXPECT_DOUBLE_EQ(one_body("shape = { box = [1, 2, 3] }\n").bodies[0].spatial.inertia.xx, 2 * 13.0 / 12);
  EXPECT_DOUBLE_EQ(one_body("shape = { disc = 1, width = 0.2 }\n").bodies[0].spatial.inertia.zz, 1);
}

}  // namespace
}  // namespace cdot::test::spatial_test
