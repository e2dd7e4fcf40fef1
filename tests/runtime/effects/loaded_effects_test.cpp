// Friction in proportion to a load: of a contact that the same effect has, or of the joint on whose coordinate it acts.
#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::advance, effects::with;

constexpr double weight = 9.81;  // of 1 kg

// The normal force is not given, but found: m g cos(slope).
TEST(LoadedEffects, ABlockOnAnInclineSlipsAtItsAngleOfFriction) {
  constexpr double mu = 0.4, m = 3;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double off : {-0.02, 0.02}) {
      const double slope = std::atan(mu) + off, c = std::cos(slope), s = std::sin(slope);
      World<double> world(with(row.integrator, -weight));
      const int block = world.add_body({.mass = m, .inertia = 1, .fixed_rotation = true});
      world.add_joint({"rough_line", {block, world.ground()}, {{"pb", {0, 0}}, {"n", {s, c}}, {"mu", {mu}}}, {}});
      advance(world, 1, 0.01);
      const double right = off < 0 ? 0 : weight * (s - mu * c);
      const auto v = world.velocity(block);
      EXPECT_NEAR(c * v.x - s * v.y, right, 1e-8) << row.name << ", " << off;
      EXPECT_NEAR(s * v.x + c * v.y, 0, 1e-8) << row.name;
      const double way = off < 0 ? 0 : right / 2;
      EXPECT_NEAR(std::hypot(world.pose(block).x, world.pose(block).y), way, row.order == 1 ? 2e-2 : 1e-3) << row.name;
    }
  }
}

// It slides with v = v0 - mu g t and w = -(5/2) mu g t / r, and rolls from t = 2 v0 / (7 mu g) on with v = 5/7 v0.
TEST(LoadedEffects, ASlidingBallStartsToRoll) {
  constexpr double mu = 0.2, m = 1.5, r = 0.3, v0 = 3, rolls = 2 * v0 / (7 * mu * weight);
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    const int ball = world.add_body({.y = r, .vx = v0, .mass = m, .inertia = 0.4 * m * r * r});
    world.add_joint(
        {"rough_line", {ball, world.ground()}, {{"pb", {0, 0}}, {"n", {0, 1}}, {"radius", {r}}, {"mu", {mu}}}, {}});
    ASSERT_GT(rolls, 0.2);
    advance(world, 0.2, 0.01);
    EXPECT_NEAR(world.velocity(ball).x, v0 - mu * weight * 0.2, 1e-8) << row.name;
    EXPECT_NEAR(world.velocity(ball).w, -2.5 * mu * weight * 0.2 / r, 1e-7) << row.name;
    advance(world, 0.8, 0.01);
    EXPECT_NEAR(world.velocity(ball).x, 5 * v0 / 7, 1e-7) << row.name;
    EXPECT_NEAR(world.velocity(ball).w, -5 * v0 / 7 / r, 1e-6) << row.name;
    const double way = v0 * rolls - mu * weight * rolls * rolls / 2 + 5 * v0 / 7 * (1 - rolls);
    EXPECT_NEAR(world.pose(ball).x, way, row.order > 2 ? 1e-8 : 0.02) << row.name;
    double friction = 0;
    for (const WorkOfSource& work : world.work_by_source())
      if (work.name == "rough_line") friction = work.work;
    EXPECT_NEAR(friction, -m * v0 * v0 / 7, row.order > 2 ? 1e-8 : 0.1) << row.name;
  }
}

// Painlevé's rod: no finite force balances the friction that grows with its own load, and an impulse at the end that
// slides stops it at once. About that end the rod keeps its angular momentum; then it turns about it as about a pin.
TEST(LoadedEffects, AJamTakesNoTime) {
  constexpr double mass = 1, inertia = 5.0 / 3, x = -1, y = 2, v = 4, lasts = 0.05;
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Settings settings = with(integrator, -weight);
    settings.local_error = 1e-10;
    World<double> jams(settings), turns(settings);
    const int rod = jams.add_body({.x = x, .y = y, .vx = v, .mass = mass, .inertia = inertia});
    jams.add_joint(
        {"rough_line", {rod, jams.ground()}, {{"pa", {-x, -y}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"mu", {2}}}, {}});
    const double w = -mass * y * v / (inertia + mass * (x * x + y * y));
    const int pinned =
        turns.add_body({.x = x, .y = y, .vx = -w * y, .vy = w * x, .w = w, .mass = mass, .inertia = inertia});
    turns.add_joint({"revolute", {turns.ground(), pinned}, {{"pa", {0, 0}}, {"pb", {-x, -y}}}, {}});
    ASSERT_TRUE(jams.step(lasts));
    ASSERT_TRUE(turns.step(lasts));
    const auto name = name_of(integrators, integrator);
    EXPECT_NEAR(jams.pose(rod).angle, turns.pose(pinned).angle, 1e-8) << name;
    EXPECT_NEAR(jams.velocity(rod).w, turns.velocity(pinned).w, 1e-8) << name;
    EXPECT_EQ(jams.step_counts().rescued, 1) << name;
  }
}

