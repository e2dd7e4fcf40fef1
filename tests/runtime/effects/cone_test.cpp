// Friction across a plane in space: one force of bounded size along two rows, by closed forms with every integrator.
#include <random>

#include "tests/runtime/effects/spatial_effects.hpp"

namespace cdot::test::in_space {
namespace {

Settings down(Integrator integrator) { return free_fall(integrator, g); }

void put_on_plane(SpatialWorld<double>& world, int body, Vector<double> n, double mu, double radius = 0) {
  world.add_joint({"rough_plane",
                   {body, world.ground()},
                   {{"pb", {0, 0, 0}}, {"f", {n.x, n.y, n.z}}, {"radius", {radius}}, {"mu", {mu}}},
                   {}});
}

void advance(SpatialWorld<double>& world, double duration, double h) {
  for (long k = 0; k < std::lround(duration / h); ++k) ASSERT_TRUE(world.step(h));
}

Vector<double> velocity_of(const SpatialWorld<double>& world, int body) {
  const auto v = world.velocity(body);
  return {v.x, v.y, v.z};
}
// The normal of a plane that falls by `slope` towards the heading `way`.
Vector<double> normal(double slope, double way) {
  return {std::sin(slope) * std::cos(way), std::sin(slope) * std::sin(way), std::cos(slope)};
}
Vector<double> steepest(double slope, double way) {
  return {std::cos(slope) * std::cos(way), std::cos(slope) * std::sin(way), -std::sin(slope)};
}

// a = g (sin(slope) - mu cos(slope)) down the slope, or none where that is negative, to any side.
TEST(Cones, ABlockSlipsAtItsAngleOfFrictionToAnySide) {
  constexpr double mu = 0.4;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double off : {-0.02, 0.02}) {
      for (const double way : {0.0, 0.4, 2.1, 4.0}) {
        const double slope = std::atan(mu) + off;
        SpatialWorld<double> world(down(row.integrator));
        const int block = ball(world, {.mass = 3});
        put_on_plane(world, block, normal(slope, way), mu);
        advance(world, 1, 0.01);
        const double right = off < 0 ? 0 : g * (std::sin(slope) - mu * std::cos(slope));
        EXPECT_LT(norm(velocity_of(world, block) - right * steepest(slope, way)), 1e-8)
            << row.name << ", " << off << " to " << way;
        EXPECT_NEAR(norm(place_of(world, block)), right / 2, row.order == 1 ? 2e-2 : 1e-3) << row.name;
      }
    }
  }
}

// A puck keeps its direction, loses mu g t and stops after v^2/(2 mu g).
TEST(Cones, APuckKeepsItsDirection) {
  constexpr double mu = 0.3, v = 2;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double way : {0.0, 0.3, 0.7853981633974483, 2.0, 5.5}) {
      SpatialWorld<double> world(down(row.integrator));
      const Vector<double> along = {std::cos(way), std::sin(way), 0};
      const int puck = ball(world, {.v = v * along, .mass = 2});
      put_on_plane(world, puck, {0, 0, 1}, mu);
      advance(world, 0.5, 0.01);
      EXPECT_LT(norm(velocity_of(world, puck) - (v - mu * g * 0.5) * along), 1e-9) << row.name << ", " << way;
      advance(world, 0.5, 0.01);
      EXPECT_LT(norm(velocity_of(world, puck)), 1e-9) << row.name << ", " << way;
      const double far = v * v / (2 * mu * g);
      EXPECT_LT(norm(place_of(world, puck) - far * along), row.order > 2 ? 1e-8 : 0.02) << row.name << ", " << way;
    }
  }
}

