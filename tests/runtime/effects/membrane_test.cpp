// A sheet between three equal masses at the corners of an equilateral triangle, which breathes in and out.
#include <array>
#include <numbers>

#include "tests/runtime/effects/spatial_effects.hpp"

namespace cdot::test::in_space {
namespace {

using effects::expect_orders;

constexpr double k = 40, d = 3, m = 2, start = 0.9, shrunk = 0.8;  // shrunk: the area at rest, of that at the start
constexpr std::array<double, 3> heading = {0.3, 0.3 + 2 * std::numbers::pi / 3, 0.3 + 4 * std::numbers::pi / 3};
constexpr double area_of(double rho) { return 0.75 * std::numbers::sqrt3 * rho * rho; }

// All corners stay at one distance rho from the middle. The area A = (3 sqrt(3)/4) rho^2 has the energy
// k (A - A0)^2/(2 A0), so 3 m rho'' = -(k (A - A0) + d dA/dt)/A0 dA/drho: by Runge-Kutta's method of order 4.
double breathed(double duration) {
  constexpr double A0 = shrunk * area_of(start);
  const auto pull = [](double rho, double rate) {
    const double slope = 1.5 * std::numbers::sqrt3 * rho;
    return -(k * (area_of(rho) - A0) + d * slope * rate) / A0 * slope / (3 * m);
  };
  double x = start, v = 0;
  constexpr int steps = 4000;
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const double v1 = v, f1 = pull(x, v), v2 = v + h / 2 * f1, f2 = pull(x + h / 2 * v1, v2), v3 = v + h / 2 * f2,
                 f3 = pull(x + h / 2 * v2, v3), v4 = v + h * f3, f4 = pull(x + h * v3, v4);
    x += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v += h / 6 * (f1 + 2 * f2 + 2 * f3 + f4);
  }
  return x;
}

JointDefinition sheet(int first, const std::vector<double>& centre) {
  return {"membrane",
          {first, first + 1, first + 2},
          {{"pa", centre}, {"pb", centre}, {"pc", centre}, {"k", {k}}, {"d", {d}}, {"rest", {shrunk * area_of(start)}}},
          {}};
}

TEST(Membrane, BreathesInThePlane) {
  const double right = breathed(1);
  ASSERT_GT(std::abs(right - start), 0.05) << "it moves";
  expect_orders("membrane", 0.02, 0.1, [&](Integrator integrator, double h) {
    World<double> world(effects::with(integrator));
    for (const double to : heading) effects::ball(world, start * std::cos(to), start * std::sin(to), 0, 0, m);
    world.add_joint(sheet(0, {0, 0}));
    effects::advance(world, 1, h);
    double largest = 0;
    for (int body = 0; body < 3; ++body) {
      const auto at = world.pose(body);
      const double to = heading[static_cast<std::size_t>(body)];
      largest = std::max(largest, std::hypot(at.x - right * std::cos(to), at.y - right * std::sin(to)));
    }
    return largest;
  });
}

TEST(Membrane, BreathesInATiltedPlane) {
  const Vector<double> u = {2. / 3, -1. / 3, 2. / 3}, w = {1. / 3, -2. / 3, -2. / 3};  // orthonormal
  const double right = breathed(1);
  expect_orders("membrane in space", 0.02, 0.1, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const auto corner = [&](double rho, double to) { return rho * (std::cos(to) * u + std::sin(to) * w); };
    for (const double to : heading) ball(world, {.x = corner(start, to), .mass = m});
    world.add_joint(sheet(0, {0, 0, 0}));
    run(world, 1, h);
    double largest = 0;
    for (int body = 0; body < 3; ++body)
      largest = std::max(largest, norm(place_of(world, body) - corner(right, heading[static_cast<std::size_t>(body)])));
    return largest;
  });
}

}  // namespace
}  // namespace cdot::test::in_space
