// Contacts between round bodies, with friction bounded by what they carry: where a disc and a ball leave the top that
// they roll off, what a stroke between two discs hands over, how they roll in a ring and in a bowl.
#include "tests/runtime/effects/spatial_effects.hpp"

namespace cdot::test::in_space {
namespace {

using effects::with;

constexpr double rough = 1e6, R = 0.7, r = 0.3;

double bound_of(const IntegratorRow& row, double high, double low) { return row.order > 2 ? high : low; }

template <class World>
void advance(World& world, double duration, double h) {
  for (long k = 0; k < std::lround(duration / h); ++k) ASSERT_TRUE(world.step(h));
}

int disc(World<double>& world, double x, double y, double vx, double vy, double w, double mass, double radius) {
  return world.add_body(
      {.x = x, .y = y, .vx = vx, .vy = vy, .w = w, .mass = mass, .inertia = 0.5 * mass * radius * radius});
}

// A body of inertia k m r^2 starts at rest at the angle `start` from the top. It leaves where the path needs all its
// weight: m v^2/(R + r) = m g cos(a), with (1 + k)/2 v^2 = g (R + r) (cos(start) - cos(a)), so at
// cos(a) = 2 cos(start)/(3 + k), or at 2 cos(start)/3 without friction. From then on it keeps the speed sideways,
// sqrt(g (R + r)) cos(a)^(3/2), and turns on at v/r.
struct Leaving {
  double cosine, sideways, turns;
};
Leaving leaving(double start, double k) {
  const double cosine = 2 * std::cos(start) / (3 + k), v = std::sqrt(g * (R + r) * cosine);
  return {cosine, v * cosine, v / r};
}

TEST(RoundContacts, ADiscLeavesTheTopWhereThePathNeedsAllItsWeight) {
  constexpr double start = 0.4;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double mu : {0.0, rough}) {
      World<double> world(with(row.integrator, -g));
      const int body = disc(world, (R + r) * std::sin(start), (R + r) * std::cos(start), 0, 0, 0, 2, r);
      world.add_joint(
          {"disc_on_disc", {body, world.ground()}, {{"radius_a", {r}}, {"radius_b", {R}}, {"mu", {mu}}}, {}});
      advance(world, 0.9, 0.0025);
      const Leaving right = leaving(start, mu > 0 ? 0.5 : 0);
      ASSERT_GT(std::hypot(world.pose(body).x, world.pose(body).y), R + r + 0.01) << "it has left";
      const double bound = bound_of(row, 1e-5, 0.02);
      EXPECT_NEAR(world.velocity(body).x, right.sideways, bound) << row.name << ", mu " << mu;
      EXPECT_NEAR(world.velocity(body).w, mu > 0 ? -right.turns : 0, bound / r) << row.name << ", mu " << mu;
    }
  }
}

TEST(RoundContacts, ABallLeavesTheTopToAnySide) {
  constexpr double start = 0.4;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double way : {0.0, 1.1, 4.0}) {
      for (const double mu : {0.0, rough}) {
        SpatialWorld<double> world(free_fall(row.integrator, g));
        const Vector<double> aside = {std::cos(way), std::sin(way), 0}, up = {0, 0, 1};
        const int body = ball(
            world,
            {.x = (R + r) * (std::sin(start) * aside + std::cos(start) * up), .mass = 2, .inertia = 0.4 * 2 * r * r});
        world.add_joint({"ball_on_ball",
                         {body, world.ground()},
                         {{"f", {0, 0, 1}}, {"radius_a", {r}}, {"radius_b", {R}}, {"mu", {mu}}},
                         {}});
        advance(world, 0.9, 0.0025);
        const Leaving right = leaving(start, mu > 0 ? 0.4 : 0);
        ASSERT_GT(norm(place_of(world, body)), R + r + 0.01) << "it has left";
        const auto v = world.velocity(body);
        const double bound = bound_of(row, 1e-5, 0.02);
        EXPECT_LT(norm(Vector<double>{v.x, v.y, 0} - right.sideways * aside), bound) << row.name << " to " << way;
        EXPECT_LT(norm(Vector<double>{v.wx, v.wy, v.wz} - (mu > 0 ? right.turns : 0) * cross(up, aside)), bound / r)
            << row.name << " to " << way << ", mu " << mu;
      }
    }
  }
}