// A billiard ball with side spin slips in one direction u, at a speed that falls by (7/2) mu g, on a parabola; from
// t = 2 |u| / (7 mu g) on it rolls along v0 - (2/7) u.
// (Coriolis, Théorie mathématique des effets du jeu de billard, 1835)
TEST(Cones, ABilliardBallRunsOnAParabolaAndThenRolls) {
  constexpr double mu = 0.2, m = 0.17, r = 0.03, I = 0.4 * m * r * r;
  const Vector<double> v0 = {1.5, 0.2, 0}, w0 = {60, -25, 10}, down_to_contact = {0, 0, -r};
  const Vector<double> u = v0 + cross(w0, down_to_contact), push = (-mu * g / norm(u)) * u;
  const double rolls = 2 * norm(u) / (7 * mu * g);
  ASSERT_GT(rolls, 0.3);
  ASSERT_GT(norm(cross(u, v0)) / (norm(u) * norm(v0)), 0.3);  // it bends
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(down(row.integrator));
    const int body = ball(world, {.x = {0, 0, r}, .v = v0, .w = w0, .mass = m, .inertia = I});
    put_on_plane(world, body, {0, 0, 1}, mu, r);
    advance(world, 0.3, 0.005);
    EXPECT_LT(norm(velocity_of(world, body) - v0 - 0.3 * push), 1e-8) << row.name;
    const Vector<double> there = 0.3 * v0 + 0.045 * push;
    EXPECT_LT(norm(place_of(world, body) - there - Vector<double>{0, 0, r}), row.order == 1 ? 0.01 : 1e-3) << row.name;
    advance(world, 0.7, 0.005);
    EXPECT_LT(norm(velocity_of(world, body) - (v0 - (2.0 / 7) * u)), 1e-7) << row.name;
    const Vector<double> rolled =
        rolls * v0 + (0.5 * rolls * rolls) * push + (1 - rolls) * (v0 - (2.0 / 7) * u) + Vector<double>{0, 0, r};
    EXPECT_LT(norm(place_of(world, body) - rolled), row.order > 2 ? 1e-8 : 0.02) << row.name;
    EXPECT_NEAR(world.velocity(body).wz, 10, 1e-9) << row.name;  // a point contact does not brake the spin
  }
}

struct Slide {
  double x, y, vx, vy;
};

// A block on a slope, hit across it, by Runge-Kutta of order 4: dv/dt = g sin(slope) x - mu g cos(slope) v/|v|.
Slide slide_by_hand(double slope, double mu, Slide s, double duration, int steps) {
  const auto rate = [&](const Slide& q) {
    const double speed = std::hypot(q.vx, q.vy), brake = mu * g * std::cos(slope) / speed;
    return Slide{q.vx, q.vy, g * std::sin(slope) - brake * q.vx, -brake * q.vy};
  };
  const auto moved = [](const Slide& q, const Slide& k, double h) {
    return Slide{q.x + h * k.x, q.y + h * k.y, q.vx + h * k.vx, q.vy + h * k.vy};
  };
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const Slide k1 = rate(s), k2 = rate(moved(s, k1, h / 2)), k3 = rate(moved(s, k2, h / 2)),
                k4 = rate(moved(s, k3, h));
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return s;
}

TEST(Cones, ABlockThatIsHitAcrossTheSlopeTurnsDownIt) {
  constexpr double slope = 0.5, mu = 0.5, v = 1.2, duration = 0.8;
  const Slide right = slide_by_hand(slope, mu, {0, 0, 0, v}, duration, 8000);
  ASSERT_GT(right.vx, 2 * right.vy);
  for (const IntegratorRow& row : integrator_rows) {
    const auto error_at = [&](double h) {
      SpatialWorld<double> world(down(row.integrator));
      const int block = ball(world, {.v = {0, v, 0}, .mass = 3});
      put_on_plane(world, block, normal(slope, 0), mu);
      advance(world, duration, h);
      const Vector<double> there = right.x * steepest(slope, 0) + Vector<double>{0, right.y, 0};
      return norm(place_of(world, block) - there);
    };
    const double coarse = error_at(0.02), fine = error_at(0.01);
    fmt::print("  {}: off by {:.1e} and {:.1e} m\n", row.name, coarse, fine);
    EXPECT_LT(fine, row.order > 2 ? 1e-7 : 0.01) << row.name;
    EXPECT_TRUE(fine < 1e-9 || coarse / fine > 1.7) << row.name << ": " << coarse / fine;
  }
}

