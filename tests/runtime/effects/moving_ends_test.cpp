// Ends that follow functions of time: of springs, of ropes and of coordinates. Their motion, and the work that they put
// in, by closed forms with every integrator, in the plane and in space.
#include <cmath>
#include <fmt/format.h>

#include "tests/runtime/effects/spatial_effects.hpp"
#include "tests/runtime/sines.hpp"

namespace cdot::test {
namespace {

using effects::expect_orders;
using effects::with;

// b (1 - cos(w t))
Profile rise(double b, double w) {
  return Profile::function([=](double t) -> ProfileValue {
    return {b * (1 - std::cos(w * t)), b * w * std::sin(w * t), b * w * w * std::cos(w * t)};
  });
}

// A World in the plane or in space, and one body along x.
template <class S>
struct Track {
  explicit Track(Integrator integrator, double mass, double x = 0, double gravity = 0)
      : world(down(integrator, gravity)) {
    typename S::BodyDefinition d;
    d.x = x, d.mass = mass;
    if constexpr (S::dimension == Dimension::planar) d.inertia = 1;
    else d.inertia = {1, 1, 1};
    body = world.add_body(d);
  }
  // Down is -x.
  static Settings down(Integrator integrator, double gravity) {
    Settings s = with(integrator);
    s.gravity_x = -gravity;
    return s;
  }
  static constexpr bool planar = S::dimension == Dimension::planar;
  static std::vector<double> at_centre() { return planar ? std::vector{0.0, 0.0} : std::vector{0.0, 0.0, 0.0}; }
  // A point that moves along x.
  static NamedValue moving(const char* point, const Profile& x) {
    return planar ? in_time(point, {x, 0.0}) : in_time(point, {x, 0.0, 0.0});
  }
  double x() const { return world.pose(body).x; }
  int rail() {
    return planar
               ? world.add_joint(
                     {"prismatic", {body, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}})
               : world.add_joint(
                     {"slider", {body, world.ground()}, {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"fa", {1, 0, 0}}}, {}});
  }
  // Returns the energy without a source, as a share of what moved.
  double run(double duration, double h) {
    BalanceWatch watch;
    watch.look(world.balance());
    for (long k = 0; k < std::lround(duration / h); ++k) {
      const StepResult step = world.step(h);
      EXPECT_TRUE(step) << in_words(step, "", "");
      watch.look(world.balance());
    }
    return watch.energy.share();
  }
  double work() const {
    double sum = 0;
    for (const WorkOfSource& of : world.work_by_source()) sum += of.work;
    return sum;
  }
  BasicWorld<S> world;
  int body;
};

// Resonance: x'' = -w^2 (x - A sin(w t)) from rest, so x = A/2 (sin(w t) - w t cos(w t)). The hand that moves the end
// puts in the whole energy, m x'^2/2 + k (x - A sin(w t))^2/2.
template <class S>
double error_at_resonance(Integrator integrator, double h) {
  constexpr double m = 2, w = 5, k = m * w * w, A = 0.1, t = 1;
  Track<S> track(integrator, m, 1);
  track.world.add_joint({"spring",
                         {track.body, track.world.ground()},
                         {{"pa", track.at_centre()}, track.moving("pb", sine(0, A, w)), {"k", {k}}, {"rest", {1}}},
                         {}});
  const double lost = track.run(t, h);
  const double x = A / 2 * (std::sin(w * t) - w * t * std::cos(w * t)), v = A / 2 * w * w * t * std::sin(w * t);
  const double stretch = x - A * std::sin(w * t), energy = 0.5 * m * v * v + 0.5 * k * stretch * stretch;
  const bool rough = row_of(integrator).order < 2;
  if (h < 0.01) {
    EXPECT_LT(lost, rough ? 0.1 : 2e-3) << row_of(integrator).name;
    EXPECT_NEAR(track.work(), energy, (rough ? 0.2 : 5e-3) * energy) << row_of(integrator).name;
  }
  return std::abs(track.x() - 1 - x);
}

TEST(MovingEnds, ASpringWhoseEndSwingsResonates) {
  const auto planar = [](Integrator i, double h) { return error_at_resonance<Planar<double>>(i, h); };
  const auto spatial = [](Integrator i, double h) { return error_at_resonance<Spatial<double>>(i, h); };
  expect_orders("resonance in the plane", 1. / 64, 0.1, planar);
  expect_orders("resonance in space", 1. / 64, 0.1, spatial);
}

// A weight on a rope that is hauled in, always taut: x = -l(t), l = 1 - b (1 - cos(w t)). The winch puts in
// m g dx + m v^2/2.
template <class S>
void expect_hauled_in(Integrator integrator) {
  constexpr double m = 3, g = 10, w = 4, b = 0.1, t = 0.6;
  const Profile length = Profile::function([](double time) -> ProfileValue {
    return {1 - b * (1 - std::cos(w * time)), -b * w * std::sin(w * time), -b * w * w * std::cos(w * time)};
  });
  Track<S> track(integrator, m, -1, g);
  track.world.add_joint(
      {"tearing_rope",
       {track.body, track.world.ground()},
       {{"pa", track.at_centre()}, {"pb", track.at_centre()}, in_time("l", {length}), {"strength", {1000}}},
       {}});
  const double lost = track.run(t, 1. / 500);
  const IntegratorRow& row = row_of(integrator);
  const double up = b * (1 - std::cos(w * t)), v = b * w * std::sin(w * t);
  EXPECT_NEAR(track.x(), -1 + up, row.order > 2 ? 1e-9 : 1e-3) << row.name;
  EXPECT_NEAR(track.world.velocity(track.body).x, v, row.order > 2 ? 1e-9 : 5e-3) << row.name;
  EXPECT_NEAR(track.work(), m * g * up + 0.5 * m * v * v, row.order > 2 ? 1e-6 : 0.02) << row.name;
  EXPECT_LT(lost, row.order > 2 ? 1e-6 : 5e-3) << row.name;
}

TEST(MovingEnds, ARopeIsHauledInWithTheWorkOfItsWinch) {
  for (const IntegratorRow& row : integrator_rows) {
    expect_hauled_in<Planar<double>>(row.integrator);
    expect_hauled_in<Spatial<double>>(row.integrator);
  }
}

// A stop rises as b (1 - cos(w t)) and pushes a block, until it slows at pi/(2 w): then the block leaves at b w.
template <class S>
void expect_pushed(Integrator integrator, double sign) {
  constexpr double m = 2, w = 3, b = 0.2, leaves = pi / (2 * w), t = 1;
  Track<S> track(integrator, m);
  const int rail = track.rail();
  const char* const end = sign > 0 ? "lower" : "upper";
  add_effect(track.world, rail, "slide", SpecEffect{"limit", {in_time(end, {rise(sign * b, w)})}});
  const double from = track.world.coordinate(rail, "slide");
  EXPECT_EQ(from, 0);
  const double lost = track.run(t, 1. / 500);
  const IntegratorRow& row = row_of(integrator);
  const double far = sign * (b + b * w * (t - leaves));
  EXPECT_NEAR(track.world.coordinate(rail, "slide"), far, row.order > 2 ? 1e-7 : 5e-3) << row.name;
  EXPECT_NEAR(track.work(), 0.5 * m * b * w * b * w, row.order > 2 ? 1e-7 : 5e-3) << row.name;
  EXPECT_LT(lost, row.order > 2 ? 1e-6 : 2e-2) << row.name;
}

TEST(MovingEnds, AStopPushesABlockAndLetsItGo) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double sign : {1.0, -1.0}) {
      expect_pushed<Planar<double>>(row.integrator, sign);
      expect_pushed<Spatial<double>>(row.integrator, sign);
    }
}