TEST(LoadedEffects, ASliderOnARailSlowsByItsWeight) {
  constexpr double mu = 0.15, v0 = 2;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    const int slide = world.add_body({.vx = v0, .mass = 2, .inertia = 1});
    const int rail =
        world.add_joint({"prismatic", {slide, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
    add_effect(world, rail, "slide", SpecEffect{"rail_friction", {{"mu", {mu}}}});
    advance(world, 1, 0.01);
    EXPECT_NEAR(world.velocity(slide).x, v0 - mu * weight, 1e-8) << row.name;
    advance(world, 1, 0.01);
    EXPECT_NEAR(world.velocity(slide).x, 0, 1e-9) << row.name;
    EXPECT_NEAR(world.pose(slide).x, v0 * v0 / (2 * mu * weight), row.order > 2 ? 1e-8 : 0.02) << row.name;
  }
}

// A balanced wheel: the pin carries its weight, at any speed.
TEST(LoadedEffects, APinBrakesAWheelByItsWeight) {
  constexpr double mu = 0.2, radius = 0.05, m = 4, I = 0.5, w0 = 3;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    const int wheel = world.add_body({.w = w0, .mass = m, .inertia = I});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"pin_friction", {{"mu", {mu}}, {"radius", {radius}}}});
    advance(world, 1, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, w0 - mu * radius * m * weight / I, 1e-8) << row.name;
  }
}

TEST(LoadedEffects, InSpaceAHingeAndASliderDoAsInThePlane) {
  constexpr double mu = 0.2, radius = 0.05, m = 4, I = 0.5;
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(with(row.integrator, -weight));
    SpatialBodyDefinition d;
    d.wx = 3, d.mass = m, d.inertia = {I, 0.7, 0.7};
    const int wheel = world.add_body(d);
    d.wx = 0, d.vx = 2, d.z = 1;
    const int slide = world.add_body(d);
    const int hinge = world.add_joint(
        {"hinge", {world.ground(), wheel}, {{"pa", {0, 0, 0}}, {"fa", {1, 0, 0}}, {"pb", {0, 0, 0}}}, {}});
    const int rail = world.add_joint(
        {"slider", {world.ground(), slide}, {{"pa", {0, 0, 1}}, {"fa", {1, 0, 0}}, {"pb", {0, 0, 0}}}, {}});
    add_effect(world, hinge, "angle", SpecEffect{"pin_friction", {{"mu", {mu}}, {"radius", {radius}}}});
    add_effect(world, rail, "slide", SpecEffect{"rail_friction", {{"mu", {mu}}}});
    for (int n = 0; n < 50; ++n) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.velocity(wheel).wx, 3 - 0.5 * mu * radius * m * weight / I, 1e-8) << row.name;
    EXPECT_NEAR(world.velocity(slide).x, 2 - 0.5 * mu * weight, 1e-8) << row.name;
  }
}

struct Swing {
  double angle, rate;
};

