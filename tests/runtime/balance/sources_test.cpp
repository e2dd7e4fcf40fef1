// Work by who did it: closed forms, and the sum is that of the balance.
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "tests/runtime/balance/method.hpp"
#include "tests/runtime/sines.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

double allowed_of(const Method& method) { return method.order() == 1 ? 2e-2 : method.order() == 2 ? 2e-4 : 1e-6; }

template <class S>
double work_of(const BasicWorld<S>& world, std::string_view name) {
  for (const WorkOfSource& source : world.work_by_source())
    if (source.name == name) return source.work;
  return 0;
}

template <class S>
void expect_sum(const BasicWorld<S>& world, const std::string& what) {
  const Balance balance = world.balance();
  double sum = 0;
  for (const WorkOfSource& source : world.work_by_source()) sum += source.work;
  EXPECT_NEAR(sum, balance.put_in - balance.taken, 1e-11 * (1 + std::abs(balance.put_in) + balance.taken)) << what;
}

// A motor turns a wheel at w for a time t against friction M and drag c w^2: M w t and c w^3 t are taken, and the motor
// puts in as much.
TEST(WorkBySource, AMotorFeedsFrictionAndDrag) {
  constexpr double w = 3, M = 0.7, c = 0.05, I = 2, duration = 1;
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int wheel = world.add_body({.w = w, .mass = 1, .inertia = I});
    const int joint = revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    add_motor(world, joint, "angle", {.speed = w});
    add_friction(world, joint, "angle", {.max_force = M});
    world.add_joint({"rotational_drag", {wheel}, {{"c", {c}}}, {}});
    for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.step(duration / 1000)) << method.name();
    const double tolerance = allowed_of(method);
    EXPECT_NEAR(work_of(world, "friction"), -M * w * duration, tolerance) << method.name();
    EXPECT_NEAR(work_of(world, "rotational_drag"), -c * w * w * w * duration, tolerance) << method.name();
    EXPECT_NEAR(work_of(world, "motor"), (M + c * w * w) * w * duration, tolerance) << method.name();
    expect_sum(world, method.name());
  }
}

// A servo has no energy of its own: its work is what the wheel's motion gains, and all of it.
TEST(WorkBySource, AServoDoesWhatItsWheelGains) {
  constexpr double I = 2;
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int wheel = world.add_body({.w = 1, .mass = 1, .inertia = I});
    revolute(world, world.ground(), wheel, 0, 0, 0, 0);
    world.add_joint(
        {"servo", {wheel, world.ground()}, {{"target", {1.5}}, {"k", {9}}, {"d", {0.3}}, {"most", {5}}}, {}});
    for (int k = 0; k < 500; ++k) ASSERT_TRUE(world.step(1e-3)) << method.name();
    const double gained = I * (std::pow(world.velocity(wheel).w, 2) - 1) / 2;
    EXPECT_GT(gained, 1) << method.name();
    EXPECT_NEAR(work_of(world, "servo"), gained, allowed_of(method)) << method.name();
    EXPECT_LE(std::abs(world.balance().method()), allowed_of(method)) << method.name();
  }
}

// A spring with a damper between points, of which an energy stores the elastic part alone: the oscillation by the
// closed form u = u0 e^(-a t) (cos b t + a/b sin b t) loses its energy to the damper.
TEST(WorkBySource, ADamperTakesWhatItsSpringDoesNotStore) {
  constexpr double k = 9, d = 0.8, m = 2, u0 = 0.5, duration = 1;
  const double a = d / (2 * m), b = std::sqrt(k / m - a * a), decay = u0 * std::exp(-a * duration);
  const double u = decay * (std::cos(b * duration) + a / b * std::sin(b * duration)),
               v = -decay * k / (m * b) * std::sin(b * duration);
  const double lost = k / 2 * (u0 * u0 - u * u) - m / 2 * v * v;
  ASSERT_GT(lost, 0.1);
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int mass = world.add_body({.x = 1 + u0, .mass = m, .inertia = 1});
    world.add_joint({"spring",
                     {world.ground(), mass},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"k", {k}}, {"rest", {1}}, {"d", {d}}},
                     {}});
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(world.step(duration / 1000)) << method.name();
    EXPECT_NEAR(work_of(world, "spring"), -lost, allowed_of(method)) << method.name();
    EXPECT_LE(std::abs(world.balance().method()), allowed_of(method)) << method.name();
  }
}

