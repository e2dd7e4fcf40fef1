// Effects in space that are as those in the plane: drag, a spring, a thruster, stops and a seat, across all axes.
#include "tests/runtime/effects/spatial_effects.hpp"

namespace cdot::test::in_space {
namespace {

using effects::expect_orders;

const Vector<double> way = {2.0 / 3, -1.0 / 3, 2.0 / 3};  // of length 1
const std::vector<double> along = {2.0 / 3, -1.0 / 3, 2.0 / 3};

// A ball of speed v flies (m/c) ln(1 + c v t/m) far.
TEST(RowsInSpace, AirSlowsABall) {
  constexpr double m = 2, c = 0.4, v = 5;
  expect_orders("drag", 0.025, 0.3, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.v = v * way});
    world.add_joint({"drag", {body}, {{"pa", {0, 0, 0}}, {"c", {c}}}, {}});
    run(world, 1, h);
    return norm(place_of(world, body) - (m / c * std::log(1 + c * v / m)) * way);
  });
}

// x = rest + stretch exp(-a t) (cos w t + a/w sin w t), a = d/2m, w^2 = k/m - a^2.
TEST(RowsInSpace, ADampedSpringSwings) {
  constexpr double k = 40, d = 0.8, m = 2, rest = 3, stretch = 0.5;
  expect_orders("spring", 0.01, 0.1, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int mass = ball(world, {.x = (rest + stretch) * way});
    world.add_joint({"spring",
                     {mass, world.ground()},
                     {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"k", {k}}, {"rest", {rest}}, {"d", {d}}},
                     {}});
    run(world, 1, h);
    const double a = d / (2 * m), w = std::sqrt(k / m - a * a);
    return norm(place_of(world, mass) - (rest + stretch * std::exp(-a) * (std::cos(w) + a / w * std::sin(w))) * way);
  });
}

// On a body that spins with w across the thrust: x = F/(m w^2) (1 - cos w t) along it at the start, and
// F/(m w^2) (w t - sin w t) across.
TEST(RowsInSpace, AThrusterOnASpinningBodyTurnsWithIt) {
  constexpr double F = 6, m = 2, w = 3;
  const Vector<double> axis = {1.0 / 3, -2.0 / 3, -2.0 / 3}, across = cross(axis, way);
  expect_orders("thruster", 0.02, 0.3, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.w = w * axis});
    world.add_joint({"thruster", {body}, {{"pa", {0, 0, 0}}, {"n", along}, {"F", {F}}}, {}});
    run(world, 1, h);
    const double size = F / (m * w * w);
    return norm(place_of(world, body) - (size * (1 - std::cos(w))) * way - (size * (w - std::sin(w))) * across);
  });
}

TEST(RowsInSpace, StopsStopBothWaysAndLeaveTheRestFree) {
  for (const IntegratorRow& row : integrator_rows) {
    for (const double v : {3.0, -3.0}) {
      SpatialWorld<double> world(free_fall(row.integrator));
      const Vector<double> aside = {0, 0.2, 0.1};
      const int slide = ball(world, {.v = v * way + aside});
      world.add_joint({"end_stops",
                       {slide, world.ground()},
                       {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"t", along}, {"lower", {-0.5}}, {"upper", {0.7}}},
                       {}});
      run(world, 1, 0.01);
      EXPECT_NEAR(dot(place_of(world, slide), way), v > 0 ? 0.7 : -0.5, 1e-4) << row.name;
      const Vector<double> rest = place_of(world, slide) - dot(place_of(world, slide), way) * way;
      EXPECT_LT(norm(rest - (aside - dot(aside, way) * way)), 1e-9) << row.name;
    }
  }
}

// x = v/w sin(w t), w^2 = c/m, until it stands at v/w after a quarter period; there it stays.
TEST(RowsInSpace, APinStopsInItsSeat) {
  constexpr double m = 2, c = 30, v = 1.5;
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(free_fall(row.integrator));
    const int pin = ball(world, {.v = v * way});
    world.add_joint(
        {"press_fit", {pin, world.ground()}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"t", along}, {"c", {c}}}, {}});
    run(world, 1, 0.005);
    EXPECT_LT(norm(place_of(world, pin) - (v / std::sqrt(c / m)) * way), row.order > 2 ? 1e-7 : 0.02) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test::in_space
