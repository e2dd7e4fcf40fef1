// Bodies in space without joints: rotation, turning inertia tensors, conservation laws.
#include <fmt/core.h>

#include <cdot/methods.hpp>
#include <cdot/rotation.hpp>

#include "runtime/state/world_data.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

using spatial::Symmetric;
using spatial::Vector;

// Tumbles about its intermediate axis, the most sensitive motion.
SpatialBodyDefinition tumbling() {
  SpatialBodyDefinition d;
  d.mass = 2;
  d.inertia = {1, 2, 2.5};
  d.wx = 0.05, d.wy = 2, d.wz = 0.05;
  return d;
}

TEST(Rotation, ByAVectorIsTheExponential) {
  const auto q = spatial::oriented(0.0, 0.0, 0.0, 0.3, -0.5, 0.4, 0.7);
  for (double angle : {1e-12, 1e-5, 0.3, 3.0, 100.0, 1e4}) {
    const Vector<double> axis = {2.0 / 7, -3.0 / 7, 6.0 / 7};
    const auto turned = spatial::turned_by(q, angle * axis);
    const Vector<double> v = {0.2, -1.1, 0.7}, before = to_world(q, v);
    // Rodrigues
    const double c = std::cos(angle), s = std::sin(angle);
    const Vector<double> expected = c * before + s * cross(axis, before) + (1 - c) * dot(axis, before) * axis;
    EXPECT_LT(norm(to_world(turned, v) - expected), 1e-15 * (10 + angle)) << angle;
  }
  EXPECT_EQ(spatial::turned_by(q, {0, 0, 0}).e1, q.e1);
}

TEST(Rotation, TurnBetweenTakesOnePoseToTheOther) {
  const auto from = spatial::oriented(0.0, 0.0, 0.0, 0.3, -0.5, 0.4, 0.7);
  for (double angle : {0.0, 1e-9, 0.5, 3.1}) {
    const Vector<double> turn = angle * Vector<double>{-2.0 / 3, 1.0 / 3, 2.0 / 3};
    const auto found = spatial::turn_between(from, spatial::turned_by(from, turn));
    EXPECT_LT(norm(found - turn), 1e-14) << angle;
  }
}

TEST(Rotation, PositivePartDropsNegativeEigenvalues) {
  const auto q = spatial::oriented(0.0, 0.0, 0.0, 0.3, -0.5, 0.4, 0.7);
  const Symmetric<double> S = turned(q, Symmetric<double>{3, -2, 0.5, 0, 0, 0});
  const Symmetric<double> expected = turned(q, Symmetric<double>{3, 0, 0.5, 0, 0, 0});
  const Symmetric<double> off = spatial::positive_part(S) + (-1.0) * expected;
  for (double entry : {off.xx, off.yy, off.zz, off.xy, off.xz, off.yz}) EXPECT_NEAR(entry, 0, 1e-14);
}

TEST(SpatialBody, KeepsMomentumEnergyAndTheUnitQuaternion) {
  for (double h : {0.05, 0.01, 0.001}) {
    SpatialWorld<double> world;
    const int body = world.add_body(tumbling());
    const SpatialMomentum before = momentum(world);
    const double energy = world.energy();
    for (int i = 0; i < 5000; ++i) world.step(h);
    const SpatialMomentum after = momentum(world);
    EXPECT_LT(norm(after.angular - before.angular), 1e-13) << "h = " << h;
    EXPECT_NEAR(world.energy(), energy, 1e-10) << "h = " << h;
    EXPECT_NEAR(off_unit(world.pose(body)), 0, 1e-15);
  }
}

// A rod with a hundred times more inertia across than along: Newton finds the mean spin here too.
TEST(SpatialBody, ThinBodiesKeepEnergyInStepsOfAThirdOfARadian) {
  double worst = 0;
  for (double along : {0.1, 1.0, 3.0}) {
    SpatialWorld<double> world;
    SpatialBodyDefinition d;
    d.mass = 1;
    d.inertia = {0.01, 1, 0.995};
    d.wx = along, d.wy = 2, d.wz = -1.5;
    world.add_body(d);
    const double energy = world.energy();
    for (int i = 0; i < 1000; ++i) {
      world.step(0.1);
      worst = std::max(worst, std::abs(world.energy() - energy));
    }
  }
  fmt::print("  energy off by {:.1e} J\n", worst);
  EXPECT_LT(worst, 1e-10);
}