// A crank, driven at w, takes a wheel along by a damper: wheel I u' = c (w - u). The drive puts in I w u, the damper
// takes I w^2 (1 - exp(-2 c t / I)) / 2. The drive's share in the kick of a damper is large, as the crank is light.
TEST(WorkBySource, ADriveFeedsADamper) {
  constexpr double w = 3, c = 0.8, I = 2, duration = 1;
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int crank = world.add_body({.w = w, .mass = 1, .inertia = 0.02});
    const int wheel = world.add_body({.mass = 1, .inertia = I});
    world.add_joint({"driven_crank", {world.ground(), crank}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"rate", {w}}}, {}});
    add_spring(world, revolute(world, crank, wheel, 0, 0, 0, 0), "angle",
               {.softness = {.by_frequency = false, .damping = c}});
    for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.step(duration / 1000)) << method.name();
    const double tolerance = allowed_of(method), u = w * (1 - std::exp(-c * duration / I));
    EXPECT_NEAR(work_of(world, "spring"), -I * w * w * (1 - std::exp(-2 * c * duration / I)) / 2, tolerance)
        << method.name();
    EXPECT_NEAR(work_of(world, "driven_crank"), I * w * u, tolerance) << method.name();
    EXPECT_LE(std::abs(world.balance().method()), tolerance) << method.name();
    expect_sum(world, method.name());
  }
}

// A joint in time that is a spring: its motor turns the rest pose, and its damper takes the rest of that work.
TEST(WorkBySource, ASoftDriveFeedsItsSpring) {
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int crank = world.add_body({.mass = 1, .inertia = 2});
    world.add_joint({"driven_crank",
                     {world.ground(), crank},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"rate", {1}}},
                     Softness{.by_frequency = false, .stiffness = 20, .damping = 1}});
    for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.step(1e-3)) << method.name();
    // e'' + (c/I) e' + (k/I) e = 0 of the lag e = w t - angle, e(0) = 0, e'(0) = w; the motor's torque is k e + c e'.
    constexpr double k = 20, c = 1, I = 2, w = 1, d = c / (2 * I);
    const double f = std::sqrt(k / I - d * d), rate = w / f * std::exp(-d) * (f * std::cos(f) - d * std::sin(f));
    const double put_in = w * I * (w - rate);  // the impulse of the torque is I times the speed
    EXPECT_NEAR(world.balance().put_in, put_in, allowed_of(method)) << method.name();
    EXPECT_LE(std::abs(world.balance().method()), allowed_of(method)) << method.name();
    expect_sum(world, method.name());
  }
}

// A disc of 2 kg falls 0.5 m onto a line, and hangs on a rope of 1 m after a fall of 1 m: m g h, by the one it meets.
TEST(WorkBySource, ImpactsAreThoseOfTheirEffects) {
  constexpr double m = 2, g = 10;
  for (const Method& method : methods()) {
    World<double> world(method.settings(-g));
    const int disc = world.add_body({.y = 0.6, .mass = m, .inertia = 1});
    world.add_joint({"disc_on_line",
                     {disc, world.ground()},
                     {{"pa", {0, 0}}, {"pb", {0, 0}}, {"n", {0, 1}}, {"radius", {0.1}}},
                     {}});
    const int ball = world.add_body({.x = 5, .mass = m, .inertia = 1});
    world.add_joint({"max_distance", {world.ground(), ball}, {{"pa", {5, 0}}, {"pb", {0, 0}}, {"l", {1}}}, {}});
    for (int k = 0; k < 1000; ++k) ASSERT_TRUE(world.step(1e-3)) << method.name();
    // The resolution of events, 3e-9 m, times m g; Euler, RATTLE and the midpoint rule meet ends by steps.
    const double tolerance = method.order() < 4 ? 0.2 : 1e-7;
    EXPECT_NEAR(work_of(world, "disc_on_line"), -m * g * 0.5, tolerance) << method.name();
    EXPECT_NEAR(work_of(world, "max_distance"), -m * g * 1, tolerance) << method.name();
    EXPECT_EQ(work_of(world, "limit"), 0) << method.name();
    expect_sum(world, method.name());
  }
}

// Each source of a mechanism with many of them, and the sum.
TEST(WorkBySource, TheSumIsThatOfTheBalance) {
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    const int rod_body =
        world.add_body({.x = 0.5, .vy = 0.5, .w = 1, .mass = 2, .inertia = 0.2, .angular_damping = 0.3});
    const int pin = revolute(world, world.ground(), rod_body, 0, 0, -0.5, 0);
    add_spring(world, pin, "angle", {.softness = {.by_frequency = true, .frequency = 1, .damping_ratio = 0.2}});
    add_limit(world, pin, "angle", {.lower = -0.4, .upper = 2});
    world.add_joint({"shaker", {rod_body}, {{"pa", {0, 0}}, {"amplitude", {2, 0}}, {"omega", {3}}}, {}});
    const int crank = world.add_body(rod(4, 0, 0));
    world.add_joint({"driven_crank", {world.ground(), crank}, {{"pa", {4, 0}}, {"pb", {-0.5, 0}}, {"rate", {1}}}, {}});
    for (int k = 0; k < 1000; ++k) {
      if (k == 500) world.set_velocity(rod_body, {0, 1, 2});
      ASSERT_TRUE(world.step(1e-3)) << method.name();
    }
    for (const char* name : {"changes from outside", "damping", "spring", "limit", "shaker", "driven_crank"})
      EXPECT_NE(work_of(world, name), 0) << method.name() << " " << name;
    for (const char* name : {"damping", "limit"}) EXPECT_LT(work_of(world, name), 0) << method.name() << " " << name;
    expect_sum(world, method.name());
  }
}