// Below the angle of friction the block comes to rest, and turns down the slope the faster, the slower it is. A
// reference in very short steps tells how far it slides.
TEST(Cones, AdaptiveStepsLocateTheEndOfASlideThatTurns) {
  constexpr double slope = 0.3, mu = 0.5, v = 1.5;
  Slide reference{0, 0, 0, v};
  for (double h = 1e-4; std::hypot(reference.vx, reference.vy) > 1e-9;
       h = 2e-3 * std::hypot(reference.vx, reference.vy))
    reference = slide_by_hand(slope, mu, reference, std::min(h, 1e-3), 1);
  for (const Integrator integrator : {Integrator::dop853, Integrator::radau5}) {
    Settings settings = down(integrator);
    settings.local_error = 1e-10;
    SpatialWorld<double> world(settings);
    const int block = ball(world, {.v = {0, v, 0}, .mass = 3});
    put_on_plane(world, block, normal(slope, 0), mu);
    advance(world, 2, 0.1);
    const Vector<double> there = reference.x * steepest(slope, 0) + Vector<double>{0, reference.y, 0};
    const double off = norm(place_of(world, block) - there);
    fmt::print("  off by {:.1e} m after {:.3f} m; {} events, {} steps, {} rescued\n", off, norm(there),
               world.step_counts().events, world.step_counts().taken, world.step_counts().rescued);
    EXPECT_LT(off, 1e-7);
    EXPECT_LT(norm(velocity_of(world, block)), 1e-12);
    EXPECT_EQ(world.step_counts().rescued, 0);
  }
}

TEST(Cones, SweepsFindWhatTheDirectSolverFinds) {
  for (const Integrator integrator : {Integrator::euler, Integrator::rattle}) {
    const auto place = [&](Solver solver) {
      Settings s = down(integrator);
      s.solver = solver;
      SpatialWorld<double> world(s);
      const int body =
          ball(world,
               {.x = {0, 0, 0.03}, .v = {1.5, 0.2, 0}, .w = {60, -25, 10}, .mass = 0.17, .inertia = 0.4 * 0.17 * 9e-4});
      put_on_plane(world, body, {0, 0, 1}, 0.2, 0.03);
      advance(world, 0.3, 0.005);
      return place_of(world, body);
    };
    EXPECT_LT(norm(place(Solver::iterative) - place(Solver::direct)), 1e-6);
  }
}

// Three feet of a table: where it is pushed off its centre, it turns as it slides. Friction takes what the push loses.
TEST(Cones, TheBalanceOfATableOnThreeFeetCloses) {
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(down(row.integrator));
    const int table = ball(world, {.x = {0, 0, 0.1}, .v = {1, 0.5, 0}, .w = {0, 0, 2}, .mass = 4, .inertia = 0.3});
    for (const double angle : {0.2, 2.3, 4.4})
      world.add_joint({"rough_plane",
                       {table, world.ground()},
                       {{"pa", {0.4 * std::cos(angle), 0.4 * std::sin(angle), -0.1}},
                        {"pb", {0, 0, 0}},
                        {"f", {0, 0, 1}},
                        {"mu", {0.3}}},
                       {}});
    const double before = world.energy();
    BalanceWatch watch;
    watch.look(world.balance());
    for (int k = 0; k < 400; ++k) {
      ASSERT_TRUE(world.step(0.005)) << row.name;
      watch.look(world.balance());
    }
    double friction = 0;
    for (const WorkOfSource& work : world.work_by_source())
      if (work.name == "rough_plane") friction = work.work;
    fmt::print("  {}: unaccounted {:.1e}; {} events, {} rescued\n", row.name, watch.energy.share(),
               world.step_counts().events, world.step_counts().rescued);
    EXPECT_LT(watch.energy.share(), row.order > 2 ? 1e-6 : 2e-2) << row.name;
    EXPECT_NEAR(friction, world.energy() - before, (row.order > 2 ? 1e-5 : 2e-2) * std::abs(friction)) << row.name;
    EXPECT_LT(norm(velocity_of(world, table)), 1e-8) << row.name;
    EXPECT_LT(std::abs(world.velocity(table).wz), 1e-8) << row.name;
  }
}

