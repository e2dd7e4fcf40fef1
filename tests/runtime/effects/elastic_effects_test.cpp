// Effects with an energy, and a damper, by closed forms with every integrator.
#include <cmath>

#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::ball;
using effects::expect_orders;
using effects::with;

// A ball on the x axis, and an effect between it and the origin.
World<double> on_axis(Integrator integrator, const char* effect, double x, double m,
                      std::vector<NamedValue> parameters) {
  World<double> world(with(integrator));
  const int mass = ball(world, x, 0, 0, 0, m);
  parameters.push_back({"pa", {0, 0}});
  parameters.push_back({"pb", {0, 0}});
  world.add_joint({effect, {mass, world.ground()}, parameters, {}});
  return world;
}

double x_after(World<double> world, double duration, double h) {
  const long steps = std::lround(1 / h);
  for (long n = 0; n < steps; ++n) EXPECT_TRUE(world.step(duration / static_cast<double>(steps)));
  return world.pose(0).x;
}

// The relative speed of two balls falls as exp(-d t/M), M = m_a m_b/(m_a + m_b); their centre moves on.
double error_of_damper(Integrator integrator, double h) {
  constexpr double d = 1.5, ma = 1, mb = 3, u = 2, M = ma * mb / (ma + mb);
  World<double> world(with(integrator));
  const int a = ball(world, 0, 0, u, 0, ma), b = ball(world, 4, 0, 0, 0, mb);
  world.add_joint({"damper", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"d", {d}}}, {}});
  for (long n = 0; n < std::lround(1 / h); ++n) EXPECT_TRUE(world.step(h));
  const double nearer = M * u / d * (1 - std::exp(-d / M)), centre = ma * u / (ma + mb);
  return std::hypot(world.pose(a).x - centre - mb / (ma + mb) * nearer,
                    world.pose(b).x - 4 - centre + ma / (ma + mb) * nearer);
}

TEST(ElasticEffects, ADamperStopsTwoBalls) { expect_orders("damper", 0.02, 0.1, error_of_damper); }

// Duffing's quarter period is sqrt(m/(k + k3 A^2)) K(k3 A^2/(2 (k + k3 A^2))), K the complete elliptic integral.
double error_of_duffing(Integrator integrator, double h) {
  constexpr double k = 3, k3 = 5, A = 0.8, m = 2, rest = 2, at_A = k + k3 * A * A;
  const double quarter = std::sqrt(m / at_A) * std::comp_ellint_1(std::sqrt(k3 * A * A / (2 * at_A)));
  World<double> world =
      on_axis(integrator, "duffing_spring", rest + A, m, {{"k", {k}}, {"k3", {k3}}, {"rest", {rest}}});
  return std::abs(x_after(std::move(world), quarter, h) - rest);
}

TEST(ElasticEffects, AHardeningSpringHasDuffingsPeriod) {
  expect_orders("duffing_spring", 0.02, 0.1, error_of_duffing);
}

// For kappa = 3 the energy is A/x^2 with A = F rest^3/2: x^2 = x_0^2 + 2 A t^2/(m x_0^2) from rest.
double error_of_gas(Integrator integrator, double h) {
  constexpr double F = 4, rest = 1.5, m = 2, start = 1.2, A = F * rest * rest * rest / 2;
  World<double> world = on_axis(integrator, "gas_spring", start, m, {{"F", {F}}, {"rest", {rest}}, {"kappa", {3}}});
  return std::abs(x_after(std::move(world), 1, h) - std::sqrt(start * start + 2 * A / (m * start * start)));
}

TEST(ElasticEffects, AGasExpands) { expect_orders("gas_spring", 0.02, 0.1, error_of_gas); }

// A stretch s much longer than the rounding r swings as that of a spring; the force differs by (r/s)^4.
double error_of_bungee(Integrator integrator, double h) {
  constexpr double k = 8, m = 2, rest = 2, stretch = 1.5, duration = 0.5;
  World<double> world = on_axis(integrator, "bungee", rest + stretch, m, {{"k", {k}}, {"rest", {rest}}});
  return std::abs(x_after(std::move(world), duration, h) - rest - stretch * std::cos(std::sqrt(k / m) * duration));
}

TEST(ElasticEffects, ATautCordPulls) { expect_orders("bungee", 0.05, 0.2, error_of_bungee, {.floor = 1e-9}); }

double error_of_stop(Integrator integrator, double h) {
  constexpr double k = 8, m = 2, least = 3, overlap = 1.5, duration = 0.5;
  World<double> world = on_axis(integrator, "soft_stop", least - overlap, m, {{"k", {k}}, {"least", {least}}});
  return std::abs(x_after(std::move(world), duration, h) - least + overlap * std::cos(std::sqrt(k / m) * duration));
}

TEST(ElasticEffects, ABufferPushes) { expect_orders("soft_stop", 0.05, 0.2, error_of_stop, {.floor = 1e-9}); }