// A motor of unlimited force turns a rod of 1/3 kg m^2 at 2 rad/s against an end, off which gravity pulls it: the blow
// takes the energy of its turn, and nothing works while the motor presses.
TEST(WorkBySource, AMotorOfUnlimitedForceWorksAtAnEndByItsBlowAlone) {
  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5}) {
    Settings settings;
    settings.integrator = integrator, settings.gravity_y = -9.81;
    World<double> world(settings);
    const int body = world.add_body({.x = 0.5, .mass = 1, .inertia = 1. / 12});
    const int pin = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
    add_motor(world, pin, "angle", {.speed = 2});
    add_limit(world, pin, "angle", {.lower = -1, .upper = 1});
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(world.step(0.01));
    EXPECT_NEAR(world.coordinate(pin, "angle"), 1, 1e-8) << name_of(integrators, integrator);
    EXPECT_NEAR(work_of(world, "limit"), -2. / 3, 1e-6) << name_of(integrators, integrator);
    EXPECT_NEAR(work_of(world, "motor"), 2. / 3 + 9.81 * std::sin(1.) / 2, 1e-6) << name_of(integrators, integrator);
    EXPECT_EQ(world.step_counts().events, 1) << name_of(integrators, integrator);
    EXPECT_EQ(world.step_counts().rescued, 0) << name_of(integrators, integrator);
  }
}

// A snapshot and what follows it give the same accounts as the run that was not interrupted.
TEST(WorkBySource, SnapshotsKeepIt) {
  for (const Method& method : methods()) {
    World<double> world(method.settings(-9.81));
    const int body = world.add_body(rod(0, 0, 0));
    const int pin = revolute(world, world.ground(), body, 0, 0, -0.5, 0);
    add_motor(world, pin, "angle", {.speed = 2, .max_force = 3});
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01));
    const auto kept = world.snapshot();
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01));
    const double there = work_of(world, "motor");
    world.restore(kept);
    EXPECT_NE(work_of(world, "motor"), there) << method.name();
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01));
    EXPECT_EQ(work_of(world, "motor"), there) << method.name();
  }
}

// Friction only takes, whether its bounds follow time or not.
TEST(WorkBySource, ABrakeInTimeTakes) {
  for (const Method& method : methods()) {
    World<double> world(method.settings());
    const int body = world.add_body({.w = 5, .mass = 1, .inertia = 1});
    revolute(world, world.ground(), body, 0, 0, 0, 0);
    world.add_joint({"brake", {body, world.ground()}, {in_time("torque", {sine(2, 1, 3)})}, {}});
    for (int k = 0; k < 50; ++k) ASSERT_TRUE(world.step(0.01));
    EXPECT_EQ(world.balance().put_in, 0) << method.name();
    EXPECT_GT(world.balance().taken, 5) << method.name();
    expect_sum(world, method.name());
  }
}

// A torque in space has no potential.
TEST(WorkBySource, InSpaceATorqueIsOne) {
  for (const Method& method : methods()) {
    SpatialWorld<double> world([&] {
      Settings s = method.settings();
      s.gravity_z = 0;
      return s;
    }());
    const int body = world.add_body(brick(0, 0, 0));
    world.set_force(body, {.torque_z = 2});
    for (int k = 0; k < 100; ++k) ASSERT_TRUE(world.step(0.01)) << method.name();
    EXPECT_GT(work_of(world, "torque"), 0) << method.name();
    expect_sum(world, method.name());
  }
}

