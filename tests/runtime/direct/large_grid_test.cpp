// Grids of discs with so many redundant rows that elimination cannot identify them. Contradictions are distributed as
// in small systems, and a saved state continues with the same bits.
#include <cmath>
#include <fmt/core.h>

#include <cdot/snapshot.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr int side = 25;  // 618 discs that move, 2388 rows, 534 of them redundant
constexpr double h = 1.0 / 60;

// Each disc is pinned to its right and its lower neighbour. Seven discs at the top are static; the pin right of the
// middle is 1 cm off. Returns the discs, and the pins of each.
template <class T>
std::vector<std::pair<int, std::vector<int>>> add_grid(World<T>& world) {
  const double radius = 0.4, mass = pi * radius * radius;
  std::vector<std::pair<int, std::vector<int>>> discs;
  for (int k = 0; k < side * side; ++k) {
    const int column = k % side, row = k / side;
    const bool still = row == 0 && std::abs(column - side / 2) <= 3;
    discs.push_back({world.add_body({.x = double(column),
                                     .y = -double(row),
                                     .mass = mass,
                                     .inertia = mass * radius * radius / 2,
                                     .is_static = still}),
                     {}});
    const auto pin = [&](int other, double ax, double ay, double bx, double by) {
      const int joint = revolute(world, discs[other].first, discs[k].first, ax, ay, bx, by);
      discs[other].second.push_back(joint);
      discs[k].second.push_back(joint);
    };
    if (column > 0) pin(k - 1, k - 1 == side * side / 2 ? 0.51 : 0.5, 0, -0.5, 0);
    if (row > 0) pin(k - side, 0, -0.5, 0, 0.5);
  }
  return discs;
}

template <class T>
double squares(const World<T>& world, const std::vector<int>& joints) {
  double sum = 0;
  for (int joint : joints)
    for (double error : world.position_error(joint)) sum += error * error;
  return sum;
}

// No small displacement or rotation of a single disc reduces the sum of squares, and the remaining C stays constant.
TEST(LargeGrid, WithAWrongPinRestsWhereSquaresAreLeast) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  const auto discs = add_grid(world);
  for (int k = 0; k < 4; ++k) world.step(h);
  EXPECT_EQ(world.redundant_rows(), 534);
  const double gap = world.worst_position_error().value;
  EXPECT_GT(gap, 5e-4);
  world.step(h);
  EXPECT_NEAR(world.worst_position_error().value, gap, 1e-9);
  double total = 0;
  for (const auto& [disc, pins] : discs) {
    total += squares(world, pins) / 2;
    if (world.inverse_mass(disc).m == 0) continue;
    const auto rest = world.pose(disc);
    const double least = squares(world, pins);
    for (int i = 0; i < 3; ++i) {
      for (const double by : {1e-5, -1e-5}) {
        world.set_pose(disc, {rest.x + (i == 0) * by, rest.y + (i == 1) * by, rest.angle + (i == 2) * by});
        EXPECT_GT(squares(world, pins), least) << "disc " << disc << ", direction " << i << " by " << by;
      }
    }
    world.set_pose(disc, {rest.x, rest.y, rest.angle});
  }
  fmt::print("  worst gap {:.6e} m, sum of squares {:.6e} m^2\n", gap, total);
}

TEST(LargeGrid, GoesOnFromASnapshotWithTheSameBits) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = Integrator::rattle;  // its step begins with the last step's factor
  World<double> one(s), other(s);
  add_grid(one), add_grid(other);
  one.step(h);
  other.restore(one.snapshot());
  one.step(h), other.step(h);
  EXPECT_EQ(one.snapshot(), other.snapshot());
}

}  // namespace
}  // namespace cdot::test
