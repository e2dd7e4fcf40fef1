// Effects from specs in space, by closed forms with every integrator.
#include "tests/runtime/effects/spatial_effects.hpp"

#include <functional>

namespace cdot::test::in_space {
namespace {

using effects::expect_orders;

// A body on a hinge of the ground about (1, 2, 2)/3, turned by `angle`; its turn is read by Euler parameters.
struct Wheel {
  SpatialWorld<double> world;
  int body;
  std::vector<double> axis = {1.0 / 3, 2.0 / 3, 2.0 / 3};

  Wheel(Integrator integrator, double inertia, double angle = 0) : world(free_fall(integrator)) {
    SpatialBodyDefinition d;
    const double s = std::sin(angle / 2);
    d.e0 = std::cos(angle / 2), d.e1 = s * axis[0], d.e2 = s * axis[1], d.e3 = s * axis[2];
    d.mass = 1, d.inertia = {inertia, inertia, inertia};
    body = world.add_body(d);
    world.add_joint({"hinge", {world.ground(), body}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"fa", axis}}, {}});
  }
  // fb of the effect is what fa is at the angle 0.
  void add(const char* effect, std::vector<NamedValue> values) {
    // Two axes across: y as any normal of the axis.
    const std::vector<double> frame = {axis[0], axis[1], axis[2], 2.0 / 3, 1.0 / 3, -2.0 / 3};
    values.push_back({"fa", frame});
    values.push_back({"fb", frame});
    world.add_joint({effect, {world.ground(), body}, std::move(values), {}});
  }
  double angle() const {
    const auto q = world.pose(body);
    return 2 * std::atan2(q.e1 * axis[0] + q.e2 * axis[1] + q.e3 * axis[2], q.e0);
  }
  double rate() const {
    const auto v = world.velocity(body);
    return v.wx * axis[0] + v.wy * axis[1] + v.wz * axis[2];
  }
};

// x = m v/d (1 - exp(-d t/m)), to a damper along the way and in a thick fluid.
double error_of_damped(Integrator integrator, double h, bool by_damper) {
  constexpr double m = 2, d = 3;
  const Vector<double> v = {1, -2, 2};
  SpatialWorld<double> world(free_fall(integrator));
  const int body = ball(world, {.x = v, .v = v});
  if (by_damper)
    world.add_joint({"damper", {body, world.ground()}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"d", {d}}}, {}});
  else world.add_joint({"viscous_drag", {body}, {{"pa", {0, 0, 0}}, {"d", {d}}}, {}});
  run(world, 1, h);
  return norm(place_of(world, body) - (1 + m / d * (1 - std::exp(-d / m))) * v);
}

TEST(EffectsInSpace, ADamperAndAThickFluidStopABall) {
  for (const bool by_damper : {true, false})
    expect_orders(by_damper ? "damper" : "viscous_drag", 0.02, 0.2,
                  [&](Integrator integrator, double h) { return error_of_damped(integrator, h, by_damper); });
}

// 1/|w| = 1/|w_0| + c t/I.
TEST(EffectsInSpace, AFluidSlowsASpin) {
  constexpr double I = 0.5, c = 0.2;
  const Vector<double> w = {2, -3, 6};
  expect_orders("rotational_drag", 0.02, 0.3, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.w = w});
    world.add_joint({"rotational_drag", {body}, {{"c", {c}}}, {}});
    run(world, 1, h);
    const auto v = world.velocity(body);
    return norm(Vector<double>{v.wx, v.wy, v.wz} - (1 / (1 + c * 7 / I)) * w);
  });
}

// In axes that move with the air a ball of speed u flies (m/c) ln(1 + c u t/m) far.
TEST(EffectsInSpace, ABallFliesInAWind) {
  constexpr double m = 2, c = 0.4;
  const Vector<double> air = {3, 1, -1}, v = {1, -4, 2};
  expect_orders("wind", 0.025, 0.3, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.v = v});
    world.add_joint({"wind", {body}, {{"pa", {0, 0, 0}}, {"wind_velocity", {3, 1, -1}}, {"c", {c}}}, {}});
    run(world, 2, h);
    const double u = norm(v - air);
    return norm(place_of(world, body) - 2 * air - (m / c * std::log(1 + c * u * 2 / m) / u) * (v - air));
  });
}

