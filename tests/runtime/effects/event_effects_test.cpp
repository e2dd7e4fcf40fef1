// Events of effects: rows that act after a condition, and until another.
#include <cdot/snapshot.hpp>

#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::advance, effects::with;

// The methods of higher order meet an event in time, the others within a step.
double allowed(const IntegratorRow& row, double by_steps, double located = 1e-8) {
  return row.order > 2 ? located : by_steps;
}

TEST(EventEffects, AMotorIsSwitchedOnAndOff) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = world.add_body({.mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle",
               SpecEffect{"timed_motor", {{"speed", {2}}, {"max", {4}}, {"start", {0.203}}, {"stop", {0.407}}}});
    advance(world, 0.2, 0.01);
    EXPECT_EQ(world.velocity(wheel).w, 0) << row.name;
    advance(world, 0.3, 0.01);
    // By 8 rad/s^2 from `start` on until `stop`, then free.
    EXPECT_NEAR(world.velocity(wheel).w, 8 * 0.204, allowed(row, 0.1)) << row.name;
    const double w = world.velocity(wheel).w;
    advance(world, 0.3, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, w, 1e-12) << row.name;
  }
}

TEST(EventEffects, ASwitchAtTheEndOfTheWayStopsTheDrive) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = world.add_body({.mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"limit_switch", {{"speed", {100}}, {"max", {4}}, {"end", {0.777}}}});
    advance(world, 1, 0.01);
    // 8 rad/s^2 over 0.777 rad
    EXPECT_NEAR(world.velocity(wheel).w, std::sqrt(2 * 8 * 0.777), allowed(row, 0.1)) << row.name;
  }
}

TEST(EventEffects, ALatchClosesAndHolds) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = world.add_body({.w = 1.3, .mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"latch", {{"at", {0.5}}}});
    advance(world, 0.3, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 0.39, 1e-9) << row.name;
    advance(world, 0.3, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 0.5, 1e-6) << row.name;
    EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-9) << row.name;
    const Balance balance = world.balance();
    EXPECT_NEAR(balance.taken - balance.put_in, 0.5 * 0.5 * 1.3 * 1.3, 1e-9) << row.name << ": it takes what it stops";
    world.set_force(wheel, {0, 0, -20});
    advance(world, 0.5, 0.01);
    EXPECT_NEAR(world.pose(wheel).angle, 0.5, 1e-6) << row.name << ": it is closed for good";
  }
}

// A spring whose far end leaves at v pulls a pinned slider: the pin shears at F = k v t, and then, with y the stretch,
// y'' = -(k/m) y from y = F/k, y' = v.
TEST(EventEffects, AShearPinBreaksAtItsStrength) {
  constexpr double k = 40, m = 2, v = 0.5, strength = 9.03, breaks = strength / (k * v), after = 0.1;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const std::vector<NamedValue> rail_points = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}};
    const int slide = world.add_body({.mass = m, .inertia = 1});
    const int rail = world.add_joint({"prismatic", {slide, world.ground()}, rail_points, {}});
    const int puller = world.add_body({.vx = v, .mass = 1, .inertia = 1});
    const int drive = world.add_joint({"prismatic", {puller, world.ground()}, rail_points, {}});
    add_motor(world, drive, "slide", {.speed = v});
    add_effect(world, rail, "slide", SpecEffect{"shear_pin", {{"strength", {strength}}}});
    world.add_joint({"spring", {puller, slide}, {{"pa", {3, 0}}, {"pb", {0, 0}}, {"rest", {3}}, {"k", {k}}}, {}});
    advance(world, breaks + after, (breaks + after) / 100);
    const double W = std::sqrt(k / m), y = strength / k * std::cos(W * after) + v / W * std::sin(W * after);
    EXPECT_NEAR(v * (breaks + after) - world.pose(slide).x, y, allowed(row, 0.01, 1e-7)) << row.name;
  }
}

// A pin that is too weak for a weight breaks at the start, not at the end of a long adaptive step.
TEST(EventEffects, APinThatIsTooWeakBreaksAtOnce) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Settings settings = with(integrator, -10);
    settings.local_error = 1e-9;
    World<double> world(settings);
    const int weight = world.add_body({.mass = 2, .inertia = 1});
    const int rail =
        world.add_joint({"prismatic", {weight, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}}, {}});
    add_effect(world, rail, "slide", SpecEffect{"shear_pin", {{"strength", {19}}}});
    advance(world, 1, 0.25);
    EXPECT_NEAR(world.pose(weight).y, -5, 1e-8) << row_of(integrator).name;
  }
}

