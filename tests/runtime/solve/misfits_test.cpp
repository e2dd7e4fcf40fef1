// The size from which C is an error of a row: in m, in rad and in m^2, near the origin and far away, at any size.
#include "runtime/solve/misfits.hpp"

#include <cmath>

#include "runtime/solve/reach.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

// A bar on a pin at the end of its arm, which an angle joint locks: rows in m, and one in rad.
struct Locked {
  World<double> world{settings(Solver::direct)};
  int pin, angle;

  Locked(double arm, double x) {
    const int bar = world.add_body({.x = x, .mass = 2, .inertia = arm * arm});
    pin = world.add_joint({"revolute", {world.ground(), bar}, {{"pa", {x - arm, 0}}, {"pb", {-arm, 0}}}, {}});
    angle = world.add_joint({"angle", {world.ground(), bar}, {}, {}});
    EXPECT_TRUE(world.step(1e-3));
  }
  Island<Planar<double>>& island() { return world.data().islands.front(); }
  Batch<Planar<double>>& batch_of(int joint) {
    const auto& data = world.data();
    return *data.batches[static_cast<std::size_t>(data.joints[static_cast<std::size_t>(joint)].places[0].batch)];
  }
  // As after a step at whose end each row of the joint misses so much, and at whose start none did.
  void open(int joint, double by) {
    for (const auto& segment : island().segments) {
      auto& error = segment.batch->error;
      std::fill(error.begin(), error.end(), 0.0);
    }
    auto& error = batch_of(joint).error;
    std::fill(error.begin(), error.end(), by);
    island().residual = by, island().misfit = 0;
    note_errors(island());
  }
};

TEST(Misfits, TurnsAreNoLengths) {
  for (const double arm : {1e-6, 1.0, 1e6}) {
    Locked bar(arm, 0);
    const auto apart = [&](int joint, double by) {
      bar.open(joint, by);
      return left_the_joints(bar.world.data(), bar.island(), 0.0);
    };
    EXPECT_TRUE(apart(bar.angle, 1e-7)) << arm;  // rad
    EXPECT_FALSE(apart(bar.angle, 1e-9)) << arm;
    EXPECT_TRUE(apart(bar.pin, 1e-6 * arm)) << arm;
    EXPECT_FALSE(apart(bar.pin, 1e-9 * arm)) << arm;
  }
}

TEST(Misfits, PlacesFarAwayBlurNoAngle) {
  for (const double x : {0.0, 1e8}) {
    Locked bar(1, x);
    const auto fits = [&](int joint, double by) {
      bar.open(joint, by);
      return left_round_off(bar.world.data(), bar.island());
    };
    EXPECT_FALSE(fits(bar.angle, 1e-12)) << x;  // rad
    EXPECT_TRUE(fits(bar.angle, 1e-14)) << x;
    EXPECT_EQ(fits(bar.pin, 1e-8), x > 0) << x;  // a bit of x = 1e8 m is 1.5e-8 m
    bar.open(bar.angle, 1e-7);
    EXPECT_TRUE(left_misfits(bar.world.data(), bar.island())) << x;
  }
}

// C = u u - l^2 [m^2] changes by 2 l per metre: the most that a displacement by the size makes of it, and its
// round-off, against differences.
TEST(Misfits, SquaredLengthsRoundByTheirSlope) {
  constexpr double l = 800;
  SpatialWorld<double> world(settings(Solver::direct));
  SpatialBodyDefinition d;
  d.mass = 2, d.inertia = {1, 1, 1}, d.x = l;
  const int body = world.add_body(d);
  const int rod = world.add_joint(
      {"spherical_spherical", {world.ground(), body}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"l", {l}}}, {}});
  EXPECT_TRUE(world.step(1e-6));
  auto& data = world.data();
  auto& island = data.islands.front();
  const auto& batch =
      *data.batches[static_cast<std::size_t>(data.joints[static_cast<std::size_t>(rod)].places[0].batch)];
  Reach<double> reach[most_rows];
  find_reaches(data, island, batch, 0, reach);
  const double step = 1e-3;
  auto place = world.place(body);
  place.x += step;
  world.set_pose(body, place);
  const double slope = std::abs(world.position_error(rod)[0]) / step;
  EXPECT_NEAR(reach[0].motion, slope * double(island.size), 1e-4 * reach[0].motion);
  EXPECT_NEAR(reach[0].round_off,
              64 * std::numeric_limits<double>::epsilon() * slope * std::max(l, double(island.size)),
              1e-4 * reach[0].round_off);
}

}  // namespace
}  // namespace cdot::test
