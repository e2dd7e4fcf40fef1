// Effects with bounded rows: drives, brakes, clutches and stops; by closed forms with every integrator.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::ball;
using effects::expect_orders;
using effects::wheel;
using effects::with;

// A run of `duration` in steps of about h. How far a number is off at the end, with every integrator: by its method
// either a share of the step (events are met to first order), or the tolerance of those that locate events in time.
struct OffBy {
  double first_order, located;
};

template <class Error>
void expect_close(const char* what, double h, OffBy most, const Error& error_of) {
  for (const IntegratorRow& row : integrator_rows) {
    const double error = error_of(row.integrator, h);
    fmt::print("  {}, {}: off by {:.1e}\n", what, row.name, error);
    EXPECT_LT(error, row.order >= 4 ? most.located : most.first_order) << what << ", " << row.name;
  }
}

void go(World<double>& world, double duration, double h) {
  const long steps = std::lround(duration / h);
  for (long n = 0; n < steps; ++n) ASSERT_TRUE(world.step(duration / static_cast<double>(steps)));
}

// angle = speed (t - ramp (1 - exp(-t/ramp))): the torque suffices at every time.
double error_of_spindle(Integrator integrator, double h) {
  constexpr double speed = 5, ramp = 0.4, I = 0.3;
  World<double> world(with(integrator));
  const int rotor = wheel(world, I);
  world.add_joint({"spindle", {rotor, world.ground()}, {{"speed", {speed}}, {"ramp", {ramp}}, {"most", {100}}}, {}});
  go(world, 1, h);
  return std::abs(world.pose(rotor).angle - speed * (1 - ramp * (1 - std::exp(-1 / ramp))));
}

TEST(BoundedEffects, ASpindleFollowsItsRamp) { expect_orders("spindle", 0.02, 0.1, error_of_spindle); }

// With little torque: w = most t/I until that meets the ramp at t', found by bisection; then as the ramp.
double error_of_weak_spindle(Integrator integrator, double h) {
  constexpr double speed = 5, ramp = 0.4, I = 0.3, most = 2;
  const auto ramp_at = [](double t) { return speed * (1 - std::exp(-t / ramp)); };
  const auto angle_at = [](double t) { return speed * (t + ramp * std::exp(-t / ramp)); };
  double low = 0.1, high = 2;
  for (int k = 0; k < 100; ++k) {
    const double t = (low + high) / 2;
    (most / I * t < ramp_at(t) ? low : high) = t;
  }
  World<double> world(with(integrator));
  const int rotor = wheel(world, I);
  world.add_joint({"spindle", {rotor, world.ground()}, {{"speed", {speed}}, {"ramp", {ramp}}, {"most", {most}}}, {}});
  go(world, 2, h);
  EXPECT_NEAR(world.velocity(rotor).w, ramp_at(2), 1e-2);
  return std::abs(world.pose(rotor).angle - (most / I * low * low / 2 + angle_at(2) - angle_at(low)));
}

TEST(BoundedEffects, AWeakSpindleLagsBehindItsRamp) {
  expect_close("spindle", 0.005, {0.05, 1e-7}, error_of_weak_spindle);
}

// angle = I w^2/(2 torque), then it stands.
double error_of_braked_wheel(Integrator integrator, double h) {
  constexpr double torque = 0.7, I = 0.5, w = 2;
  World<double> world(with(integrator));
  const int rotor = wheel(world, I, 0, w);
  world.add_joint({"brake", {rotor, world.ground()}, {{"torque", {torque}}}, {}});
  go(world, 2, h);
  EXPECT_NEAR(world.velocity(rotor).w, 0, 1e-9);
  return std::abs(world.pose(rotor).angle - I * w * w / (2 * torque));
}

TEST(BoundedEffects, ABrakeStopsAWheel) { expect_close("brake", 0.01, {0.02, 1e-9}, error_of_braked_wheel); }

// Below its torque a brake holds; above, the wheel turns with what is left.
TEST(BoundedEffects, ABrakeHoldsUpToItsTorque) {
  for (const IntegratorRow& row : integrator_rows) {
    for (const double load : {0.6, 0.8}) {
      constexpr double torque = 0.7, I = 0.5;
      World<double> world(with(row.integrator));
      const int rotor = wheel(world, I);
      world.add_joint({"brake", {rotor, world.ground()}, {{"torque", {torque}}}, {}});
      world.set_force(rotor, {0, 0, load});
      go(world, 1, 0.01);
      EXPECT_NEAR(world.velocity(rotor).w, load < torque ? 0 : (load - torque) / I, 1e-9) << row.name << ", " << load;
    }
  }
}