// A pendulum on a rope tears it where the tension m g (3 cos(angle) - 2 cos(start)) reaches the strength; then it flies
// with a constant speed across.
TEST(EventEffects, APendulumTearsItsRope) {
  constexpr double g = 9.81, m = 1.5, l = 0.8, start = 1.1, tears = 0.2;
  const double strength = m * g * (3 * std::cos(tears) - 2 * std::cos(start));
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -g));
    const int ball = world.add_body({.x = l * std::sin(start), .y = -l * std::cos(start), .mass = m, .inertia = 1});
    world.add_joint({"tearing_rope",
                     {ball, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {l}}, {"strength", {strength}}},
                     {}});
    const double h = 0.001;
    int steps = 0;
    while (std::hypot(world.pose(ball).x, world.pose(ball).y) < l + 1e-3 && ++steps < 2000) ASSERT_TRUE(world.step(h));
    ASSERT_LT(steps, 2000) << row.name << ": it does not tear";
    const double speed = std::sqrt(2 * g * l * (std::cos(tears) - std::cos(start)));
    EXPECT_NEAR(world.velocity(ball).x, -speed * std::cos(tears), allowed(row, 0.02, 1e-7)) << row.name;
    const double across = world.velocity(ball).x;
    advance(world, 0.1, h);
    EXPECT_NEAR(world.velocity(ball).x, across, 1e-12) << row.name;
  }
}

TEST(EventEffects, InSpaceARopeTearsAsInThePlane) {
  constexpr double g = 9.81, m = 1.5, l = 0.8, start = 1.1, tears = 0.2;
  const double strength = m * g * (3 * std::cos(tears) - 2 * std::cos(start));
  for (const IntegratorRow& row : integrator_rows) {
    SpatialWorld<double> world(with(row.integrator, -g));
    SpatialBodyDefinition d;
    d.x = l * std::sin(start), d.y = -l * std::cos(start), d.mass = m, d.inertia = {1, 1, 1};
    const int ball = world.add_body(d);
    world.add_joint({"tearing_rope",
                     {ball, world.ground()},
                     {{"pa", {0, 0, 0}}, {"pb", {0, 0, 0}}, {"l", {l}}, {"strength", {strength}}},
                     {}});
    for (int n = 0; n < 700; ++n) ASSERT_TRUE(world.step(0.001));
    const double speed = std::sqrt(2 * g * l * (std::cos(tears) - std::cos(start)));
    EXPECT_NEAR(world.velocity(ball).x, -speed * std::cos(tears), allowed(row, 0.02, 1e-7)) << row.name;
  }
}

// A body whose centre turns at 0.5 m with 2 rad/s stops at once: its axle gives 1 N s, in a step 100 N beside 2 N.
TEST(EventEffects, TheBlowOfALatchIsALoad) {
  for (const IntegratorRow& row : integrator_rows)
    for (const double strength : {90.0, 110.0}) {
      World<double> world(with(row.integrator));
      const int body = world.add_body({.x = 0.5, .vy = 1, .w = 2, .mass = 1, .inertia = 0.5});
      const int axle = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
      add_effect(world, axle, "angle", SpecEffect{"latch", {{"at", {0.3}}}});
      set_breaking_load(world, axle, strength);
      advance(world, 0.3, 0.01);
      EXPECT_EQ(world.broken(axle), strength < 100) << row.name << ", " << strength << " N";
    }
}

// The reaction of the step in which it closes has that impulse, 1 N s in 0.01 s, and some newtons of the motion.
TEST(EventEffects, TheBlowOfALatchIsAReaction) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int body = world.add_body({.x = 0.5, .vy = 1, .w = 2, .mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
    add_effect(world, axle, "angle", SpecEffect{"latch", {{"at", {0.3}}}});
    double most = 0;
    for (int k = 0; k < 30; ++k) {
      ASSERT_TRUE(world.step(0.01));
      const auto pull = world.reaction(axle, body);
      most = std::max(most, std::hypot(pull.force_x, pull.force_y));
    }
    fmt::print("  {}: {:.6g} N\n", row.name, most);
    EXPECT_NEAR(most, 100, 5) << row.name;
  }
}

// Past events are part of the State.
TEST(EventEffects, ASnapshotBeforeAnEventUndoesIt) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int wheel = world.add_body({.w = 1, .mass = 1, .inertia = 0.5});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"latch", {{"at", {0.25}}}});
    advance(world, 0.2, 0.01);
    const Snapshot before = world.snapshot();
    advance(world, 0.2, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 0, 1e-9) << row.name;
    const Snapshot closed = world.snapshot();
    world.restore(before);
    EXPECT_NEAR(world.velocity(wheel).w, 1, 1e-9) << row.name;
    advance(world, 0.03, 0.01);
    EXPECT_NEAR(world.velocity(wheel).w, 1, 1e-9) << row.name << ": the latch is open again";
    advance(world, 0.17, 0.01);
    EXPECT_EQ(world.snapshot(), closed) << row.name;
  }
}

// --- events within an adaptive step ---