// Tables on three and four feet, whose corners turn to and fro where they come to rest: no step may fail, and all stop.
TEST(Cones, TablesSlideToRestByEveryMethod) {
  std::mt19937 source(7);
  const auto between = [&](double a, double b) { return a + (b - a) * source() / 4294967296.0; };
  for (const int feet : {3, 4})
    for (const double mu : {0.6, 0.8, 1.5})
      for (int start = 0; start < 6; ++start) {
        const Start at{.x = {0, 0, 0.1},
                       .v = {between(-2, 2), between(-2, 2), 0},
                       .w = {0, 0, between(-4, 4)},
                       .mass = 4,
                       .inertia = 0.3};
        for (const IntegratorRow& row : integrator_rows) {
          SpatialWorld<double> world(down(row.integrator));
          const int table = ball(world, at);
          for (int foot = 0; foot < feet; ++foot) {
            const double angle = 2 * pi * foot / feet + 0.2;
            world.add_joint({"rough_plane",
                             {table, world.ground()},
                             {{"pa", {0.4 * std::cos(angle), 0.4 * std::sin(angle), -0.1}},
                              {"pb", {0, 0, 0}},
                              {"f", {0, 0, 1}},
                              {"mu", {mu}}},
                             {}});
          }
          for (int k = 0; k < 240; ++k)
            ASSERT_TRUE(world.step(0.005)) << row.name << ", " << feet << " feet, mu " << mu << ", start " << start;
          EXPECT_LT(norm(velocity_of(world, table)), 1e-6) << row.name;
        }
      }
}

// Painlevé's rod, along a heading between the axes of the plane: it jams, and no step may sink, gain energy or fail.
TEST(Cones, PainlevesRodJams) {
  constexpr double mu = 2, m = 1, l = 1, I = m * l * l / 3, v0 = 4, way = 0.6;
  const double tilt = std::atan(2.0), s = std::sin(tilt), c = std::cos(tilt);
  const Vector<double> ahead = {std::cos(way), std::sin(way), 0}, up = {0, 0, 1};
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(down(row.integrator));
    const int rod = ball(world, {.x = (-l * c) * ahead + (l * s) * up, .v = v0 * ahead, .mass = m, .inertia = I});
    world.add_joint(
        {"rough_plane",
         {rod, world.ground()},
         {{"pa", {l * c * ahead.x, l * c * ahead.y, -l * s}}, {"pb", {0, 0, 0}}, {"f", {0, 0, 1}}, {"mu", {mu}}},
         {}});
    double energy = world.energy();
    const double first = energy;
    for (int n = 0; n < 20; ++n) {
      ASSERT_TRUE(world.step(0.005)) << row.name;
      EXPECT_LT(world.energy(), energy + 1e-3 * first) << row.name << " at " << world.time();
      EXPECT_NEAR(dot(velocity_of(world, rod), cross(up, ahead)), 0, 1e-9) << row.name;  // it stays in its plane
      energy = world.energy();
    }
    fmt::print("  {}: {:.4f} of {:.4f} J left\n", row.name, energy, first);
    EXPECT_LT(energy, 0.9 * first) << row.name;
  }
}

// The direction that a slip was noted with is a part of the state.
TEST(Cones, ARunFromASnapshotHasTheSameBits) {
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(down(row.integrator));
    const int block = ball(world, {.mass = 3});
    put_on_plane(world, block, normal(0.5, 0.7), 0.5);
    advance(world, 0.002, 0.001);
    const Snapshot then = world.snapshot();
    advance(world, 0.01, 0.001);
    const Snapshot end = world.snapshot();
    world.set_velocity(block, {1, 1, -1, 0, 0, 0});
    advance(world, 0.01, 0.001);
    world.restore(then);
    advance(world, 0.01, 0.001);
    EXPECT_TRUE(world.snapshot() == end) << row.name;
  }
}

// From rest, adaptive steps find the direction in which a push lets a block slip, and how far it comes.
TEST(Cones, AdaptiveStepsBeginASlip) {
  constexpr double mu = 0.3, m = 2, push = 1.5 * mu * m * g, way = 1.1;
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Settings settings = down(integrator);
    settings.local_error = 1e-10;
    SpatialWorld<double> world(settings);
    const int block = ball(world, {.mass = m});
    put_on_plane(world, block, {0, 0, 1}, mu);
    world.set_force(block, {push * std::cos(way), push * std::sin(way), 0, 0, 0, 0});
    advance(world, 1, 0.1);
    const double far = (push / m - mu * g) / 2;
    EXPECT_LT(norm(place_of(world, block) - far * Vector<double>{std::cos(way), std::sin(way), 0}), 1e-9);
    EXPECT_EQ(world.step_counts().rescued, 0);
  }
}

}  // namespace
}  // namespace cdot::test::in_space
