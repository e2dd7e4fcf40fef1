// One force along several rates, by specs that no catalogue has: a belt, a brake of three turns, friction from a time
// on.
#include <filesystem>
#include <fstream>

#include <cdot/integrators.hpp>

#include "runtime/own/own.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

using spatial::Vector;

std::string own_effect(const std::string& name, const std::string& statements) {
  const auto file = std::filesystem::temp_directory_path() / (name + ".effect");
  std::ofstream(file) << "effect " + name + " spatial\n  \"own\"\n" + statements;
  const OwnType own = add_own_type(file.string());
  EXPECT_EQ(own.problems, "");
  return own.name;
}

constexpr const char* plane =
    "  point pa on a = x(a)\n  point pb on b\n  frame f on b\n  scalar mu from 0\n  scalar speed [m/s]\n"
    "  coordinate gap [m] = dot(pa - pb, f.x)\n  coordinate y1 [m] = dot(pa - pb, f.y)\n"
    "  coordinate z1 [m] = dot(pa - pb, f.z)\n  contact: gap >= 0\n"
    "  grip: rate(y1) = speed, rate(z1) = 0, norm(force) <= mu*load(contact)";

struct OneBody {
  SpatialWorld<double> world;
  int body;

  OneBody(Integrator integrator, double gravity, Vector<double> v, Vector<double> w)
      : world(settings_of(integrator, gravity)) {
    SpatialBodyDefinition d;
    d.vx = v.x, d.vy = v.y, d.vz = v.z, d.wx = w.x, d.wy = w.y, d.wz = w.z;
    d.mass = 2, d.inertia = {0.5, 0.5, 0.5};
    body = world.add_body(d);
  }
  static Settings settings_of(Integrator integrator, double gravity) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator, s.gravity_z = -gravity;
    return s;
  }
  void take(int steps) {
    for (int n = 0; n < steps; ++n) ASSERT_TRUE(world.step(0.01));
  }
  Vector<double> velocity() const { return {world.velocity(body).x, world.velocity(body).y, world.velocity(body).z}; }
  Vector<double> spin() const { return {world.velocity(body).wx, world.velocity(body).wy, world.velocity(body).wz}; }
};

// A block comes onto a belt across it. Its velocity against the belt loses mu g t, in one direction, and then it
// rides.
TEST(OwnCones, ABeltTakesABlockAlong) {
  constexpr double mu = 0.25, g = 9.81, speed = 1.5;
  const std::string belt = own_effect("own_belt", plane);
  for (const IntegratorRow& row : integrator_rows) {
    const Vector<double> start = {0.4, 0.9, 0};
    OneBody run(row.integrator, g, start, {});
    run.world.add_joint({belt,
                         {run.body, run.world.ground()},
                         {{"pb", {0, 0, 0}}, {"f", {0, 0, 1, 1, 0, 0}}, {"mu", {mu}}, {"speed", {speed}}},
                         {}});
    const Vector<double> carried = {speed, 0, 0}, slip = start - carried;
    run.take(30);
    EXPECT_LT(norm(run.velocity() - carried - (1 - mu * g * 0.3 / norm(slip)) * slip), 1e-8) << row.name;
    run.take(50);
    EXPECT_LT(norm(run.velocity() - carried), 1e-8) << row.name;
  }
}

// It does nothing before that, be it the end of a step or a time within one.
TEST(OwnCones, FrictionBeginsAtATime) {
  constexpr double mu = 0.25, g = 9.81;
  const std::string late =
      own_effect("own_late_friction", "  scalar begin [s]\n" + std::string(plane) + ", after time >= begin");
  for (const IntegratorRow& row : integrator_rows)
    for (const double begin : {0.2, 0.2043}) {
      const Vector<double> start = {1, -2, 0};
      OneBody run(row.integrator, g, start, {});
      run.world.add_joint({late,
                           {run.body, run.world.ground()},
                           {{"pb", {0, 0, 0}}, {"f", {0, 0, 1}}, {"mu", {mu}}, {"speed", {0}}, {"begin", {begin}}},
                           {}});
      run.take(19);
      EXPECT_LT(norm(run.velocity() - start), 1e-9) << row.name;
      run.take(31);
      const double lost = mu * g * (0.5 - begin) / norm(start), by_step = mu * g * 0.011;  // others begin within a step
      EXPECT_LT(norm(run.velocity() - (1 - lost) * start), row.order > 2 ? 1e-7 : by_step) << row.name;
    }
}

// A torque of at most `most` in any direction: a ball of equal inertias keeps the axis of its spin.
TEST(OwnCones, ABrakeOfThreeTurnsKeepsTheAxis) {
  constexpr double most = 1.2, I = 0.5;
  const std::string brake =
      own_effect("own_ball_brake",
                 "  scalar most [N*m] above 0\n  coordinate tx [rad] = velocity dot(w(a) - w(b), world.x)\n"
                 "  coordinate ty [rad] = velocity dot(w(a) - w(b), world.y)\n"
                 "  coordinate tz [rad] = velocity dot(w(a) - w(b), world.z)\n"
                 "  hold: rate(tx) = 0, rate(ty) = 0, rate(tz) = 0, norm(force) <= most");
  for (const IntegratorRow& row : integrator_rows) {
    const Vector<double> spin = {1, -2, 2};
    OneBody run(row.integrator, 0, {}, spin);
    run.world.add_joint({brake, {run.body, run.world.ground()}, {{"most", {most}}}, {}});
    run.take(50);
    EXPECT_LT(norm(run.spin() - (1 - most / I * 0.5 / 3) * spin), 1e-8) << row.name;
    run.take(100);
    EXPECT_LT(norm(run.spin()), 1e-9) << row.name;
  }
}

// A ball whose radius grows, r = 1 + t, rolls on a plane: v = w r, m dv/dt = -I dw/dt / r, so that w^2 (m r^2 + I)
// stays.
TEST(OwnCones, ABallThatGrowsRollsMoreSlowly) {
  constexpr double m = 2, I = 0.5, w0 = 1.5;
  const std::string growing = own_effect(
      "own_growing_ball",
      "  point pa on a = x(a)\n  point pb on b\n  frame f on b\n  scalar radius [m] above 0\n  scalar mu from 0\n"
      "  coordinate gap [m] = dot(pa - pb, f.x) - radius\n"
      "  coordinate slip_y [m] = velocity dot(f.y, v(pa) - cross(w(a), radius*f.x))\n"
      "  coordinate slip_z [m] = velocity dot(f.z, v(pa) - cross(w(a), radius*f.x))\n  contact: gap >= 0\n"
      "  grip: rate(slip_y) = 0, rate(slip_z) = 0, norm(force) <= mu*load(contact)");
  const Profile grows = Profile::table({.times = {0, 1}, .values = {1, 2}, .interpolation = Interpolation::linear});
  for (const IntegratorRow& row : integrator_rows) {
    OneBody run(row.integrator, 9.81, {w0, 0, 1}, {0, w0, 0});
    run.world.add_joint({growing,
                         {run.body, run.world.ground()},
                         {{"pb", {0, 0, -1}}, {"f", {0, 0, 1, 1, 0, 0}}, in_time("radius", {grows}), {"mu", {5}}},
                         {}});
    run.take(100);
    const double w = w0 * std::sqrt((m + I) / (4 * m + I));
    EXPECT_NEAR(run.spin().y, w, row.order > 2 ? 1e-6 : 1e-2) << row.name;
  }
}

}  // namespace
}  // namespace cdot::test