// f(settings, name) for the methods whose error chooses the steps.
template <class F>
void each_adaptive(F f) {
  for (const IntegratorRow& row : integrator_rows) {
    if (row.level != Level::acceleration) continue;
    Settings settings = with(row.integrator);
    settings.local_error = 1e-9;
    f(settings, row.name);
  }
}

// x = v t - a t^2 / 2, which a step follows exactly, passes the end u at t1 = (v - sqrt(v^2 - 2 a u)) / a and comes
// back. The end stops it: x = u - a (t - t1)^2 / 2.
TEST(EventEffects, AWayThatTurnsBackWithinAStepMeetsItsEnd) {
  constexpr double v = 3, a = 2, end = 2.24, met = 1.4;
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int slide = world.add_body({.vx = v, .mass = 2, .inertia = 1});
    world.add_joint({"end_stops",
                     {slide, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"lower", {-9}}, {"upper", {end}}},
                     {}});
    world.set_force(slide, {-2 * a, 0, 0});
    ASSERT_TRUE(world.step(3)) << name;
    EXPECT_NEAR(world.pose(slide).x, end - a * (3 - met) * (3 - met) / 2, 1e-6) << name;
  });
}

// F = 84 - 192 t moves a block of 1 kg along x = 42 t^2 - 32 t^3 - 9 t, which has its largest value, 3.375, at t = 3/4:
// it turns twice within a step that begins and ends on the way back. The stop at 1 is met before t = 7/16, when F = 0;
// then x = 1 - 32 (t - 7/16)^3.
TEST(EventEffects, AWayThatTurnsTwiceWithinAStepMeetsItsEnd) {
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int block = world.add_body({.vx = -9, .mass = 1, .fixed_rotation = true});
    world.add_joint({"end_stops",
                     {block, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"lower", {-9}}, {"upper", {1}}},
                     {}});
    const Profile falls = Profile::table({.times = {0, 1}, .values = {84, -108}});
    world.add_joint({"push", {block}, {{"pa", {0, 0}}, in_time("F", {falls, 0.0})}, {}});
    ASSERT_TRUE(world.step(1)) << name;
    EXPECT_NEAR(world.pose(block).x, 1 - 32 * std::pow(9.0 / 16, 3), 1e-6) << name;
  });
}

// Friction of 1 N slows a block of 1 kg that F = 12 t - 4 pushes: v = 6 t^2 - 5 t + 1 until t = 1/3. There it sticks
// until F = 1, at t = 5/12, and slips on with v = 6 (t - 5/12)^2. A step over all of it follows the first v exactly.
TEST(EventEffects, ABlockThatComesToRestWithinAStepSticks) {
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int block = world.add_body({.vx = 1, .mass = 1, .fixed_rotation = true});
    const int rail = world.add_joint({.type = "line",
                                      .bodies = {block, world.ground()},
                                      .parameters = {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}},
                                      .soft = {}});
    add_effect(world, rail, "slide", DryFriction{.max_force = 1});
    const Profile rises = Profile::table({.times = {0, 1}, .values = {-4, 8}});
    world.add_joint({"push", {block}, {{"pa", {0, 0}}, in_time("F", {rises, 0.0})}, {}});
    ASSERT_TRUE(world.step(1)) << name;
    EXPECT_NEAR(world.pose(block).x, 7.0 / 54 + 2 * std::pow(7.0 / 12, 3), 1e-6) << name;
  });
}

// F = (4 t - 2)^2 - 1 presses a block of 1 kg against a stop until t = 1/4, draws it away, and after t = 3/4 presses
// again. At t = 1 the block turns back, at x = -9/64. Both ends of a step over all of it find the block pressed.
TEST(EventEffects, ABlockThatIsLetGoWithinAStepMoves) {
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int block = world.add_body({.mass = 1, .fixed_rotation = true});
    world.add_joint({"end_stops",
                     {block, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"lower", {-9}}, {"upper", {0}}},
                     {}});
    const Profile presses = Profile::function([](double t) -> ProfileValue {
      return {(4 * t - 2) * (4 * t - 2) - 1, 8 * (4 * t - 2), 32};
    });
    world.add_joint({"push", {block}, {{"pa", {0, 0}}, in_time("F", {presses, 0.0})}, {}});
    ASSERT_TRUE(world.step(1)) << name;
    EXPECT_NEAR(world.pose(block).x, -9.0 / 64, 1e-6) << name;
  });
}

