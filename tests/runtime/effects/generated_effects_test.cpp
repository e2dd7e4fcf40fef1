// Effects from specs, by closed forms, by finite differences and by their energy.
#include <cmath>
#include <fmt/format.h>
#include <random>

#include <cdot/balance.hpp>
#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// --- The generated functions: F = unstored - dE/dC, k = -dF/dC and d = -dF/d(rate) by central differences.

template <class Effect>
struct At {
  static constexpr int rows = Effect::rows;
  using Parameters = typename Effect::template Parameters<double>;
  Parameters p{};
  double C[rows], rate[rows];

  std::array<double, rows> force() const {
    std::array<double, rows> F{};
    Effect::force(C, rate, p, 0.0, reinterpret_cast<double(&)[rows]>(*F.data()));
    return F;
  }
};

template <class Effect>
void check_slopes(std::mt19937& random) {
  constexpr int rows = Effect::rows;
  constexpr double h = 1e-5, bound = 1e-7;
  std::uniform_real_distribution<double> number(0.5, 2);
  for (int n = 0; n < 20; ++n) {
    At<Effect> at;
    for (std::size_t i = 0; i < sizeof(at.p) / sizeof(double); ++i)
      reinterpret_cast<double*>(&at.p)[i] = number(random);
    for (int r = 0; r < rows; ++r) at.C[r] = number(random), at.rate[r] = number(random);
    double k[rows][rows], d[rows][rows], rest[rows] = {};
    Effect::slopes(at.C, at.rate, at.p, 0.0, k, d);
    const auto F = at.force();
    if constexpr (requires { &Effect::template unstored<double>; }) Effect::unstored(at.C, at.rate, at.p, 0.0, rest);
    for (int c = 0; c < rows; ++c) {
      At<Effect> up = at, down = at;
      up.C[c] += h, down.C[c] -= h;
      for (int r = 0; r < rows; ++r)
        EXPECT_NEAR(k[r][c], -(up.force()[r] - down.force()[r]) / (2 * h), bound * (1 + std::abs(k[r][c])))
            << Effect::name << ": k, row " << r + 1 << ", column " << c + 1;
      if constexpr (requires { &Effect::template energy<double>; }) {
        double high, low;
        Effect::energy(up.C, at.p, high);
        Effect::energy(down.C, at.p, low);
        EXPECT_NEAR(F[c], rest[c] - (high - low) / (2 * h), bound * (1 + std::abs(F[c]))) << Effect::name << ": F";
      }
      up = down = at;
      up.rate[c] += h, down.rate[c] -= h;
      for (int r = 0; r < rows; ++r)
        EXPECT_NEAR(d[r][c], -(up.force()[r] - down.force()[r]) / (2 * h), bound * (1 + std::abs(d[r][c])))
            << Effect::name << ": d, row " << r + 1 << ", column " << c + 1;
    }
  }
}

TEST(GeneratedEffects, ForcesAndSlopesAreDerivatives) {
  std::mt19937 random(1);
  int checked = 0;
  const auto all = [&]<class... Effects>(std::type_identity<std::tuple<Effects...>>) {
    (check_slopes<Effects>(random), ...);
    checked += static_cast<int>(sizeof...(Effects));
  };
  all(std::type_identity<planar::Effects>{});
  all(std::type_identity<spatial::Effects>{});
  fmt::print("{} effects\n", checked);
  EXPECT_GE(checked, 8);
}

// --- Closed forms, with every integrator.

Settings with(Integrator integrator, double gravity = 0) {
  Settings s = settings(Solver::direct, Drift::projection, gravity);
  s.integrator = integrator;
  return s;
}

double order_of(Integrator integrator) {
  return integrator == Integrator::rk4 ? 4 : integrator == Integrator::dop853 ? 8 : 1;
}

// A stone that falls through air: v = v_t tanh(g t / v_t) with v_t = sqrt(m g / c).
double error_of_fall(Integrator integrator, double h) {
  constexpr double g = 9.81, m = 2, c = 0.3;
  World<double> world(with(integrator, -g));
  const int stone = world.add_body({.mass = m, .inertia = 1});
  world.add_joint({"drag", {stone}, {{"pa", {0, 0}}, {"c", {c}}}, {}});
  for (int k = 0; k < std::lround(1 / h); ++k) EXPECT_TRUE(world.step(h));
  const double end = std::sqrt(m * g / c);
  return std::abs(world.velocity(stone).y + end * std::tanh(g / end));
}