// Two equal solid discs meet with the velocity vn towards each other and vt across. The impulse along the normal is
// m vn/2. The one across is mu times as large, or ends the slip: vt/(1/m + 1/m + 2 r^2/I) = m vt/6 if I = m r^2/2.
// The momentum is 0, and angular momentum about the middle stays.
TEST(RoundContacts, AStrokeHandsOverWhatFrictionAllows) {
  constexpr double m = 2, vn = 1.2, vt = 0.9, I = 0.5 * m * r * r, wait = 0.125;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double mu : {0.0, 0.1, rough}) {
      World<double> world(with(row.integrator));
      const double x = r + wait * vn / 2, y = wait * vt / 2;  // they meet beside each other
      const int left = disc(world, -x, -y, vn / 2, vt / 2, 0, m, r),
                right = disc(world, x, y, -vn / 2, -vt / 2, 0, m, r);
      world.add_joint({"disc_on_disc", {left, right}, {{"radius_a", {r}}, {"radius_b", {r}}, {"mu", {mu}}}, {}});
      advance(world, 0.25, 1. / 1024);
      const double impulse = std::min(mu * m * vn / 2, m * vt / 6);
      const auto a = world.velocity(left), b = world.velocity(right);
      const double bound = bound_of(row, 1e-8, 5e-3);
      for (const double w : {a.w, b.w}) EXPECT_NEAR(w, -impulse * r / I, bound / r) << row.name << ", mu " << mu;
      EXPECT_NEAR(std::hypot(a.x, a.y), vt / 2 - impulse / m, bound) << row.name << ", mu " << mu;
      EXPECT_NEAR(a.x + b.x, 0, 1e-12) << row.name;
      EXPECT_NEAR(a.y + b.y, 0, 1e-12) << row.name;
      const auto p = world.pose(left), q = world.pose(right);
      const double angular = m * (p.x * a.y - p.y * a.x + q.x * b.y - q.y * b.x) + I * (a.w + b.w);
      EXPECT_NEAR(angular, m * (-x * vt + y * vn), 1e-11) << row.name << ", mu " << mu;
    }
  }
}

// It rolls as a pendulum of the length (1 + k) (R - r), here integrated by Runge-Kutta's method of order 4.
double rolled(double start, double k, double duration) {
  const auto bend = [&](double a) { return -g / ((1 + k) * (R - r)) * std::sin(a); };
  double a = start, w = 0;
  constexpr int steps = 4000;
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const double w1 = w, e1 = bend(a), w2 = w + h / 2 * e1, e2 = bend(a + h / 2 * w1), w3 = w + h / 2 * e2,
                 e3 = bend(a + h / 2 * w2), w4 = w + h * e3, e4 = bend(a + h * w3);
    a += h / 6 * (w1 + 2 * w2 + 2 * w3 + w4), w += h / 6 * (e1 + 2 * e2 + 2 * e3 + e4);
  }
  return a;
}

TEST(RoundContacts, ADiscRollsInARingAsAPendulum) {
  constexpr double start = 1.1, duration = 1.5;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double mu : {0.0, rough}) {
      World<double> world(with(row.integrator, -g));
      const int body = disc(world, (R - r) * std::sin(start), -(R - r) * std::cos(start), 0, 0, 0, 2, r);
      world.add_joint(
          {"disc_in_ring", {body, world.ground()}, {{"radius_a", {r}}, {"radius_b", {R}}, {"mu", {mu}}}, {}});
      advance(world, duration, 0.0025);
      const double a = rolled(start, mu > 0 ? 0.5 : 0, duration);
      const double bound = bound_of(row, 1e-7, 0.02);
      EXPECT_NEAR(world.pose(body).x, (R - r) * std::sin(a), bound) << row.name << ", mu " << mu;
      EXPECT_NEAR(world.pose(body).y, -(R - r) * std::cos(a), bound) << row.name << ", mu " << mu;
      const double turned = mu > 0 ? -(a - start) * (R - r) / r : 0;  // it rolls back as it goes forward
      EXPECT_NEAR(world.pose(body).angle, turned, bound / r) << row.name << ", mu " << mu;
    }
  }
}