// While it slips: w = w_0 - torque/I (t - rise (1 - exp(-t/rise))).
double error_of_air_brake(Integrator integrator, double h) {
  constexpr double torque = 0.7, rise = 0.3, I = 0.5, w = 2;
  World<double> world(with(integrator));
  const int rotor = wheel(world, I, 0, w);
  world.add_joint({"air_brake", {rotor, world.ground()}, {{"torque", {torque}}, {"rise", {rise}}}, {}});
  go(world, 1, h);
  return std::abs(world.velocity(rotor).w - (w - torque / I * (1 - rise * (1 - std::exp(-1 / rise)))));
}

TEST(BoundedEffects, AnAirBrakeBuildsUp) {
  expect_orders("air_brake", 0.02, 0.05, error_of_air_brake, {.floor = 1e-9, .by_kicks = 1});
}

// x = v/W sin(W t), W^2 = c/m, until it stands at v/W after a quarter period; there it stays.
double error_of_press_fit(Integrator integrator, double h) {
  constexpr double m = 2, c = 30, v = 1.5;
  World<double> world(with(integrator));
  const int pin = ball(world, 0, 0, v, 0, m);
  world.add_joint(
      {"press_fit", {pin, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"c", {c}}}, {}});
  go(world, 1, h);
  EXPECT_NEAR(world.velocity(pin).x, 0, 1e-9);
  return std::abs(world.pose(pin).x - v / std::sqrt(c / m));
}

TEST(BoundedEffects, APinStopsInItsSeat) { expect_close("press_fit", 0.005, {0.02, 1e-7}, error_of_press_fit); }

// A block put on a belt slides for t' = m v/most, then rides: x = v (t - t'/2).
double error_on_belt(Integrator integrator, double h) {
  constexpr double m = 2, v = 1.5, most = 4;
  World<double> world(with(integrator));
  const int block = ball(world, 0, 0, 0, 0, m);
  world.add_joint(
      {"conveyor", {block, world.ground()}, {{"pa", {0, 0}}, {"t", {0.6, 0.8}}, {"speed", {v}}, {"most", {most}}}, {}});
  go(world, 2, h);
  const double way = v * (2 - m * v / most / 2);
  return std::hypot(world.pose(block).x - 0.6 * way, world.pose(block).y - 0.8 * way);
}

TEST(BoundedEffects, ABlockRidesABelt) { expect_close("conveyor", 0.01, {0.02, 1e-9}, error_on_belt); }

// On an incline a block starts to slip above tan(angle) = mu.
TEST(BoundedEffects, ABlockSlipsAboveTheAngleOfFriction) {
  constexpr double mu = 0.4, m = 2, g = 9.81;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double off : {-0.01, 0.01}) {
      const double slope = std::atan(mu) + off, c = std::cos(slope), s = std::sin(slope);
      World<double> world(with(row.integrator, -g));
      const int block = ball(world, 0, 0, 0, 0, m);
      world.add_joint({"disc_on_line", {block, world.ground()}, {{"pb", {0, 0}}, {"n", {s, c}}}, {}});
      world.add_joint({"conveyor",
                       {block, world.ground()},
                       {{"pa", {0, 0}}, {"t", {c, -s}}, {"speed", {0}}, {"most", {mu * m * g * c}}},
                       {}});
      go(world, 1, 0.01);
      const double right = off < 0 ? 0 : g * (s - mu * c),
                   v = std::hypot(world.velocity(block).x, world.velocity(block).y);
      fmt::print("  {}: {:+.2f} rad from the angle of friction: {:.10f} m/s of {:.10f}\n", row.name, off, v, right);
      EXPECT_NEAR(v, right, 1e-9) << row.name;
    }
  }
}

// Stick and slip: the belt carries the block until the spring pulls with `most`, then the block swings about most/k
// with the amplitude v/W until it has the belt's speed again. One cycle, with what sticks, takes 2 pi/W.
double error_of_stick_slip(Integrator integrator, double h) {
  constexpr double m = 2, k = 50, v = 0.5, most = 6;
  World<double> world(with(integrator));
  const int block = ball(world, 0, 0, v, 0, m);
  world.add_joint(
      {"conveyor", {block, world.ground()}, {{"pa", {0, 0}}, {"t", {1, 0}}, {"speed", {v}}, {"most", {most}}}, {}});
  world.add_joint(
      {"spring", {block, world.ground()}, {{"pa", {0, 0}}, {"pb", {-3, 0}}, {"rest", {3}}, {"k", {k}}}, {}});
  const double slips = most / k / v, W = std::sqrt(k / m), end = 1.5;
  go(world, end, h);
  return std::abs(world.pose(block).x - (most / k + v / W * std::sin(W * (end - slips))));
}