// The way of the first with a switch at `end`, which takes the drive away for good.
TEST(EventEffects, AWayThatTurnsBackWithinAStepMeetsItsSwitch) {
  constexpr double w = 3, end = 2.24, met = 1.4, I = 0.5, drive = 4, brake = 5, left = 3 - met;
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int wheel = world.add_body({.w = w, .mass = 1, .inertia = I});
    const int axle = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_effect(world, axle, "angle", SpecEffect{"limit_switch", {{"speed", {100}}, {"max", {drive}}, {"end", {end}}}});
    world.set_force(wheel, {0, 0, -brake});
    ASSERT_TRUE(world.step(3)) << name;
    const double then = w - (brake - drive) / I * met;
    EXPECT_NEAR(world.pose(wheel).angle, end + then * left - brake / I * left * left / 2, 1e-6) << name;
  });
}

// A finger turns faster than the crank that carries it, and meets an end between two steps. There the joints are closed
// at the time of the end, not at that of the step before: in between the motor turns the crank on by 0.007 rad. The
// slope of a rod of 1 nm is so small that no residual counts as closed.
TEST(EventEffects, AnEndOnACrankIsMetAtItsTime) {
  constexpr double end = 0.507, h = 0.02;
  const std::vector<double> along_x = {1, 0, 0, 0, 1, 0}, centre = {0, 0, 0};
  each_adaptive([&](const Settings& settings, const auto& name) {
    SpatialWorld<double> world(settings);
    const auto turning = [&](double wx) {
      SpatialBodyDefinition d;
      d.wx = wx, d.mass = 0.1, d.inertia = {1e-6, 1e-6, 1e-6};
      return world.add_body(d);
    };
    const int crank = turning(1), finger = turning(2), ball = turning(1);
    const std::vector<NamedValue> axle = {{"pa", centre}, {"pb", centre}, {"fa", along_x}, {"fb", along_x}};
    std::vector<NamedValue> driven = axle;
    driven.push_back({"rate", {1}});
    world.add_joint({"driven", {world.ground(), crank}, driven, {}});
    const int pin = world.add_joint({"hinge", {crank, finger}, axle, {}});
    add_limit(world, pin, "angle", {.lower = {}, .upper = end});
    world.add_joint({"spherical_spherical", {crank, ball}, {{"pa", centre}, {"pb", {1e-9, 0, 0}}}, {}});
    while (world.time() < 1) {
      ASSERT_TRUE(world.step(h)) << name;
      EXPECT_NEAR(world.coordinate(pin, "angle"), std::min(world.time(), end), 1e-8) << name << " at " << world.time();
    }
  });
}

// A wheel turns back over narrow teeth, each of which takes W = 2 most / (1 - e) (sin(n f) / n - e f), e = cos(n f).
// Between the teeth nothing acts, so steps grow beyond them. No method locates the kink at a tooth's edge.
TEST(EventEffects, NoToothIsNarrowerThanAStep) {
  constexpr double n = 6, most = 20, f = 0.02, w = -4, I = 0.4;
  const double e = std::cos(n * f), W = 2 * most / (1 - e) * (std::sin(n * f) / n - e * f);
  each_adaptive([&](const Settings& settings, const auto& name) {
    World<double> world(settings);
    const int rotor = world.add_body({.angle = 0.3, .w = w, .mass = 1, .inertia = I});
    world.add_joint(
        {"ratchet", {rotor, world.ground()}, {{"count", {n}}, {"most", {most}}, {"rest", {0}}, {"flank", {f}}}, {}});
    while (world.pose(rotor).angle > -2.4) ASSERT_TRUE(world.step(0.02)) << name;  // over 3 teeth
    EXPECT_NEAR(world.velocity(rotor).w, -std::sqrt(w * w - 2 * 3 * W / I), 1e-4) << name;
  });
}

// A slider creeps into its latch more slowly than what counts as rest. It sleeps before the latch or in it, not beyond.
TEST(EventEffects, ALatchThatClosesKeepsItsBodyAwake) {
  constexpr double at = 0.3, v = 1e-3, h = 0.01;
  for (const IntegratorRow& row : integrator_rows)
    for (int steps = 3; steps < 9; ++steps) {
      Settings settings = with(row.integrator);
      settings.sleep_speed = 10 * v, settings.sleep_after = (steps - 0.5) * h;
      World<double> world(settings);
      const int slider = world.add_body({.x = -5.5 * v * h, .vx = v, .mass = 2, .inertia = 1});
      const int rail = world.add_joint(
          {"prismatic", {slider, world.ground()}, {{"pa", {0, 0}}, {"pb", {-at, 0}}, {"t", {0, 1}}}, {}});
      add_effect(world, rail, "slide", SpecEffect{"latch", {{"at", {at}}}});
      advance(world, 12 * h, h);
      const double x = world.pose(slider).x;
      EXPECT_LE(x, 1e-9) << row.name << ", asleep after " << steps << " steps";
      EXPECT_NEAR(x, steps < 6 ? (steps - 5.5) * v * h : 0, 1e-9) << row.name << ", asleep after " << steps << " steps";
    }
}

}  // namespace
}  // namespace cdot::test