// The same with large steps, at which Newton fails: the momentum is conserved, and the energy stays between L^2 / (2 I)
// of the outer axes.
TEST(SpatialBody, LargeStepsKeepTheMomentum) {
  SpatialWorld<double> world;
  SpatialBodyDefinition d = tumbling();
  d.wx = 30, d.wy = -50, d.wz = 40;
  world.add_body(d);
  const Vector<double> L = momentum(world).angular;
  for (int i = 0; i < 2000; ++i) {
    world.step(0.1);
    ASSERT_LT(norm(momentum(world).angular - L), 1e-9 * norm(L));
    ASSERT_GT(world.energy(), 0.999 * dot(L, L) / (2 * 2.5));
    ASSERT_LT(world.energy(), 1.001 * dot(L, L) / (2 * 1.0));
  }
}

// 10,000 rad/s about a principal axis, hundreds of radians per step: the angle is exact.
TEST(SpatialBody, FastSpinAboutAPrincipalAxisIsExact) {
  SpatialWorld<double> world;
  SpatialBodyDefinition d = tumbling();
  d.wx = d.wy = 0, d.wz = 1e4;
  const int body = world.add_body(d);
  run(world, 1, 1.0 / 60);
  const auto q = world.pose(body);
  EXPECT_NEAR(q.xx, std::cos(1e4), 1e-10);
  EXPECT_NEAR(q.yx, std::sin(1e4), 1e-10);
  EXPECT_NEAR(world.velocity(body).wz, 1e4, 1e-9);
  EXPECT_EQ(world.velocity(body).wx, 0);
}