TEST(GeneratedEffects, AStoneFallsThroughAir) {
  for (const auto& [name, integrator] : integrators) {
    const double coarse = error_of_fall(integrator, 0.1), fine = error_of_fall(integrator, 0.05);
    fmt::print("  {}: {:.1e} m/s at 0.1 s, {:.1e} at 0.05 s\n", name, coarse, fine);
    EXPECT_LT(coarse, 0.3) << name;
    EXPECT_TRUE(fine < 1e-12 || coarse / fine > 0.8 * std::pow(2, order_of(integrator))) << name;
  }
}

// A damped spring: x = x_0 exp(-a t) (cos w t + a / w sin w t), a = d / 2m, w^2 = k / m - a^2.
double error_of_spring(Integrator integrator, double h) {
  constexpr double k = 40, d = 0.8, m = 2, rest = 3, stretch = 0.5;
  World<double> world(with(integrator));
  const int mass = world.add_body({.x = rest + stretch, .mass = m, .inertia = 1});
  world.add_joint({"spring",
                   {mass, world.ground()},
                   {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {k}}, {"rest", {rest}}, {"d", {d}}},
                   {}});
  for (int n = 0; n < std::lround(1 / h); ++n) EXPECT_TRUE(world.step(h));
  const double a = d / (2 * m), w = std::sqrt(k / m - a * a);
  return std::abs(world.pose(mass).x - rest - stretch * std::exp(-a) * (std::cos(w) + a / w * std::sin(w)));
}

TEST(GeneratedEffects, ASpringWithADamperSwings) {
  for (const auto& [name, integrator] : integrators) {
    const double coarse = error_of_spring(integrator, 0.02), fine = error_of_spring(integrator, 0.01);
    fmt::print("  {}: {:.1e} m at 0.02 s, {:.1e} at 0.01 s\n", name, coarse, fine);
    EXPECT_LT(coarse, 0.1) << name;
    EXPECT_TRUE(fine < 1e-12 || coarse / fine > 0.8 * std::pow(2, order_of(integrator))) << name;
  }
}

// A planet on a circle: after one period it is where it was.
TEST(GeneratedEffects, APlanetReturnsAfterItsPeriod) {
  World<double> world(with(Integrator::dop853));
  const double mu = 3, m = 1.5, r = 2, speed = std::sqrt(mu / m / r), period = 2 * pi * r / speed;
  BodyDefinition d;
  d.x = r, d.vy = speed, d.mass = m, d.inertia = 1;
  const int planet = world.add_body(d);
  world.add_joint({"gravity_well", {planet}, {{"pa", {0, 0}}, {"centre", {0, 0}}, {"mu", {mu}}}, {}});
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(period / 50));
  fmt::print("off by {:.1e} m\n", std::hypot(world.pose(planet).x - r, world.pose(planet).y));
  EXPECT_NEAR(world.pose(planet).x, r, 1e-9);
  EXPECT_NEAR(world.pose(planet).y, 0, 1e-9);
}

// --- Steps of any length hold stiff effects, and no energy appears.

TEST(GeneratedEffects, StiffSpringsAndHeavyDragStayStable) {
  for (Integrator integrator : {Integrator::euler, Integrator::implicit}) {
    World<double> world(with(integrator));
    const int mass = world.add_body({.x = 1.1, .vx = 10, .mass = 1, .inertia = 1});
    world.add_joint({"spring",
                     {mass, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {1e8}}, {"rest", {1}}, {"d", {0}}},
                     {}});
    world.add_joint({"drag", {mass}, {{"pa", {0, 0}}, {"c", {1e4}}}, {}});
    const double start = world.energy();
    for (int k = 0; k < 600; ++k) {
      ASSERT_TRUE(world.step(1.0 / 60));
      ASSERT_LE(world.energy(), start * (1 + 1e-9));
    }
  }
}

TEST(GeneratedEffects, AnEffectCannotBeASpring) {
  World<double> world(with(Integrator::euler));
  const int body = world.add_body({.mass = 1, .inertia = 1});
  EXPECT_THROW(world.add_joint({"drag", {body}, {{"pa", {0, 0}}, {"c", {1}}}, Softness{}}), Error);
}

}  // namespace
}  // namespace cdot::test
