// Mechanisms in space: the same motion as in the plane, a gyroscope, the lesson's three bodies, and loops with
// redundant hinges.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/rotation.hpp>

#include "runtime/tool/commands/matrix.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::spatial_joints_test {
namespace {

// The tilt of the planes of specs/scenes/spatial.
spatial::Pose<double> tilt() { return spatial::oriented(0.0, 0.0, 0.0, 0.5, 0.1, 0.7, 0.5); }

double far(const spatial::Vector<double>& a, double x, double y, double z) {
  return norm(a - spatial::Vector<double>{x, y, z});
}

// The difference of a planar state, tilted, and a spatial one.
double difference(const BodyState& planar, const BodyState& in_space) {
  const auto turned = [](double x, double y, double z) { return to_world(tilt(), spatial::Vector<double>{x, y, z}); };
  const auto upright =
      spatial::oriented(0.0, 0.0, 0.0, std::cos(planar.angle / 2), 0.0, 0.0, std::sin(planar.angle / 2));
  const auto q = spatial::oriented(0.0, 0.0, 0.0, in_space.e0, in_space.e1, in_space.e2, in_space.e3);
  const auto x_axis = to_world(tilt(), spatial::Vector<double>{upright.xx, upright.yx, 0});
  return std::max({far(turned(planar.x, planar.y, 0), in_space.x, in_space.y, in_space.z),
                   far(turned(planar.vx, planar.vy, 0), in_space.vx, in_space.vy, in_space.vz),
                   far(turned(0, 0, planar.w), in_space.wx, in_space.wy, in_space.wz), far(x_axis, q.xx, q.yx, q.zx)});
}

// Spatial hinges in a tilted plane move like planar ones: the same error at every step and the same order of
// convergence.
TEST(TiltedPlane, MovesAsThePlanarMechanism) {
  struct Case {
    const char* scene;
    double until, step, bound;
  };
  for (const Case& c : {Case{"double_pendulum", 2, 0.001, 1e-10}, Case{"double_pendulum", 2, 0.01, 1e-10},
                        Case{"slider_crank", 0.2, 1e-5, 1e-6},  // at 150 rad/s
                        Case{"four_bar", 10, 0.001, 1e-6}}) {   // past change points
    Scene planar = scene_named(c.scene), in_space = scene_named(std::string("spatial/") + c.scene);
    planar.step = in_space.step = c.step;
    const auto expected = run_of(planar, c.until, c.until / 50), found = run_of(in_space, c.until, c.until / 50);
    ASSERT_EQ(expected.size(), found.size());
    double worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t k = 0; k < found[i].bodies.size(); ++k)
        worst = std::max(worst, difference(expected[i].bodies[k], found[i].bodies[k]));
    fmt::print("  {} at {} s: {:.2e} apart\n", c.scene, c.step, worst);
    EXPECT_LT(worst, c.bound) << c.scene;
  }
}

// With a level axis and the rate m g l / L a top precesses without nutation.
TEST(Gyroscope, PrecessesAtItsRate) {
  double before = 0;
  for (double step : {4e-4, 2e-4, 1e-4}) {
    Scene scene = scene_named("spatial/gyroscope");
    SpatialBodyDefinition& wheel = scene.bodies[0].spatial;
    const double L = wheel.inertia.zz * wheel.wx;  // its z axis lies along the world's x
    const double rate = 9.81 * 0.3 / L;
    wheel.wz = rate;
    wheel.vy = 0.3 * rate;
    scene.step = step;
    const auto frames = run_of(scene, 1, 0.01);
    double off = 0;
    for (const Frame& frame : frames) {
      const BodyState& b = frame.bodies[0];
      const double angle = rate * frame.time;
      off = std::max(off, std::hypot(b.x - 0.3 * std::cos(angle), b.y - 0.3 * std::sin(angle), b.z));
    }
    fmt::print("  h = {:.1e}  off by {:.3e} m\n", step, off);
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / off), 1, 0.1);
    }
    before = off;
  }
  EXPECT_LT(before, 1e-3);
}