// From 0.46 to 1.1 s the ends have crossed. They hold the block at the lower one, which moves up, while the other one
// moves down.
template <class S>
void expect_held_at_lower_end(Integrator integrator) {
  Track<S> track(integrator, 2);
  const int rail = track.rail();
  add_effect(track.world, rail, "slide",
             SpecEffect{"limit", {in_time("lower", {sine(0, 0.2, 4)}), in_time("upper", {rise(-0.4, 2)})}});
  track.run(0.3, 1. / 1000);
  EXPECT_NEAR(track.world.coordinate(rail, "slide"), 0.2 * std::sin(1.2), 1e-11) << name_of(integrators, integrator);
  EXPECT_NEAR(track.world.coordinate_rate(rail, "slide"), 0.8 * std::cos(1.2), 2e-3)
      << name_of(integrators, integrator);
}

TEST(MovingEnds, EndsThatCrossMoveAsTheLowerOne) {
  for (const IntegratorRow& row : integrator_rows) {
    expect_held_at_lower_end<Planar<double>>(row.integrator);
    expect_held_at_lower_end<Spatial<double>>(row.integrator);
  }
}

// A falling block passes an end before the ends cross, both within a step whose error is none.
TEST(MovingEnds, EndsThatCrossWithinAStepAreMet) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Track<Planar<double>> track(integrator, 4, 0, 9.81);
    const int rail = track.rail();
    add_effect(track.world, rail, "slide",
               SpecEffect{"limit", {in_time("lower", {cosine(0, -0.2, 4)}), in_time("upper", {cosine(0.1, 0.2, 4)})}});
    track.run(0.6, 0.6);
    EXPECT_NEAR(track.world.coordinate(rail, "slide"), -0.2 * std::cos(2.4), 1e-6) << name_of(integrators, integrator);
  }
}