// A rod on a rough pin. The force of the pin depends on the acceleration, and that on the friction: mu radius |N| with
// N = m (a - g) of the centre, solved here by bisection of the acceleration, and integrated by Runge-Kutta of order 4.
Swing rod_on_rough_pin(double mu_radius, double m, double l, double I, Swing s, double duration, int steps) {
  const auto acceleration = [&](double angle, double rate) {
    const auto missing = [&](double a) {
      const double radial = m * (l * rate * rate + weight * std::cos(angle)),
                   across = m * (l * a + weight * std::sin(angle));
      const double friction = mu_radius * std::hypot(radial, across) * (rate > 0 ? 1 : -1);
      return (I + m * l * l) * a + m * weight * l * std::sin(angle) + friction;
    };
    double low = -1e3, high = 1e3;
    for (int k = 0; k < 80; ++k) (missing(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  };
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const double k1 = acceleration(s.angle, s.rate), v2 = s.rate + h / 2 * k1;
    const double k2 = acceleration(s.angle + h / 2 * s.rate, v2), v3 = s.rate + h / 2 * k2;
    const double k3 = acceleration(s.angle + h / 2 * v2, v3), v4 = s.rate + h * k3;
    const double k4 = acceleration(s.angle + h * v3, v4);
    s.angle += h / 6 * (s.rate + 2 * v2 + 2 * v3 + v4), s.rate += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return s;
}

TEST(LoadedEffects, ARodOnARoughPinSwingsAsIntegratedByHand) {
  constexpr double mu = 0.3, radius = 0.2, m = 2, l = 0.5, I = 0.1, start = 1.2, duration = 0.3;
  const Swing right = rod_on_rough_pin(mu * radius, m, l, I, {start, -1e-3}, duration, 4000);
  ASSERT_LT(right.rate, -0.5);
  for (const IntegratorRow& row : integrator_rows) {
    const auto error_at = [&](double h) {
      World<double> world(with(row.integrator, -weight));
      const double s = std::sin(start), c = std::cos(start), w = -1e-3;
      const int rod = world.add_body(
          {.x = l * s, .y = -l * c, .angle = start, .vx = l * c * w, .vy = l * s * w, .w = w, .mass = m, .inertia = I});
      const int pin = world.add_joint({"revolute", {world.ground(), rod}, {{"pa", {0, 0}}, {"pb", {0, l}}}, {}});
      add_effect(world, pin, "angle", SpecEffect{"pin_friction", {{"mu", {mu}}, {"radius", {radius}}}});
      advance(world, duration, h);
      return std::abs(world.velocity(rod).w - right.rate);
    };
    const double coarse = error_at(0.01), fine = error_at(0.005);
    fmt::print("  {}: off by {:.1e} and {:.1e}\n", row.name, coarse, fine);
    EXPECT_LT(fine, row.order > 2 ? 1e-7 : 0.03) << row.name;
    EXPECT_TRUE(row.order > 2 || coarse / fine > 1.7) << row.name << ": " << coarse / fine;
  }
}

// With friction large beside the rod's inertia, b = m l mu radius / (I + m l^2) > 1, two loads of the pin solve
//   N^2 = radial^2 + (across - b N)^2,
// where it swings against its weight. The smaller one is that of friction that has grown from none.
TEST(LoadedEffects, ARodOnAVeryRoughPinHasTheSmallerOfTwoLoads) {
  constexpr double torque = 3, m = 2, l = 0.5, I = 0.1, about_pin = I + m * l * l, b = m * l * torque / about_pin;
  static_assert(b > 1);
  constexpr double start = 1.56, w0 = 0.3, duration = 0.01;
  Swing s{start, w0};
  constexpr int steps = 40000;
  for (int n = 0; n < steps; ++n) {
    const double radial = m * (l * s.rate * s.rate + weight * std::cos(s.angle)),
                 across = m * weight * std::sin(s.angle) * I / about_pin;
    const double N =
        (across * across + radial * radial) / (across * b + std::sqrt(across * across - (b * b - 1) * radial * radial));
    s.rate -= duration / steps * (m * weight * l * std::sin(s.angle) + torque * N) / about_pin;
    s.angle += duration / steps * s.rate;
  }
  ASSERT_GT(s.rate, 0.1);
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    const double x = std::sin(start), y = -std::cos(start);
    const int rod = world.add_body({.x = l * x,
                                    .y = l * y,
                                    .angle = start,
                                    .vx = -l * y * w0,
                                    .vy = l * x * w0,
                                    .w = w0,
                                    .mass = m,
                                    .inertia = I});
    const int pin = world.add_joint({"revolute", {world.ground(), rod}, {{"pa", {0, 0}}, {"pb", {0, l}}}, {}});
    add_effect(world, pin, "angle", SpecEffect{"pin_friction", {{"mu", {torque}}, {"radius", {1}}}});
    advance(world, duration, 1e-4);
    EXPECT_NEAR(world.velocity(rod).w, s.rate, row.order > 2 ? 1e-7 : 1e-5) << row.name;
  }
}

TEST(LoadedEffects, TheirBalanceCloses) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    const int ball = world.add_body({.y = 0.3, .vx = 3, .mass = 1, .inertia = 0.036});
    world.add_joint(
        {"rough_line", {ball, world.ground()}, {{"pb", {0, 0}}, {"n", {0, 1}}, {"radius", {0.3}}, {"mu", {0.2}}}, {}});
    EXPECT_LT(effects::unaccounted(world, 1, 0.005), row.order > 2 ? 1e-9 : 2e-2) << row.name;
  }
}