using Block = std::vector<std::vector<double>>;

// Rows [row, row + count) of the columns of one body.
Block block_of(const SystemMatrix& system, int row, int count, int body) {
  Block block;
  for (int r = row; r < row + count; ++r) {
    block.emplace_back();
    for (int c = 0; c < 6; ++c) block.back().push_back(system.entry(r, 6 * body + c));
  }
  return block;
}

// The lesson's three bodies: D = [E -~s1 | -E ~s2 | 0 0; 0 -n.~a | 0 -a.~n ... | 0 0; 0 0 | E -~s2
// | -E ~s3], block by block, with s the arms from the mass centres.
TEST(ThreeBodies, DIsThatOfTheLesson) {
  const SystemMatrix system = system_matrix(scene_named("spatial/three_bodies"));
  EXPECT_EQ(system.rows, 7);
  EXPECT_EQ(system.columns, 18);
  EXPECT_EQ(system.rank, 7);
  EXPECT_EQ(system.degrees_of_freedom, 11);
  const Block zero(3, std::vector<double>(6, 0.0));
  const auto near = [](const Block& found, const Block& expected, const char* what) {
    ASSERT_EQ(found.size(), expected.size()) << what;
    for (std::size_t r = 0; r < found.size(); ++r)
      for (int c = 0; c < 6; ++c) EXPECT_NEAR(found[r][c], expected[r][c], 1e-14) << what;
  };
  // [E, -~s] times a sign: the velocity of the point x + s.
  const auto point = [](double sign, double x, double y, double z) {
    return Block{{sign, 0, 0, 0, sign * z, -sign * y},
                 {0, sign, 0, -sign * z, 0, sign * x},
                 {0, 0, sign, sign * y, -sign * x, 0}};
  };
  near(block_of(system, 0, 3, 0), point(1, 0.5, 0.1, 0), "P on 1");
  near(block_of(system, 0, 3, 1), point(-1, -0.5, -0.4, 0), "P on 2");
  near(block_of(system, 0, 3, 2), zero, "P on 3");
  // d/dt (a . n) = (a x n) . (w1 - w2), a = z, n = x: a x n = y
  near(block_of(system, 3, 1, 0), {{0, 0, 0, 0, 1, 0}}, "n1 on 1");
  near(block_of(system, 3, 1, 1), {{0, 0, 0, 0, -1, 0}}, "n1 on 2");
  near(block_of(system, 3, 1, 2), {{0, 0, 0, 0, 0, 0}}, "n1 on 3");
  near(block_of(system, 4, 3, 0), zero, "Q on 1");
  near(block_of(system, 4, 3, 1), point(1, 0.5, 0.5, 0.2), "Q on 2");
  near(block_of(system, 4, 3, 2), point(-1, -0.3, -0.2, -0.2), "Q on 3");
}

TEST(RedundantLoop, NeitherDriftsNorStalls) {
  for (const char* solver : {"direct", "iterative"}) {
    Scene scene = scene_named("spatial/four_bar");
    scene.settings.solver = std::string(solver) == "direct" ? Solver::direct : Solver::iterative;
    scene.settings.iterations = 30;
    RunOptions options;
    std::string warnings;
    const RunResult result = simulate(scene, options, warnings);
    fmt::print("  {}: worst |C| {:.2e}, energy off by {:.2e} J\n", solver, result.worst_error, result.energy_drift);
    EXPECT_TRUE(result.finite);
    EXPECT_LT(result.worst_error, std::string(solver) == "direct" ? 1e-11 : 1e-3);
    EXPECT_LT(result.energy_drift, 0.1);
    if (std::string(solver) == "direct") {
      EXPECT_EQ(result.redundant_rows, 3);
    }
  }
}

}  // namespace
}  // namespace cdot::test::spatial_joints_test