TEST(RoundContacts, ABallRollsInABowlAsAPendulum) {
  constexpr double start = 1.1, duration = 1.5;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double way : {0.3, 2.5}) {
      SpatialWorld<double> world(free_fall(row.integrator, g));
      const Vector<double> aside = {std::cos(way), std::sin(way), 0}, up = {0, 0, 1};
      const auto at = [&](double a) { return (R - r) * (std::sin(a) * aside - std::cos(a) * up); };
      const int body = ball(world, {.x = at(start), .mass = 2, .inertia = 0.4 * 2 * r * r});
      world.add_joint({"ball_in_bowl",
                       {body, world.ground()},
                       {{"f", {0, 0, 1}}, {"radius_a", {r}}, {"radius_b", {R}}, {"mu", {rough}}},
                       {}});
      advance(world, duration, 0.0025);
      EXPECT_LT(norm(place_of(world, body) - at(rolled(start, 0.4, duration))), bound_of(row, 1e-7, 0.02))
          << row.name << " to " << way;
    }
  }
}

// Without friction it circles at the angle a from the lowest point, where w^2 = g/((R - r) cos(a)).
TEST(RoundContacts, AMarbleCirclesInABowl) {
  constexpr double a = 0.8, duration = 1.5;
  const double w = std::sqrt(g / ((R - r) * std::cos(a))), far = (R - r) * std::sin(a), low = -(R - r) * std::cos(a);
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(free_fall(row.integrator, g));
    const int body = ball(world, {.x = {far, 0, low}, .v = {0, w * far, 0}, .w = {1, -2, 3}});
    world.add_joint(
        {"ball_in_bowl", {body, world.ground()}, {{"f", {0, 0, 1}}, {"radius_a", {r}}, {"radius_b", {R}}}, {}});
    advance(world, duration, 0.0025);
    const Vector<double> right = {far * std::cos(w * duration), far * std::sin(w * duration), low};
    EXPECT_LT(norm(place_of(world, body) - right), bound_of(row, 1e-7, 0.02)) << row.name;
    EXPECT_NEAR(world.velocity(body).wz, 3, 1e-9) << row.name << ": no friction, no turn";
  }
}

// Two balls of any sizes meet, off centre, in space: momentum and angular momentum stay, and the energy falls.
TEST(RoundContacts, TwoBallsKeepTheirMomentum) {
  constexpr double mass_a = 2, I_a = 0.07, mass_b = 5, I_b = 0.9;
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(free_fall(row.integrator));
    const int a = ball(world, {{-1, 0.1, 0.05}, {3, 0, 0.2}, {5, -3, 8}, mass_a, I_a});
    const int b = ball(world, {{0.2, -0.1, 0}, {-1, 0.3, 0}, {-2, 6, 1}, mass_b, I_b});
    world.add_joint(
        {"ball_on_ball", {a, b}, {{"f", {-1, 0, 0}}, {"radius_a", {r}}, {"radius_b", {0.5}}, {"mu", {0.4}}}, {}});
    const auto momentum = [&] {
      const auto p = world.velocity(a), q = world.velocity(b);
      return mass_a * Vector<double>{p.x, p.y, p.z} + mass_b * Vector<double>{q.x, q.y, q.z};
    };
    const auto angular = [&] {
      const auto p = world.velocity(a), q = world.velocity(b);
      return mass_a * cross(place_of(world, a), {p.x, p.y, p.z}) + I_a * Vector<double>{p.wx, p.wy, p.wz} +
             mass_b * cross(place_of(world, b), {q.x, q.y, q.z}) + I_b * Vector<double>{q.wx, q.wy, q.wz};
    };
    const Vector<double> before = momentum(), turning = angular();
    const double energy = world.energy();
    advance(world, 0.5, 0.001);
    EXPECT_LT(norm(momentum() - before), 1e-11) << row.name;
    EXPECT_LT(norm(angular() - turning), 1e-10) << row.name;
    EXPECT_LT(world.energy(), energy - 1) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test::in_space