// Across a field, and across the axis of a spin, the way is a circle; along it nothing changes: a helix of the angular
// velocity `turn` about n, which makes s = v_along t + v_across sin(turn t)/turn + (n x v) (1 - cos(turn t))/turn.
double off_helix(Vector<double> place, Vector<double> v, Vector<double> n, double turn, double t) {
  const Vector<double> along = dot(v, n) * n, across = v - along;
  return norm(place - t * along - (std::sin(turn * t) / turn) * across -
              ((1 - std::cos(turn * t)) / turn) * cross(n, across));
}

TEST(EffectsInSpace, AChargeAndASpinningBallFlyAHelix) {
  const Vector<double> v = {1, -2, 2}, n = {2.0 / 3, 2.0 / 3, 1.0 / 3};
  constexpr double m = 2, B = 5, c = 0.4, w = 9;
  expect_orders("magnetic_field", 0.02, 0.5, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.v = v});
    world.add_joint({"magnetic_field", {body}, {{"pa", {0, 0, 0}}, {"B", {B * n.x, B * n.y, B * n.z}}}, {}});
    run(world, 1, h);
    return off_helix(place_of(world, body), v, n, -B / m, 1);
  });
  expect_orders("magnus", 0.02, 0.5, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {.v = v, .w = w * n});
    world.add_joint({"magnus", {body}, {{"pa", {0, 0, 0}}, {"c", {c}}}, {}});
    run(world, 1, h);
    return off_helix(place_of(world, body), v, n, c * w / m, 1);
  });
}

// On a circle about a fixed mass, and about each other: w^2 = mu/(m r^3), with the reduced mass for two.
TEST(EffectsInSpace, AMoonAndAPairOfStarsCircle) {
  constexpr double mu = 6, r = 1.5;
  const Vector<double> out = {2.0 / 3, -1.0 / 3, 2.0 / 3}, ahead = {1.0 / 3, -2.0 / 3, -2.0 / 3};
  const auto off = [&](Vector<double> place, double w, double radius) {
    return norm(place - (radius * std::cos(w)) * out - (radius * std::sin(w)) * ahead);
  };
  expect_orders("gravity_well", 0.02, 0.3, [&](Integrator integrator, double h) {
    constexpr double m = 2;
    const double w = std::sqrt(mu / (m * r * r * r));
    SpatialWorld<double> world(free_fall(integrator));
    const int moon = ball(world, {.x = r * out, .v = (r * w) * ahead});
    world.add_joint({"gravity_well", {moon}, {{"pa", {0, 0, 0}}, {"centre", {0, 0, 0}}, {"mu", {mu}}}, {}});
    run(world, 1, h);
    return off(place_of(world, moon), w, r);
  });
  expect_orders("gravity_between", 0.02, 0.3, [&](Integrator integrator, double h) {
    constexpr double m[2] = {2, 1}, reduced = 2.0 / 3;
    const double w = std::sqrt(mu / (reduced * r * r * r)), at[2] = {r / 3, -2 * r / 3};
    SpatialWorld<double> world(free_fall(integrator));
    int star[2];
    for (const int k : {0, 1}) star[k] = ball(world, {.x = at[k] * out, .v = (at[k] * w) * ahead, .mass = m[k]});
    world.add_joint({"gravity_between", {star[0], star[1]}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"mu", {mu}}}, {}});
    run(world, 1, h);
    return std::max(off(place_of(world, star[0]), w, at[0]), off(place_of(world, star[1]), w, at[1]));
  });
}

// A ball that floats half immersed swings with w^2 = (3/4) weight/(m r) = (3/2) g/r.
TEST(EffectsInSpace, AFloatingBallBobs) {
  constexpr double m = 2, r = 0.4, start = 1e-5, t = 1;
  const double w = std::sqrt(1.5 * g / r);
  expect_orders(
      "buoyancy", 0.01, 0.5,
      [&](Integrator integrator, double h) {
        SpatialWorld<double> world(free_fall(integrator, g));
        const int body = ball(world, {.x = {0.1, 0.2, 3 + start}});
        world.add_joint({"buoyancy", {body}, {{"surface", {0, 0, 3}}, {"radius", {r}}, {"weight", {2 * m * g}}}, {}});
        run(world, t, h);
        return std::abs(world.pose(body).z - 3 - start * std::cos(w * t)) / start;
      },
      {.floor = 1e-8});
}