// The angle error of a symmetric top after 5 s in steps of h. It precesses about L at the rate L / I_across with
// I_across = 1 kg m^2, and rotates about its axis e at 2 - 1.5 * 2 = -1 rad/s. e lies in the frame's y-z plane.
double top_off(const Vector<double>& e, double h) {
  SpatialWorld<double> world;
  SpatialBodyDefinition d;
  d.mass = 1;
  d.inertia = {1, 1 + 0.5 * e.y * e.y, 1 + 0.5 * e.z * e.z, 0, 0, 0.5 * e.y * e.z};
  d.wx = 1, d.wy = 2 * e.y, d.wz = 2 * e.z;
  const int body = world.add_body(d);
  const Vector<double> L = momentum(world).angular;
  run(world, 5, h);
  const auto start = spatial::oriented(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
  return norm(turn_between(spatial::turned_by(spatial::turned_by(start, -5.0 * e), 5.0 * L), world.pose(body)));
}

// With symmetry about a frame axis the rotation is in closed form for every step length.
TEST(SpatialBody, SymmetricTopPrecesses) {
  for (double h : {0.005, 0.02, 0.1, 1.0, 2.5})
    for (const Vector<double>& e : {Vector<double>{0, 0, 1}, Vector<double>{0, 1, 0}})
      EXPECT_LT(top_off(e, h), 2e-12) << "h = " << h;
}

// The same body with an oblique axis: second order in the step.
TEST(SpatialBody, TurnsOfSecondOrder) {
  const Vector<double> e = {0, 0.6, 0.8};
  double before = top_off(e, 0.02);
  for (double h : {0.01, 0.005}) {
    const double off = top_off(e, h);
    EXPECT_NEAR(before / off, 4, 0.1) << "h = " << h;
    before = off;
  }
}

// An inertia tensor that is not diagonal is the same body in another frame.
TEST(SpatialBody, TensorInAnotherFrame) {
  SpatialWorld<double> principal, general;
  SpatialBodyDefinition d = tumbling();
  const int a = principal.add_body(d);
  const auto q = spatial::oriented(0.0, 0.0, 0.0, 0.3, -0.5, 0.4, 0.7);
  // Body frame = the principal frame rotated by q^-1, so the tensor is rotated by A(q).
  const auto I = turned(q, Symmetric<double>{1, 2, 2.5, 0, 0, 0});
  d.inertia = {I.xx, I.yy, I.zz, I.xy, I.xz, I.yz};
  d.e0 = q.e0, d.e1 = -q.e1, d.e2 = -q.e2, d.e3 = -q.e3;
  const int b = general.add_body(d);
  run(principal, 3, 0.01);
  run(general, 3, 0.01);
  const auto v = principal.velocity(a), w = general.velocity(b);
  EXPECT_NEAR(v.wx, w.wx, 1e-12);
  EXPECT_NEAR(v.wy, w.wy, 1e-12);
  EXPECT_NEAR(v.wz, w.wz, 1e-12);
}

// A ball, a body with fixed rotation and a static body have no turning tensor and no Gyroscope.
TEST(SpatialBody, OnlyUnequalInertiasAreTurned) {
  SpatialWorld<double> world;
  SpatialBodyDefinition d = tumbling();
  d.inertia = {2, 2, 2};
  world.add_body(d);
  d = tumbling();
  d.fixed_rotation = true;
  d.wx = d.wy = d.wz = 0;
  world.add_body(d);
  world.ground();
  EXPECT_TRUE(world.data().gyroscopes.empty());
  world.add_body(tumbling());
  EXPECT_EQ(world.data().gyroscopes.size(), 1u);
}

// Angular momentum = torque times time in world axes, for every motion of the tensor.
TEST(SpatialBody, ConstantTorqueTurnsWithTheTensor) {
  for (const auto& [name, integrator] : integrators) {
    Settings settings;
    settings.integrator = integrator;
    SpatialWorld<double> world(settings);
    SpatialBodyDefinition d = tumbling();
    d.torque_x = 0.3, d.torque_z = -0.2;
    world.add_body(d);
    const Vector<double> before = momentum(world).angular;
    run(world, 2, 0.01);
    const double off = norm(momentum(world).angular - before - Vector<double>{0.6, 0, -0.4});
    fmt::print("  {}: L off by {:.1e} N m s\n", name, off);
    EXPECT_LT(off, integrator == Integrator::rk4 ? 1e-8 : 1e-11) << name;
  }
}

TEST(SpatialBody, FallsAndIsDamped) {
  Settings s;
  s.gravity_z = -10;
  SpatialWorld<double> world(s);
  SpatialBodyDefinition d = tumbling();
  d.linear_damping = 2;
  const int body = world.add_body(d);
  run(world, 20, 0.01);
  // Terminal velocity: v = v / (1 + 2 h) - 10 h
  EXPECT_NEAR(world.velocity(body).z, -5 * (1 + 2 * 0.01), 1e-9);
}

// Two bodies on a spring: momentum to round-off, energy to first order.
TEST(SpatialBody, SpringsBetweenPointsKeepMomentum) {
  double before = 0;
  for (double h : {2e-3, 1e-3}) {
    SpatialWorld<double> world;
    SpatialBodyDefinition d = tumbling();
    const int a = world.add_body(d);
    d.x = 2, d.wy = -1, d.vz = 0.3;
    const int b = world.add_body(d);
    SpringDefinition spring;
    spring.body_a = a, spring.body_b = b;
    spring.ay = 0.5, spring.bz = -0.4;
    spring.stiffness = 20, spring.rest_length = 1;
    world.add_spring(spring);
    const SpatialMomentum start = momentum(world);
    const double energy = world.energy();
    double worst = 0;
    for (int i = 0; i < std::lround(5 / h); ++i) {
      world.step(h);
      worst = std::max(worst, std::abs(world.energy() - energy));
    }
    EXPECT_LT(norm(momentum(world).linear - start.linear), 1e-12);
    EXPECT_LT(norm(momentum(world).angular - start.angular), 1e-11);
    if (before > 0) {
      EXPECT_NEAR(before / worst, 2, 0.3);
    }
    before = worst;
  }
}

TEST(SpatialBody, EqualBitsOnRepetition) {
  const auto hash = [] {
    SpatialWorld<double> world;
    world.add_body(tumbling());
    run(world, 3, 0.01);
    return world.hash();
  };
  EXPECT_EQ(hash(), hash());
}

TEST(SpatialBody, RefusesImpossibleBodies) {
  SpatialWorld<double> world;
  const auto refused = [&](auto change) {
    SpatialBodyDefinition d = tumbling();
    change(d);
    EXPECT_THROW(world.add_body(d), Error);
  };
  refused([](auto& d) { d.inertia = {1, 2, 4}; });               // more than the sum of the others
  refused([](auto& d) { d.inertia = {1, 1, 1, 0.9, 0, 0.9}; });  // not positive
  refused([](auto& d) { d.inertia.xy = NAN; });
  refused([](auto& d) { d.e0 = 0; });
  refused([](auto& d) { d.mass = 0; });
  refused([](auto& d) { d.is_static = true; });  // but with a velocity
}

TEST(SpatialBody, InFloats) {
  SpatialWorld<float> world;
  const int body = world.add_body(tumbling());
  const Vector<double> L = momentum(world).angular;
  run(world, 20, 0.01);
  EXPECT_LT(norm(momentum(world).angular - L), 1e-3 * norm(L));
  EXPECT_NEAR(off_unit(world.pose(body)), 0, 1e-6);
}

}  // namespace
}  // namespace cdot::test