// A rod whose hook, above its centre, sticks on a rough line from 0.44 s on: then it swings as a pendulum. Of two
// starts that differ by 1e-9 rad/s, steps must stay as close as the motions. If the halves of RATTLE's steps undid each
// other's friction, the rates would be 4e-8 rad/s apart at the end.
TEST(LoadedEffects, AHookThatSticksForgetsErrors) {
  constexpr double l = 0.5, start = pi / 6, off = 1e-9;
  const auto end_of = [&](Integrator integrator, double spin) {
    World<double> world(with(integrator, -weight));
    const int rod = world.add_body(
        {.x = l * std::sin(start), .y = -l * std::cos(start), .angle = start, .w = spin, .mass = 1, .inertia = 0.05});
    world.add_joint(
        {"rough_line", {rod, world.ground()}, {{"pa", {0, l}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"mu", {0.2}}}, {}});
    advance(world, 1, 1e-3);
    return std::pair(world.pose(rod), world.velocity(rod));
  };
  for (const IntegratorRow& row : integrator_rows) {
    const auto [pose, v] = end_of(row.integrator, 6);
    const auto [other_pose, other_v] = end_of(row.integrator, 6 + off);
    fmt::print("  {}: {:.1e} rad, {:.1e} rad/s apart\n", row.name, std::abs(pose.angle - other_pose.angle),
               std::abs(v.w - other_v.w));
    EXPECT_LT(std::hypot(pose.x - other_pose.x, pose.y - other_pose.y), 10 * off) << row.name;
    EXPECT_LT(std::abs(pose.angle - other_pose.angle), 10 * off) << row.name;
    EXPECT_LT(std::abs(v.w - other_v.w), 10 * off) << row.name;
  }
}

// Painlevé's rod: with tan(angle) = 2 and mu = 2 > 4/3 no finite force keeps the sliding rod from sinking into the
// line. It jams: an impulse stops the slip at once. No step may sink, gain energy or fail.
TEST(LoadedEffects, PainlevesRodJams) {
  constexpr double mu = 2, m = 1, l = 1, I = m * l * l / 3, v0 = 4;
  const double tilt = std::atan(2.0), s = std::sin(tilt), c = std::cos(tilt);
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -weight));
    // The lower end slides ahead of the centre, which pushes it into the line.
    const int rod = world.add_body({.x = -l * c, .y = l * s, .vx = v0, .mass = m, .inertia = I});
    world.add_joint({"rough_line",
                     {rod, world.ground()},
                     {{"pa", {l * c, -l * s}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"mu", {mu}}},
                     {}});
    double energy = world.energy();
    const double first = energy;
    for (int n = 0; n < 20; ++n) {
      ASSERT_TRUE(world.step(0.005)) << row.name;
      const auto p = world.pose(rod);
      const double end = p.y + l * c * std::sin(p.angle) - l * s * std::cos(p.angle);
      EXPECT_GT(end, -1e-3) << row.name;
      const double now = world.energy();
      EXPECT_LT(now, energy + 1e-3 * first) << row.name << " at " << world.time();
      energy = now;
    }
    fmt::print("  {}: {:.4f} of {:.4f} J left\n", row.name, energy, first);
    EXPECT_LT(energy, 0.9 * first) << row.name;
  }
}

// The same rod meets the line at 1e-8 of the speed at which it slides. Then it jams, and stops by an impulse; leaving
// the line as slowly it slides on. So an error of 1e-5 decides between 4.8 J and 8 J, and one of 1e-11 does not.
TEST(LoadedEffects, TheErrorOfStepsDecidesWhetherARodJams) {
  constexpr double m = 1, l = 1, I = m * l * l / 3, v0 = 4, slowly = 1e-8 * v0;
  const double tilt = std::atan(2.0), s = std::sin(tilt), c = std::cos(tilt);
  const auto run = [&](double local_error, double vy, double mu) {
    Settings settings = with(Integrator::dop853, 0);
    settings.local_error = local_error;
    World<double> world(settings);
    const int rod = world.add_body({.x = -l * c, .y = l * s, .vx = v0, .vy = vy, .mass = m, .inertia = I});
    world.add_joint({"rough_line",
                     {rod, world.ground()},
                     {{"pa", {l * c, -l * s}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"mu", {mu}}},
                     {}});
    EXPECT_TRUE(world.step(1e-6));
    return std::pair(world.energy(), world.step_counts());
  };
  const auto [jammed, exact] = run(1e-12, -slowly, 2);
  EXPECT_LT(jammed, 5);
  EXPECT_EQ(exact.undecided, 0);
  EXPECT_NEAR(run(1e-12, slowly, 2).first, 8, 1e-6);
  const auto [loose_energy, loose] = run(1e-6, -slowly, 2);
  EXPECT_EQ(loose_energy, jammed);
  EXPECT_EQ(loose.undecided, 1);
  EXPECT_EQ(loose.undecided_joint, 0);
  EXPECT_EQ(run(1e-6, -1, 2).second.undecided, 0);  // a blow that jams in any case
  EXPECT_EQ(run(1e-6, -slowly, 0.2).second.undecided, 0);
}