// A motor of unlimited force with the speed 2 cos(pi t) drives a block against an end at 0.3 m, and away from it from
// 0.5 s on.
template <class S>
void expect_left_as_the_motor_turns_back(Integrator integrator) {
  Track<S> track(integrator, 3);
  const int rail = track.rail();
  add_effect(track.world, rail, "slide", SpecEffect{"motor", {in_time("speed", {cosine(0, 2, pi)})}});
  add_effect(track.world, rail, "slide", SpecEffect{"limit", {{"lower", {-1}}, {"upper", {0.3}}}});
  track.run(0.4, 0.01);
  EXPECT_NEAR(track.world.coordinate(rail, "slide"), 0.3, 1e-9) << name_of(integrators, integrator);
  track.run(0.3, 0.01);
  EXPECT_NEAR(track.world.coordinate(rail, "slide"), 0.3 - 2 / pi * (1 - std::sin(0.7 * pi)), 0.02)
      << name_of(integrators, integrator);
}

TEST(MovingEnds, AMotorThatTurnsBackLeavesItsEnd) {
  for (const IntegratorRow& row : integrator_rows) {
    expect_left_as_the_motor_turns_back<Planar<double>>(row.integrator);
    expect_left_as_the_motor_turns_back<Spatial<double>>(row.integrator);
  }
}

// The same with friction, whose side turns round with the motor: it slips, and the motor has its speed at all times.
TEST(MovingEnds, AMotorTurnsBackAgainstFriction) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double most : {100.0, unlimited}) {
      Track<Planar<double>> track(row.integrator, 3);
      const int rail = track.rail();
      track.world.set_velocity(track.body, {2, 0, 0});
      SpecEffect motor{"motor", {in_time("speed", {cosine(0, 2, pi)})}};
      if (most < unlimited) motor.parameters.push_back({"max", {most}});
      add_effect(track.world, rail, "slide", motor);
      add_effect(track.world, rail, "slide", DryFriction{4});
      const double start = track.world.coordinate(rail, "slide");
      for (const double t : {0.4, 0.8, 1.2, 1.6}) {
        track.run(0.4, 0.01);
        EXPECT_NEAR(track.world.coordinate(rail, "slide"), start + 2 / pi * std::sin(pi * t),
                    row.order > 2 ? 1e-7 : 0.03)
            << row.name << " at " << t << " s, at most " << most << " N";
      }
    }
}