// Out of the liquid the ball falls; deep in it the whole weight of the liquid lifts it.
TEST(EffectsInSpace, ABallOutOfTheLiquidAndDeepInIt) {
  constexpr double m = 2, r = 0.4, lift = 50;
  for (const double z : {2.0, -3.0}) {
    SpatialWorld<double> world(free_fall(Integrator::rk4, g));
    const int body = ball(world, {.x = {0, 0, z}});
    world.add_joint({"buoyancy", {body}, {{"surface", {0, 0, 0}}, {"radius", {r}}, {"weight", {lift}}}, {}});
    run(world, 0.2, 0.05);
    EXPECT_NEAR(world.velocity(body).z, 0.2 * ((z < 0 ? lift / m : 0) - g), 1e-12);
  }
}

// angle = start exp(-a t) (cos w t + a/w sin w t), a = d/2I, w^2 = k/I - a^2.
TEST(EffectsInSpace, ATorsionSpringTurnsAWheelBack) {
  constexpr double I = 0.5, k = 8, d = 0.6, start = 0.7, t = 1;
  expect_orders("torsion_spring", 0.01, 0.1, [&](Integrator integrator, double h) {
    Wheel wheel(integrator, I, start);
    wheel.add("torsion_spring", {{"k", {k}}, {"rest", {0}}, {"d", {d}}});
    run(wheel.world, t, h);
    const double a = d / (2 * I), w = std::sqrt(k / I - a * a);
    return std::abs(wheel.angle() - start * std::exp(-a * t) * (std::cos(w * t) + a / w * std::sin(w * t)));
  });
}

// w = idle (1 - exp(-stall t/(I idle))).
TEST(EffectsInSpace, AMotorOfDirectCurrentRunsUp) {
  constexpr double stall = 4, idle = 10, I = 0.3, t = 0.3;
  expect_orders("dc_motor", 0.02, 0.3, [&](Integrator integrator, double h) {
    Wheel wheel(integrator, I);
    wheel.add("dc_motor", {{"stall", {stall}}, {"idle", {idle}}});
    run(wheel.world, t, h);
    return std::abs(wheel.rate() - idle * (1 - std::exp(-stall * t / (I * idle))));
  });
}

// Without damping a servo conserves I w^2/2 + most^2/k (sqrt(1 + (k x/most)^2) - 1), x from the target.
TEST(EffectsInSpace, AServoPullsAsItsEnergySays) {
  constexpr double I = 0.5, k = 40, most = 3, start = 0.8, t = 0.6;
  const auto energy = [](double x) { return most * most / k * (std::sqrt(1 + k * x / most * (k * x / most)) - 1); };
  expect_orders("servo", 0.01, 0.2, [&](Integrator integrator, double h) {
    Wheel wheel(integrator, I, start);
    wheel.add("servo", {{"target", {0}}, {"k", {k}}, {"most", {most}}});
    run(wheel.world, t, h);
    EXPECT_LT(wheel.angle(), start - 0.1);
    return std::abs(I / 2 * wheel.rate() * wheel.rate() + energy(wheel.angle()) - energy(start));
  });
}

// x = amplitude/(m omega^2) (omega t - sin(omega t)).
TEST(EffectsInSpace, AShakerShakesABallAway) {
  constexpr double m = 2, omega = 5, t = 1;
  const Vector<double> amplitude = {3, -1, 2};
  expect_orders("shaker", 0.02, 0.2, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = ball(world, {});
    world.add_joint({"shaker", {body}, {{"pa", {0, 0, 0}}, {"amplitude", {3, -1, 2}}, {"omega", {omega}}}, {}});
    run(world, t, h);
    return norm(place_of(world, body) - ((omega * t - std::sin(omega * t)) / (m * omega * omega)) * amplitude);
  });
}