// The same rod stands on the line, which then bears 8.5 N. Struck, it slides on and leaves the line at a 40th of that
// speed, while a ball beside it meets its own ground. From the load of before, the ball's blow would find a jam.
TEST(LoadedEffects, ABlowBeginsWithoutTheLoadsOfForces) {
  constexpr double m = 1, l = 1, I = m * l * l / 3, v = 4, up = 0.1, fall = 1, short_time = 1e-6;
  const double tilt = std::atan(2.0), s = std::sin(tilt), c = std::cos(tilt);
  Settings settings = with(Integrator::dop853, -10);
  World<double> world(settings);
  const int rod = world.add_body({.x = -l * c, .y = l * s, .mass = m, .inertia = I});
  const int ball = world.add_body({.x = 5, .mass = m, .inertia = I});
  world.add_joint(
      {"rough_line", {rod, world.ground()}, {{"pa", {l * c, -l * s}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"mu", {2}}}, {}});
  world.add_joint({"rough_line", {ball, world.ground()}, {{"pb", {5, 0}}, {"n", {0, 1}}, {"mu", {0}}}, {}});
  world.add_joint({"spring", {rod, ball}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"rest", {5}}, {"k", {1e-9}}}, {}});
  ASSERT_TRUE(world.step(short_time));
  world.set_velocity(rod, {v, up, 0});
  world.set_velocity(ball, {0, -fall, 0});
  ASSERT_TRUE(world.step(short_time));
  EXPECT_NEAR(world.velocity(rod).x, v, 1e-4);
  EXPECT_NEAR(world.velocity(rod).y, up, 1e-4);
  EXPECT_NEAR(world.velocity(ball).y, 0, 1e-9);
}

// Two rods of which the first one meets an end. As they fall, friction at the shoulder or none; or a motor of unlimited
// force turns it, from a blow on.
enum class Shoulder : char { smooth, rough, driven };
double rate_of_fore_arm(const Settings& settings, Shoulder shoulder, double step) {
  const SpecEffect rough{"pin_friction", {{"mu", {0.4}}, {"radius", {0.1}}}};
  World<double> world(settings);
  const int arm = world.add_body({.x = 0.5, .mass = 2, .inertia = 2.0 / 12}),
            fore = world.add_body({.x = 1.5, .mass = 5, .inertia = 5.0 / 12});
  const int pin = revolute(world, world.ground(), arm, 0, 0, -0.5, 0),
            elbow = revolute(world, arm, fore, 0.5, 0, -0.5, 0);
  if (shoulder == Shoulder::rough) add_effect(world, pin, "angle", rough);
  if (shoulder == Shoulder::driven) add_motor(world, pin, "angle", {.speed = -1});
  add_limit(world, pin, "angle", {.lower = -0.1, .upper = {}});
  add_effect(world, elbow, "angle", rough);
  advance(world, 0.2, step);
  return world.velocity(fore).w;
}

// RATTLE's friction counted twice in the blow by which such a motor starts, and where its steps parted the blow of the
// end, in which the first part went against the slip before it: by 0.03 rad/s, at steps of any length. Euler's and the
// midpoint rule's steps still part that blow, which turns the slip unless a motor drives it: FrictionOfBlows tells it.
TEST(LoadedEffects, TakeTheirShareOfABlowOnce) {
  for (const Shoulder shoulder : {Shoulder::smooth, Shoulder::rough, Shoulder::driven}) {
    Settings settings = with(Integrator::dop853, -weight);
    settings.local_error = 1e-10;
    const double right = rate_of_fore_arm(settings, shoulder, 0.01);
    for (const IntegratorRow& row : integrator_rows) {
      const bool parts = row.integrator == Integrator::euler || row.integrator == Integrator::implicit;
      if (parts && shoulder != Shoulder::driven) continue;
      for (const double step : {4e-4, 2e-4, 1e-4, 5e-5}) {
        if (row.order > 2 && step < 4e-4) continue;  // they locate the blow
        const double off = std::abs(rate_of_fore_arm(with(row.integrator, -weight), shoulder, step) - right);
        EXPECT_LT(off, row.order > 2 ? 1e-8 : 2 * step)
            << row.name << ", shoulder " << static_cast<int>(shoulder) << ", " << step;
      }
    }
  }
}

}  // namespace
}  // namespace cdot::test