TEST(BoundedEffects, ABlockOnASpringSticksAndSlips) {
  expect_close("conveyor", 0.002, {0.01, 1e-6}, error_of_stick_slip);
}

// Ahead, a is free; behind, the clutch drives it by its torque until both have the speed that momentum gives.
TEST(BoundedEffects, AFreewheelDrivesOneWay) {
  constexpr double I[2] = {0.5, 0.8}, most = 3;
  for (const IntegratorRow& row : integrator_rows) {
    for (const double ahead : {1.0, -1.0}) {
      World<double> world(with(row.integrator));
      const int a = wheel(world, I[0], 0, 2 + ahead), b = wheel(world, I[1], 0, 2);
      world.add_joint({"freewheel", {a, b}, {{"most", {most}}}, {}});
      go(world, 1, 0.01);
      const double common = (I[0] * (2 + ahead) + I[1] * 2) / (I[0] + I[1]);
      EXPECT_NEAR(world.velocity(a).w, ahead > 0 ? 2 + ahead : common, 1e-8) << row.name;
      EXPECT_NEAR(world.velocity(b).w, ahead > 0 ? 2 : common, 1e-8) << row.name;
    }
  }
}

// Falls back from between two teeth and stops on the flank where the pawl has taken what the load put in:
// load (start - s) = most/(1 - e) ((sin(n f) - sin(n s))/n - e (f - s)) of the flank from f to 0, e = cos(n f).
double error_of_ratchet(Integrator integrator, double h) {
  constexpr double n = 6, most = 20, f = 0.5 / n, start = 0.3, load = 2, I = 0.4;
  const double e = std::cos(n * f);
  double low = 0, high = f;
  for (int k = 0; k < 60; ++k) {
    const double s = (low + high) / 2, taken = most / (1 - e) * ((std::sin(n * f) - std::sin(n * s)) / n - e * (f - s));
    (taken > load * (start - s) ? low : high) = s;
  }
  World<double> world(with(integrator));
  const int rotor = wheel(world, I, start);
  world.add_joint({"ratchet", {rotor, world.ground()}, {{"count", {n}}, {"most", {most}}, {"rest", {0}}}, {}});
  world.set_force(rotor, {0, 0, -load});
  go(world, 1, h);
  EXPECT_NEAR(world.velocity(rotor).w, 0, 1e-9);  // held, against the load
  return std::abs(world.pose(rotor).angle - low);
}

// The flank begins with a kink of the bound, which no method locates.
TEST(BoundedEffects, ARatchetStopsAtItsTooth) {
  expect_close("ratchet", 0.002, {0.01, 1e-5}, error_of_ratchet);
  EXPECT_LT(error_of_ratchet(Integrator::rattle, 0.004), 1e-4);  // the load does not turn it on
}

// Ahead, no tooth takes anything: angle = torque t^2/(2 I), over several teeth.
TEST(BoundedEffects, ARatchetTurnsAheadFreely) {
  constexpr double torque = 2, I = 0.4;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int rotor = wheel(world, I);
    world.add_joint({"ratchet", {rotor, world.ground()}, {{"count", {6}}, {"most", {20}}}, {}});
    world.set_force(rotor, {0, 0, torque});
    go(world, 2, 0.01);
    EXPECT_NEAR(world.velocity(rotor).w, torque / I * 2, 1e-9) << row.name;
  }
}

// Two wheels with play meet at play/2 and go on together, without a bounce.
TEST(BoundedEffects, BacklashJoinsTwoWheelsAtItsEnds) {
  constexpr double I[2] = {0.5, 0.8}, play = 0.3;
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int a = wheel(world, I[0], 0, 2), b = wheel(world, I[1]);
    world.add_joint({"backlash", {a, b}, {{"play", {play}}}, {}});
    go(world, 0.05, 0.005);
    EXPECT_NEAR(world.velocity(b).w, 0, 1e-12) << row.name;
    go(world, 1, 0.005);
    const double common = I[0] * 2 / (I[0] + I[1]);
    EXPECT_NEAR(world.velocity(a).w, common, 2e-3) << row.name;
    EXPECT_NEAR(world.velocity(b).w, common, 2e-3) << row.name;
    EXPECT_NEAR(world.pose(a).angle - world.pose(b).angle, play / 2, 1e-4) << row.name;
  }
}

