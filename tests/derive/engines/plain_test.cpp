// Emitted joints without an engine, in the loop of the contract: closed forms, and the kernels of generated/ bit by
// bit.
#include <array>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

#include "plain/gear.hpp"
#include "plain/gear_on_base.hpp"
#include "plain/hinge.hpp"
#include "plain/revolute.hpp"
#include "plain/rope.hpp"
#include "tests/derive/engines/bevel_gear.hpp"
#include "tests/derive/engines/generated_hinge.hpp"

namespace {

namespace plain = cdot::plain;
namespace planar = cdot::planar;
namespace spatial = cdot::spatial;

constexpr double pi = 3.14159265358979323846;

// A joint between the world and one body, in the order of calls that the contract asks for.
template <class Joint, class Pose, class Mass, class Velocity, class T>
void step(Joint& joint, Pose (&q)[2], const Mass (&m)[2], Velocity (&v)[2], T time, T h) {
  joint.prepare(q, m, time, h);
  joint.warm_start(m, v);
  for (int sweep = 0; sweep < 8; ++sweep) joint.solve(m, v);
  plain::move(q[1], v[1], h);
  joint.project(q, m, time + h);
}

struct Pendulum {
  plain::revolute_joint<double> pin;
  planar::Pose<double> q[2] = {plain::pose(0.0, 0.0, 0.0), plain::pose(0.0, -1.0, 0.0)};
  planar::InverseMass<double> m[2] = {{0, 0}, {0.5, 4}};  // 2 kg, 0.25 kg m^2
  planar::Velocity<double> v[2] = {};