// Out of reach neither moves anything: what is left of the rounded force is k r^4/(16 s^3).
TEST(ElasticEffects, ASlackCordAndABufferOutOfReachDoNothing) {
  World<double> cord = on_axis(Integrator::dop853, "bungee", 1, 2, {{"k", {8}}, {"rest", {2}}});
  World<double> buffer = on_axis(Integrator::dop853, "soft_stop", 2, 2, {{"k", {8}}, {"least", {1}}});
  EXPECT_NEAR(x_after(std::move(cord), 1, 0.1), 1, 1e-11);
  EXPECT_NEAR(x_after(std::move(buffer), 1, 0.1), 2, 1e-11);
}

// A ball that hits a buffer leaves it at its own speed, after half a period of the mass on the spring.
TEST(ElasticEffects, ABallBouncesOffABuffer) {
  constexpr double k = 8, m = 2, speed = 3;
  World<double> world(with(Integrator::dop853));
  const int mass = ball(world, 2, 0, -speed, 0, m);
  world.add_joint({"soft_stop",
                   {mass, world.ground()},
                   {{"pa", {0, 0}}, {"pb", {0, 0}}, {"least", {1.9}}, {"k", {k}}, {"rounding", {1e-4}}},
                   {}});
  const double contact = pi * std::sqrt(m / k), duration = 0.1 / speed + contact + 0.2;
  for (int n = 0; n < 2000; ++n) ASSERT_TRUE(world.step(duration / 2000));
  fmt::print("leaves at {:.9f} m/s\n", world.velocity(mass).x);
  EXPECT_NEAR(world.velocity(mass).x, speed, 1e-6);
  EXPECT_NEAR(world.pose(mass).x, 1.9 + 0.2 * speed, 1e-5);
}

// A body on a bushing with turned axes: three oscillators that do not know of each other.
double error_on_bushing(Integrator integrator, double h) {
  constexpr double kx = 20, ky = 7, k_turn = 3, m = 2, I = 0.5, c = 0.8, s = 0.6, x = 0.3, y = -0.2, angle = 0.4;
  World<double> world(with(integrator));
  const int body = world.add_body({.x = c * x - s * y, .y = s * x + c * y, .angle = angle, .mass = m, .inertia = I});
  world.add_joint({"bushing",
                   {world.ground(), body},
                   {{"pa", {0, 0}},
                    {"pb", {0, 0}},
                    {"fa", {c, s}},
                    {"kx", {kx}},
                    {"ky", {ky}},
                    {"k_turn", {k_turn}},
                    {"rest", {0}}},
                   {}});
  for (long n = 0; n < std::lround(1 / h); ++n) EXPECT_TRUE(world.step(h));
  const auto& at = world.pose(body);
  const double along = c * at.x + s * at.y - x * std::cos(std::sqrt(kx / m));
  const double across = c * at.y - s * at.x - y * std::cos(std::sqrt(ky / m));
  return std::hypot(along, across, at.angle - angle * std::cos(std::sqrt(k_turn / I)));
}

TEST(ElasticEffects, ABodySwingsOnABushing) { expect_orders("bushing", 0.02, 0.1, error_on_bushing); }

// A column floats where it displaces its weight, and swings about that depth.
double error_of_column(Integrator integrator, double h) {
  constexpr double k = 40, m = 3, g = 9.81, level = 1, foot = -0.5, higher = 0.2, depth = m * g / k;
  World<double> world(with(integrator, -g));
  const int column = ball(world, 0, level - foot - depth + higher, 0, 0, m);
  world.add_joint({"buoyancy", {column}, {{"foot", {0, foot}}, {"surface", {5, level}}, {"k", {k}}}, {}});
  for (long n = 0; n < std::lround(1 / h); ++n) EXPECT_TRUE(world.step(h));
  return std::abs(world.pose(column).y - level + foot + depth - higher * std::cos(std::sqrt(k / m)));
}

TEST(ElasticEffects, AColumnFloats) { expect_orders("buoyancy", 0.02, 0.1, error_of_column, {.floor = 1e-8}); }

// Two bodies on circles about their centre of mass turn by sqrt(mu/(M r^3)) t, M the reduced mass.
double error_of_pair(Integrator integrator, double h) {
  constexpr double mu = 5, ma = 1, mb = 3, r = 2, M = ma * mb / (ma + mb);
  const double w = std::sqrt(mu / (M * r * r * r)), ra = r * mb / (ma + mb), rb = r * ma / (ma + mb);
  World<double> world(with(integrator));
  const int a = ball(world, ra, 0, 0, w * ra, ma), b = ball(world, -rb, 0, 0, -w * rb, mb);
  world.add_joint({"gravity_between", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"mu", {mu}}}, {}});
  for (long n = 0; n < std::lround(1 / h); ++n) EXPECT_TRUE(world.step(h));
  return std::hypot(world.pose(a).x - ra * std::cos(w), world.pose(a).y - ra * std::sin(w),
                    world.pose(b).x + rb * std::cos(w));
}

TEST(ElasticEffects, TwoBodiesCircleEachOther) { expect_orders("gravity_between", 0.02, 0.1, error_of_pair); }

}  // namespace
}  // namespace cdot::test