// Along each axis a mount is a spring of its own; a small twist has w^2 = k/I, a small bend likewise.
TEST(EffectsInSpace, AMountSwingsAlongEachAxis) {
  constexpr double m = 2, I = 0.5, k[4] = {80, 20, 6, 2}, small = 1e-5;
  const Vector<double> start = {0.1, -0.2, 0.15};
  const auto add = [&](SpatialWorld<double>& world, const Start& at) {
    const int body = ball(world, at);
    world.add_joint({"bushing",
                     {world.ground(), body},
                     {{"pa", {0, 0, 0}},
                      {"pb", {0, 0, 0}},
                      {"fa", {1, 0, 0}},
                      {"fb", {1, 0, 0}},
                      {"k_along", {k[0]}},
                      {"k_across", {k[1]}},
                      {"k_twist", {k[2]}},
                      {"k_bend", {k[3]}}},
                     {}});
    return body;
  };
  expect_orders("bushing", 0.02, 0.1, [&](Integrator integrator, double h) {
    SpatialWorld<double> world(free_fall(integrator));
    const int body = add(world, {.x = start});
    run(world, 1, h);
    const double along = std::cos(std::sqrt(k[0] / m)), across = std::cos(std::sqrt(k[1] / m));
    return norm(place_of(world, body) - Vector<double>{start.x * along, start.y * across, start.z * across});
  });
  expect_orders("bushing that turns", 0.01, 0.2,
                [&](Integrator integrator, double h) {
                  SpatialWorld<double> world(free_fall(integrator));
                  const int body = add(world, {.w = {small, -small, 2 * small}});
                  run(world, 1, h);
                  const double twist = std::sqrt(k[2] / I), bend = std::sqrt(k[3] / I);
                  const auto q = world.pose(body);
                  const Vector<double> turned = {2 * q.e1, 2 * q.e2, 2 * q.e3};
                  return norm(turned - small * Vector<double>{std::sin(twist) / twist, -std::sin(bend) / bend,
                                                              2 * std::sin(bend) / bend}) /
                         small;
                },
                {.floor = 1e-8});
}

// A jumper on a taut cord: z = -rest - m g/k - (stretch - m g/k) cos(sqrt(k/m) t). The rounding counts as its fourth
// power.
TEST(EffectsInSpace, AJumperSwingsOnATautCord) {
  constexpr double m = 2, k = 60, rest = 3, stretch = 0.6, t = 0.7;
  expect_orders("bungee", 0.01, 0.1,
                [&](Integrator integrator, double h) {
                  SpatialWorld<double> world(free_fall(integrator, g));
                  const int jumper = ball(world, {.x = {0, 0, -rest - stretch}});
                  world.add_joint({"bungee",
                                   {jumper, world.ground()},
                                   {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"rest", {rest}}, {"k", {k}}},
                                   {}});
                  run(world, t, h);
                  return std::abs(world.pose(jumper).z + rest + m * g / k +
                                  (stretch - m * g / k) * std::cos(std::sqrt(k / m) * t));
                },
                {.floor = 1e-9});
}

// A slack cord does nothing.
TEST(EffectsInSpace, AJumperFallsFreelyOnASlackCord) {
  SpatialWorld<double> world(free_fall(Integrator::rk4, g));
  const int jumper = ball(world, {.x = {0, 0, -1}});
  world.add_joint(
      {"bungee", {jumper, world.ground()}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"rest", {3}}, {"k", {60}}}, {}});
  run(world, 0.4, 0.05);
  EXPECT_NEAR(world.velocity(jumper).z, -0.4 * g, 1e-5);
}

// Simpson's rule.
double integral(const std::function<double(double)>& f, double from, double to) {
  constexpr int parts = 2000;
  double sum = f(from) + f(to);
  for (int k = 1; k < parts; ++k) sum += (k % 2 == 1 ? 4 : 2) * f(from + (to - from) * k / parts);
  return sum * (to - from) / parts / 3;
}

// A piston with a speed of its own is pushed out from length l to 1.5 l in the time of dt = dl/v, and
// m v^2/2 = m v_0^2/2 + F l/(kappa - 1) (1 - (l/length)^(kappa - 1)).
TEST(EffectsInSpace, AGasSpringPushesAPiston) {
  constexpr double m = 2, F = 30, l = 0.6, kappa = 1.4, v0 = 0.5;
  const Vector<double> way = {2.0 / 3, -1.0 / 3, 2.0 / 3};
  const double duration = integral(
      [&](double length) {
        return 1 / std::sqrt(v0 * v0 + 2 * F * l / m / (kappa - 1) * (1 - std::pow(l / length, kappa - 1)));
      },
      l, 1.5 * l);
  expect_orders("gas_spring", 0.02, 0.1,
                [&](Integrator integrator, double h) {
                  SpatialWorld<double> world(free_fall(integrator));
                  const int piston = ball(world, {.x = l * way, .v = v0 * way});
                  world.add_joint(
                      {"gas_spring", {piston, world.ground()}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"F", {F}}}, {}});
                  run(world, duration, h);
                  return norm(place_of(world, piston) - (1.5 * l) * way);
                },
                {.floor = 1e-10});
}

}  // namespace
}  // namespace cdot::test::in_space