// Two rods in a row under gravity. A motor of unlimited force turns the first against its end.
struct PressedArm {
  World<double> world;
  int hinge, elbow;
  explicit PressedArm(Integrator integrator) : world(under_gravity(integrator)) {
    const int first = world.add_body({.x = 0.5, .mass = 1, .inertia = 1. / 12});
    const int second = world.add_body({.x = 1.5, .mass = 2, .inertia = 2. / 12});
    hinge = revolute(world, world.ground(), first, 0, 0, -0.5, 0);
    elbow = revolute(world, first, second, 0.5, 0, -0.5, 0);
    add_motor(world, hinge, "angle", {.speed = 1.8});
    add_limit(world, hinge, "angle", {.lower = -0.5, .upper = 0.5});
    add_limit(world, elbow, "angle", {.lower = -0.6, .upper = 0.6});
  }
  static Settings under_gravity(Integrator integrator) {
    Settings s = with(integrator);
    s.gravity_y = -9.81;
    return s;
  }
};

// A motor of unlimited force presses a rod on its end, whatever a load does. A second rod falls on the end between both
// and stays there: its blow would turn back a rod that is only held.
TEST(MovingEnds, AMotorThatPressesYieldsToNoBlow) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    PressedArm arm(integrator);
    World<double>& world = arm.world;
    const int hinge = arm.hinge, elbow = arm.elbow;
    add_effect(world, hinge, "angle", SpecEffect{"load", {in_time("push", {sine(0, 30, 20)})}});
    bool met = false;
    for (int k = 0; k < 150; ++k) {
      ASSERT_TRUE(world.step(0.01));
      if (k <= 40) continue;
      met |= world.coordinate(elbow, "angle") < -0.6 + 1e-8;
      EXPECT_NEAR(world.coordinate(hinge, "angle"), 0.5, 1e-8) << name_of(integrators, integrator);
      EXPECT_NEAR(met ? world.coordinate_rate(elbow, "angle") : 0, 0, 1e-8) << name_of(integrators, integrator);
    }
    EXPECT_TRUE(met) << name_of(integrators, integrator);
    fmt::print("  {}: {} events\n", name_of(integrators, integrator), world.step_counts().events);
    EXPECT_LE(world.step_counts().events, 4) << name_of(integrators, integrator);
  }
}

// By the other methods the blow moves the first rod off its end by a little in a step. The motor closes that way in the
// next one: slowly, or it would throw the second rod back.
TEST(MovingEnds, AMotorThatPressesThrowsNothingBack) {
  for (const IntegratorRow& row : integrator_rows) {
    PressedArm arm(row.integrator);
    for (int k = 0; k < 1500; ++k) ASSERT_TRUE(arm.world.step(0.001)) << row.name;
    const double shoulder = arm.world.coordinate(arm.hinge, "angle"), bend = arm.world.coordinate(arm.elbow, "angle");
    fmt::print("  {}: {:.4f} {:.4f}\n", row.name, shoulder, bend);
    EXPECT_NEAR(shoulder, 0.5, 1e-3) << row.name;
    EXPECT_NEAR(bend, -0.6, 1e-3) << row.name;
  }
}

// A racket that moves at v meets a block at rest without a bounce: the block leaves with v, which the racket puts in.
TEST(MovingEnds, ARacketHitsABlock) {
  constexpr double m = 2, v = 3, way = 0.3, t = 0.5;
  for (const IntegratorRow& row : integrator_rows) {
    Track<Planar<double>> track(row.integrator, m, way);
    const int rail = track.rail();
    const Profile racket = Profile::function([](double time) -> ProfileValue { return {v * time - way, v, 0}; });
    const double start = track.world.coordinate(rail, "slide");
    add_effect(track.world, rail, "slide", SpecEffect{"limit", {in_time("lower", {racket})}});
    track.run(t, 1. / 500);
    EXPECT_NEAR(track.world.coordinate(rail, "slide"), std::max(start, v * t - way), 1e-2) << row.name;
    EXPECT_NEAR(track.world.coordinate_rate(rail, "slide"), v, 1e-2) << row.name;
    EXPECT_NEAR(track.work(), 0.5 * m * v * v, 0.02 * 0.5 * m * v * v) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test