// Bodies of 87 and 191 t, which two gears and a wheel let turn together, and a body of 7 mg welded to the second one. A
// rope from the first to the light body gets taut in free flight. With the rate of its length v at that time, it takes
// v^2 / 2K with K of the heavy bodies. Beside a redundant gear, round-off leaves a part of that to the projection of
// the velocities.
TEST(WorkBySource, ABlowBesideARedundantGearIsBookedAsAWhole) {
  constexpr double m2 = 86518, m3 = 191157, I1 = 0.036, I2 = 131640, I3 = 187486, first = 2.1813, second = -2.0024;
  constexpr double w3 = -0.15223, w1 = -first * w3, w2 = -second * w1, length = 21.956;
  struct Flight {
    double x, y, angle, vx, vy, w, px, py;  // p: the end of the rope, in the body
    Flight after(double t) const { return {x + t * vx, y + t * vy, angle + t * w, vx, vy, w, px, py}; }
    double rx() const { return std::cos(angle) * px - std::sin(angle) * py; }
    double ry() const { return std::sin(angle) * px + std::cos(angle) * py; }
  };
  const Flight a{-11.501, -11.508, -0.6531, 5.2749, 7.3058, w2, -0.5487, 3.1961};
  Flight b{12.118, 9.5719, -0.6469, -4.613, -3.0576, w3, 0, 0};
  // The light body, at an angle to b, and where its parts are in b.
  constexpr double turned = -1.9626, qx = 3.3309, qy = 2.9295, ex = -24.7723, ey = -17.0952, fx = -3.7071, fy = 4.2624;
  const double c = std::cos(turned), s = std::sin(turned);
  const Flight light{b.x, b.y, b.angle, 0, 0, w3, qx - c * ex + s * ey, qy - s * ex - c * ey};
  b.px = light.px + c * fx - s * fy, b.py = light.py + s * fx + c * fy;

  double before = 0, until = 1.6;
  const auto span = [&](double t, double& nx, double& ny) {
    const Flight p = a.after(t), q = b.after(t);
    nx = p.x + p.rx() - q.x - q.rx(), ny = p.y + p.ry() - q.y - q.ry();
    return std::hypot(nx, ny);
  };
  double nx = 0, ny = 0;
  ASSERT_LT(span(0, nx, ny), length);
  ASSERT_GT(span(until, nx, ny), length);
  for (int k = 0; k < 60; ++k) (span((before + until) / 2, nx, ny) < length ? before : until) = (before + until) / 2;
  nx /= length, ny /= length;
  const Flight p = a.after(until), q = b.after(until);
  const double of_p = p.rx() * ny - p.ry() * nx, of_q = q.rx() * ny - q.ry() * nx;
  const double rate = nx * (a.vx - b.vx) + ny * (a.vy - b.vy) + w2 * of_p - w3 * of_q;
  const double turns = first * second * of_p - of_q, inertia = I3 + first * first * (I1 + second * second * I2);
  const double right = rate * rate / 2 / (1 / m2 + 1 / m3 + turns * turns / inertia);
  ASSERT_GT(right, 1e4);

  for (const Integrator integrator : {Integrator::rk4, Integrator::dop853}) {
    Settings settings;
    settings.integrator = integrator, settings.gravity_y = 0, settings.local_error = 1e-9;
    World<double> world(settings);
    const int wheel = world.add_body({.x = 13.8, .y = -4.4, .angle = 2.7, .w = w1, .mass = 0.0016, .inertia = I1});
    const auto body = [&](const Flight& of, double m, double I) {
      return world.add_body(
          {.x = of.x, .y = of.y, .angle = of.angle, .vx = of.vx, .vy = of.vy, .w = of.w, .mass = m, .inertia = I});
    };
    const int of_a = body(a, m2, I2), of_b = body(b, m3, I3);
    const Flight at{
        b.x + light.rx(), b.y + light.ry(), b.angle + turned, b.vx - w3 * light.ry(), b.vy + w3 * light.rx(), w3, 0, 0};
    const int of_light = body(at, 6.6e-6, 7.2e-5);
    world.add_joint({"gear", {wheel, of_b}, {{"ratio", {first}}}, {}});
    world.add_joint({"gear", {of_a, wheel}, {{"ratio", {second}}}, {}});
    world.add_joint({"weld", {of_b, of_light}, {{"pa", {qx, qy}}, {"pb", {ex, ey}}}, {}});
    world.add_joint({"rope", {of_a, of_light}, {{"pa", {a.px, a.py}}, {"pb", {fx, fy}}, {"l", {length}}}, {}});
    world.add_joint({"gear", {of_a, wheel}, {{"ratio", {second}}}, {}});
    for (int k = 0; k < 64; ++k) ASSERT_TRUE(world.step(1.6 / 64));
    fmt::print("  {}: {:.3f} of {:.3f} J\n", name_of(integrators, integrator), -work_of(world, "rope"), right);
    EXPECT_NEAR(work_of(world, "rope"), -right, 1e-5 * right) << name_of(integrators, integrator);
  }
}

}  // namespace
}  // namespace cdot::test