  Pendulum() {
    pin.stiffness.error_reduction = 0;
    pin.by_default(planar::revolute::index_of_pb, q, 0);
  }
  void run(double seconds, double g, double h = 1e-3) {
    for (int n = 0; n < int(seconds / h + 0.5); ++n) {
      v[1].y -= h * g;
      step(pin, q, m, v, n * h, h);
    }
  }
};

// T = 2 pi sqrt(I / (m g l)) with I about the pin, at small angles.
TEST(PlainJoints, APendulumHasItsPeriod) {
  Pendulum p;
  p.v[1] = {0.01, 0, 0.01};
  int turns = 0;
  double first = 0, last = 0;
  for (int n = 0; n < 20000; ++n) {
    const double before = p.q[1].angle;
    p.run(1e-3, 10);
    if (before < 0 && p.q[1].angle >= 0) {
      last = n * 1e-3;
      if (turns++ == 0) first = last;
    }
  }
  EXPECT_NEAR((last - first) / (turns - 1), 2 * pi * std::sqrt((2 * 1 + 0.25) / (2 * 10 * 1)), 1e-3);
  EXPECT_NEAR(std::hypot(p.q[1].x, p.q[1].y), 1, 1e-9) << "project() closes the joint";
}

// The impulse of a body at rest is its weight over the step, found by warm starting in the second step.
TEST(PlainJoints, WarmStartsWithTheLastImpulse) {
  Pendulum p;
  p.run(1e-3, 10);
  EXPECT_NEAR(p.pin.impulses()[1], -2 * 10 * 1e-3, 1e-12) << "on the world; the body gets the opposite";
  p.v[1].y -= 1e-3 * 10;
  p.pin.prepare(p.q, p.m, 0.0, 1e-3);
  p.pin.warm_start(p.m, p.v);
  EXPECT_NEAR(p.v[1].y, 0, 1e-12);
  p.pin.prepare(p.q, p.m, 0.0, 2e-3);
  EXPECT_NEAR(p.pin.impulses()[1], -2 * 10 * 2e-3, 1e-12) << "of a step twice as long";
  p.pin.forget();
  EXPECT_EQ(p.pin.impulses()[1], 0);
  EXPECT_EQ(p.pin.parameters.pb_y, 1);
}

TEST(PlainJoints, MotorsLimitsAndSoftness) {
  Pendulum p;
  p.q[1] = plain::pose(0.0, 0.0, 0.0);
  p.pin.parameters = {};
  p.pin.angle() = {2, 0.75};  // 3 rad/s^2
  p.run(0.5, 0);
  EXPECT_NEAR(p.v[1].w, 1.5, 1e-12);
  p.run(1, 0);
  EXPECT_NEAR(p.v[1].w, 2, 1e-12);
  p.pin.angle().upper = p.q[1].angle + 1;
  p.run(2, 0);
  EXPECT_NEAR(p.q[1].angle, p.pin.angle().upper, 1e-12);
  p.pin.stiffness.hertz = 5;
  p.run(4, 10);
  EXPECT_NEAR(p.q[1].y, -10 / (10 * pi) / (10 * pi), 1e-9) << "it sags by g / w^2";
}

TEST(PlainJoints, ARopeOnlyPulls) {
  plain::rope_joint<float> rope;
  planar::Pose<float> q[2] = {plain::pose(0.f, 0.f, 0.f), plain::pose(0.f, 0.f, 0.f)};
  const planar::InverseMass<float> m[2] = {{0, 0}, {1, 1}};
  planar::Velocity<float> v[2] = {};
  rope.parameters.l = 1;
  for (int n = 0; n < 600; ++n) {
    v[1].y -= 0.01f;
    step(rope, q, m, v, 0.f, 1e-3f);
    if (n == 200) {
      EXPECT_NEAR(v[1].y, -2.01f, 1e-5f) << "slack";
    }
  }
  EXPECT_NEAR(q[1].y, -1, 1e-6f);
  EXPECT_NEAR(v[1].y, 0, 1e-5f);
}

// Three bodies at once: wheels on a frame that turns with them.
TEST(PlainJoints, AGearOfThreeBodiesKeepsItsRatio) {
  plain::gear_on_base_joint<double> gear;
  gear.parameters.ratio = 3;
  planar::Pose<double> q[3] = {plain::pose(0., 0., 0.), plain::pose(1., 0., 0.), plain::pose(0., 0., 0.)};
  const planar::InverseMass<double> m[3] = {{1, 2}, {1, 3}, {1, 5}};
  planar::Velocity<double> v[3] = {{0, 0, 1}, {0, 0, 0}, {0, 0, 0.5}};
  gear.by_default(planar::gear_on_base::index_of_ratio + 1, q, 0);
  gear.prepare(q, m, 0., 1e-3);
  gear.solve(m, v);
  double C_dot[1];
  planar::gear_on_base::Jacobian<double> J;
  double C[1];
  planar::gear_on_base::jacobian(q, gear.parameters, 0., C, J);
  planar::gear_on_base::velocity(J, v, C_dot);
  EXPECT_NEAR(C_dot[0], 0, 1e-12);
  EXPECT_NEAR(v[0].w / 2 + v[1].w / 3 + v[2].w / 5, 1. / 2 + 0.5 / 5, 1e-12) << "inner torques leave the spin";
}

// A bevel gear: a turns about x, b about y, both more than ten times.
TEST(PlainJoints, AGearInSpaceCountsWholeTurns) {
  plain::gear_joint<double> gear;
  auto& p = gear.parameters;
  cdot::test::make_bevel_gear(p);
  spatial::Pose<double> q[2] = {plain::pose(0., 0., 0., 1., 0., 0., 0.), plain::pose(0., 0., 0., 1., 0., 0., 0.)};
  const spatial::InverseMass<double> m[2] = {{1, 2, 2, 2, 0, 0, 0}, {1, 3, 3, 3, 0, 0, 0}};
  spatial::Velocity<double> v[2] = {{0, 0, 0, 9, 0, 0}, {}};
  gear.by_default(spatial::gear::index_of_angle_a_turns, q, 0);
  gear.angle_a() = {12, 0.5};  // 1 rad/s^2 of a alone
  double a = 0, b = 0;
  const double h = 1e-2;
  for (int n = 0; n < 1200; ++n) {
    gear.prepare(q, m, n * h, h);
    gear.warm_start(m, v);
    for (int sweep = 0; sweep < 8; ++sweep) gear.solve(m, v);
    for (int i = 0; i < 2; ++i) plain::move(q[i], v[i], h);
    EXPECT_LT(gear.project(q, m, n * h), 1e-4) << n;
    a += std::remainder(2 * std::atan2(q[0].e1, q[0].e0) - a, 2 * pi);
    b += std::remainder(2 * std::atan2(q[1].e2, q[1].e0) - b, 2 * pi);
  }
  EXPECT_GT(a, 100);
  EXPECT_NEAR(a + 1.3 * b, 0, 1e-9);
  EXPECT_NEAR(v[0].wx, 12, 1e-6);
  EXPECT_NEAR(v[0].wx + 1.3 * v[1].wy, 0, 1e-6);
  EXPECT_NEAR(p.angle_a_turns, 2 * pi * std::round(a / (2 * pi)), 1e-9);
}

// An emitted kernel and the one in generated/ at one pose: the same bits.
TEST(PlainJoints, TheKernelIsTheGeneratedOne) {
  const spatial::Pose<double> q[2] = {plain::pose(0.1, 0.2, 0.3, 1., 0.2, -0.3, 0.4),
                                      plain::pose(-1., 0.5, 2., -0.3, 1., 0.1, 0.7)};
  spatial::hinge::Parameters<double> p;
  double* numbers = &p.pa_x;
  for (int i = 0; i < int(sizeof p / sizeof(double)); ++i) numbers[i] = std::sin(1 + i);
  const spatial::InverseMass<double> m[2] = {{1, 2, 3, 4, 0.1, 0.2, 0.3}, {2, 1, 1, 2, 0.2, 0.1, 0.1}};
  spatial::hinge::Jacobian<double> J;
  HingeValues here;
  spatial::hinge::jacobian(q, p, 0., here.C, J);
  spatial::hinge::effective_mass(J, m, here.K);
  spatial::hinge::dense(J, here.D);
  HingeValues there;
  generated_hinge(&q[0].x, numbers, &m[0].m, there);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(here.C[i], there.C[i]);
  for (int i = 0; i < 15; ++i) EXPECT_EQ(here.K[i], there.K[i]);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(here.D[i / 12][i % 12], there.D[i / 12][i % 12]);
  EXPECT_NE(here.K[0], 0);
}

// A single header includes <cmath> alone and has no warning as C++17, by both compilers.
TEST(PlainJoints, ASingleHeaderNeedsNothing) {
  const std::string header = testing::TempDir() + "single_hinge.hpp";
  const std::string emit = CDOT " emit " CDOT_SOURCE_DIR "/specs/spatial/hinge.joint --for plain --single-header -o ";
  ASSERT_EQ(std::system((emit + header + " 2>/dev/null").c_str()), 0);
  std::ifstream in(header);
  int includes = 0;
  for (std::string line; std::getline(in, line);) {
    if (line.find("#include") == std::string::npos) continue;
    EXPECT_EQ(line, "#include <cmath>");
    ++includes;
  }
  EXPECT_EQ(includes, 1);
  const std::string program = testing::TempDir() + "single_hinge.cpp";
  std::ofstream(program) << "#include \"" << header << "\"\ntemplate class cdot::plain::hinge_joint<float>;\n"
                         << "int main() { cdot::plain::hinge_joint<double> j; return int(j.impulses()[0]); }\n";
  for (const std::string compiler : {CDOT_CXX, "clang++"})
    EXPECT_EQ(std::system((compiler + " -std=c++17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only " + program).c_str()),
              0)
        << compiler;
}

}  // namespace