TEST(BoundedEffects, EndStopsStopBothWays) {
  for (const IntegratorRow& row : integrator_rows) {
    for (const double v : {3.0, -3.0}) {
      World<double> world(with(row.integrator));
      const int slide = ball(world, 0, 0, v, 0.4, 2);
      world.add_joint({"end_stops",
                       {slide, world.ground()},
                       {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"lower", {-0.5}}, {"upper", {0.7}}},
                       {}});
      go(world, 1, 0.01);
      EXPECT_NEAR(world.pose(slide).x, v > 0 ? 0.7 : -0.5, 1e-4) << row.name;
      EXPECT_NEAR(world.pose(slide).y, 0.4, 1e-9) << row.name;  // free across
    }
  }
}

TEST(BoundedEffects, ADiscFallsOntoALineAndRollsNoFurther) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator, -9.81));
    const int disc = ball(world, 0.2, 1, 0.7, 0, 2);
    world.add_joint({"disc_on_line", {disc, world.ground()}, {{"pb", {0, 0}}, {"n", {0, 1}}, {"radius", {0.25}}}, {}});
    go(world, 0.3, 0.01);
    EXPECT_NEAR(world.pose(disc).y, 1 - 9.81 * 0.09 / 2, 0.02) << row.name;  // still in the air
    go(world, 0.7, 0.01);
    EXPECT_NEAR(world.pose(disc).y, 0.25, 1e-4) << row.name;
    EXPECT_NEAR(world.pose(disc).x, 0.9, 1e-9) << row.name;
  }
}

// Small swings in a notch: I w^2 = count most.
double error_of_detent(Integrator integrator, double h) {
  constexpr double I = 0.5, count = 12, most = 0.6, start = 1e-6;
  World<double> world(with(integrator));
  const int knob = wheel(world, I, start);
  world.add_joint({"detent", {knob, world.ground()}, {{"count", {count}}, {"most", {most}}, {"rest", {0}}}, {}});
  go(world, 1, h);
  return std::abs(world.pose(knob).angle - start * std::cos(std::sqrt(count * most / I))) / start;
}

TEST(BoundedEffects, AKnobSwingsInItsNotch) { expect_orders("detent", 0.01, 0.2, error_of_detent, {.floor = 1e-8}); }

// Beyond most/k from its target the torque is `most`; from there the turn swings as on a spring.
double error_of_drive(Integrator integrator, double h) {
  constexpr double I = 0.5, k = 5, most = 2, start = 1, band = most / k, a = most / I;
  World<double> world(with(integrator));
  const int rotor = wheel(world, I, -start);
  world.add_joint({"position_drive", {rotor, world.ground()}, {{"target", {0}}, {"k", {k}}, {"most", {most}}}, {}});
  const double W = std::sqrt(k / I), meets = std::sqrt(2 * (start - band) / a), end = meets + 0.2;
  const long steps = std::lround(end / h);
  for (long n = 0; n < steps; ++n) EXPECT_TRUE(world.step(end / static_cast<double>(steps)));
  const double right = -band * std::cos(W * 0.2) + a * meets / W * std::sin(W * 0.2);
  return std::abs(world.pose(rotor).angle - right);
}

TEST(BoundedEffects, ADriveKeepsItsLimit) { expect_close("position_drive", 0.005, {0.02, 1e-5}, error_of_drive); }

// Euler's step is implicit up to the limit: it ends at the target, however stiff the drive.
TEST(BoundedEffects, ADriveArrivesAtAnyStiffness) {
  for (const double k : {1e3, 1e6, 1e9, 1e12}) {
    World<double> world(with(Integrator::euler));
    const int rotor = wheel(world, 0.5, -1);
    world.add_joint({"position_drive",
                     {rotor, world.ground()},
                     {{"target", {0}}, {"k", {k}}, {"d", {0.1 * k}}, {"most", {2}}},
                     {}});
    double fastest = 0;
    for (int n = 0; n < 300; ++n) {
      ASSERT_TRUE(world.step(1.0 / 60));
      fastest = std::max(fastest, std::abs(world.velocity(rotor).w));
    }
    EXPECT_NEAR(world.pose(rotor).angle, 0, 1e-9) << k;
    EXPECT_LT(fastest, std::sqrt(2 * 2 / 0.5)) << k;  // sqrt(2 a) over the whole way
  }
}

TEST(BoundedEffects, ALowerEndAboveTheUpperOneIsRefused) {
  World<double> world(with(Integrator::euler));
  const int slide = ball(world, 0, 0);
  const JointDefinition stops{"end_stops",
                              {slide, world.ground()},
                              {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {1, 0}}, {"lower", {0.5}}, {"upper", {-0.5}}},
                              {}};
  EXPECT_THROW(world.add_joint(stops), Error);
  JointDefinition right = stops;
  right.parameters[3] = {"lower", {-0.7}};
  const int joint = world.add_joint(right);
  EXPECT_THROW(world.set_parameters(joint, {{"lower", {2}}}), Error);
  world.set_parameters(joint, {{"upper", {0.1}}});
  world.set_velocity(slide, {5, 0, 0});
  go(world, 1, 0.01);
  EXPECT_NEAR(world.pose(slide).x, 0.1, 1e-4);
}

// In space: a ball falls onto a plane, a belt of 45 degrees carries it on, and a brake stops a wheel.
TEST(BoundedEffects, InSpaceTheyAreTheSame) {
  for (const IntegratorRow& row : integrator_rows) {
    Settings settings = with(row.integrator);
    settings.gravity_z = -9.81;
    SpatialWorld<double> world(settings);
    const int ground = world.ground();
    SpatialBodyDefinition d;
    d.z = 1, d.mass = 2, d.inertia = {1, 1, 1};
    const int ball = world.add_body(d);
    const double c = std::sqrt(0.5);
    world.add_joint({"ball_on_plane", {ball, ground}, {{"pb", {0, 0, 0}}, {"n", {0, 0, 1}}, {"radius", {0.25}}}, {}});
    world.add_joint(
        {"conveyor", {ball, ground}, {{"pa", {0, 0, 0}}, {"t", {c, c, 0}}, {"speed", {1.5}}, {"most", {4}}}, {}});
    SpatialBodyDefinition of_wheel;
    of_wheel.x = 3, of_wheel.wx = 2, of_wheel.mass = 1, of_wheel.inertia = {0.5, 0.5, 0.5};
    const int wheel = world.add_body(of_wheel);
    world.add_joint({"hinge", {ground, wheel}, {{"pa", {3, 0, 0}}, {"pb", {0, 0, 0}}, {"fa", {1, 0, 0}}}, {}});
    world.add_joint({"brake", {ground, wheel}, {{"fa", {1, 0, 0}}, {"torque", {0.7}}}, {}});
    for (int n = 0; n < 400; ++n) ASSERT_TRUE(world.step(0.005));
    const double way = 1.5 * (2 - 2 * 1.5 / 4 / 2);
    EXPECT_NEAR(world.pose(ball).z, 0.25, 1e-4) << row.name;
    EXPECT_NEAR(world.pose(ball).x, c * way, 0.01) << row.name;
    EXPECT_NEAR(world.pose(ball).y, c * way, 0.01) << row.name;
    EXPECT_NEAR(world.velocity(wheel).wx, 0, 1e-9) << row.name;
    // angle = I w^2/(2 torque): its half is that of the Euler parameters
    EXPECT_NEAR(2 * std::atan2(world.pose(wheel).e1, world.pose(wheel).e0), 0.5 * 4 / (2 * 0.7), 0.02) << row.name;
  }
}

// What each effect puts in and takes adds up to the change of the energy.
TEST(BoundedEffects, TheBalanceNamesThem) {
  for (const IntegratorRow& row : integrator_rows) {
    World<double> world(with(row.integrator));
    const int a = wheel(world, 0.5), b = wheel(world, 0.8);
    world.add_joint({"spindle", {a, world.ground()}, {{"speed", {5}}, {"ramp", {0.1}}, {"most", {1}}}, {}});
    world.add_joint({"brake", {b, a}, {{"torque", {0.4}}}, {}});
    const double share = effects::unaccounted(world, 1, 0.005);
    double spindle = 0, brake = 0;
    for (const auto& [source, work] : world.work_by_source()) {
      if (source == "spindle") spindle = work;
      if (source == "brake") brake = work;
    }
    const double wa = world.velocity(a).w, wb = world.velocity(b).w, energy = 0.25 * wa * wa + 0.4 * wb * wb;
    fmt::print("  {}: spindle {:.4f} J, brake {:.4f} J, energy {:.4f} J; unaccounted {:.1e}\n", row.name, spindle,
               brake, energy, share);
    EXPECT_GT(spindle, 0) << row.name;
    EXPECT_LT(brake, 0) << row.name;
    EXPECT_NEAR(spindle + brake, energy, (row.order == 1 ? 0.05 : 1e-3) * energy) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test
