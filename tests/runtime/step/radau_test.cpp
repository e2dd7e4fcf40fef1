// Radau IIA: its coefficients satisfy the conditions of the theory, and steps do not shrink with stiffness.
#include <cmath>
#include <fmt/core.h>

#include "runtime/number/lu.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/step/runge_kutta_tables.hpp"
#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test::radau_test {
namespace {

constexpr int stages = 3;
constexpr const RungeKutta<double>& method = radau5<double>;
double c(int i) { return method.c[i + 1]; }
double a(int i, int j) { return method.a[i + 1][j + 1]; }
double b(int j) { return method.a[method.stages][j + 1]; }

// B(5): sum_j b_j c_j^(q-1) = 1/q for q <= 5. C(3): sum_j a_ij c_j^(q-1) = c_i^q / q for q <= 3. Together they give the
// fifth order (Hairer, Wanner, IV.5).
TEST(RadauTable, MeetsTheSimplifyingAssumptions) {
  for (int q = 1; q <= 5; ++q) {
    double sum = 0;
    for (int j = 0; j < stages; ++j) sum += b(j) * std::pow(c(j), q - 1);
    EXPECT_NEAR(sum, 1.0 / q, 1e-15);
    for (int i = 0; q <= 3 && i < stages; ++i) {
      double of_stage = 0;
      for (int j = 0; j < stages; ++j) of_stage += a(i, j) * std::pow(c(j), q - 1);
      EXPECT_NEAR(of_stage, std::pow(c(i), q) / q, 1e-15);
    }
  }
  double sixth = 0;
  for (int j = 0; j < stages; ++j) sixth += b(j) * std::pow(c(j), 5);
  EXPECT_GT(std::abs(sixth - 1.0 / 6), 1e-3);
}

// Stiffly accurate: the last stage is the end. The start has no part in the stages.
TEST(RadauTable, EndsWithItsLastStage) {
  EXPECT_EQ(c(stages - 1), 1);
  for (int j = 0; j < stages; ++j) EXPECT_EQ(b(j), a(stages - 1, j));
  for (int i = 0; i <= method.stages; ++i) EXPECT_EQ(method.a[i][0], 0);
}

// |R(z)| with R(z) = 1 + z b (1 - z A)^-1 e
double stability(Complex z) {
  Lu<Complex> lu;
  lu.reserve(stages);
  for (size_t i = 0; i < stages; ++i)
    for (size_t j = 0; j < stages; ++j)
      lu.at(i, j) = Complex{i == j ? 1.0 : 0.0} - a(static_cast<int>(i), static_cast<int>(j)) * z;
  EXPECT_TRUE(lu.factor());
  Complex x[stages] = {{1}, {1}, {1}};
  lu.solve(x);
  Complex sum{1};
  for (int j = 0; j < stages; ++j) sum = sum + b(j) * (z * x[j]);
  return std::hypot(sum.re, sum.im);
}

TEST(RadauTable, IsLStable) {
  for (double y = 1e-3; y < 1e6; y *= 1.1) EXPECT_LE(stability({0, y}), 1 + 1e-14) << y;
  for (const Complex direction : {Complex{-1, 0}, Complex{0, 1}, Complex{-1, 2}})
    EXPECT_LT(stability(1e8 * direction), 1e-7);
  EXPECT_NEAR(stability({-1, 0}), std::exp(-1), 1e-4);
}

TEST(RadauTable, PartsNewtonsMatrix) {
  constexpr const RadauTransformation& by = radau_transformation;
  const double parts[stages][stages] = {{by.real, 0, 0}, {0, by.alpha, -by.beta}, {0, by.beta, by.alpha}};
  for (int i = 0; i < stages; ++i)
    for (int j = 0; j < stages; ++j) {
      double one = 0, same = 0, inverse = 0;
      for (int k = 0; k < stages; ++k) {
        one += radau_inverse<double>[i][k] * a(k, j);
        same += by.T[i][k] * by.inverse[k][j];
        for (int l = 0; l < stages; ++l) inverse += by.T[i][k] * parts[k][l] * by.inverse[l][j];
      }
      EXPECT_NEAR(one, i == j, 1e-14);
      EXPECT_NEAR(same, i == j, 1e-14);
      EXPECT_NEAR(inverse, radau_inverse<double>[i][j], 1e-13);
    }
}

// The estimate is of third order: f(y) + sum_i e_i z_i / h = 0 for y = t^q, q = 1, 2, 3.
TEST(RadauTable, EstimatesCubicsToBeExact) {
  for (int q = 1; q <= 4; ++q) {
    double sum = q == 1;
    for (int i = 0; i < stages; ++i) sum += radau_error[i] * std::pow(c(i), q);
    if (q <= 3) EXPECT_NEAR(sum, 0, 1e-14);
    else EXPECT_GT(std::abs(sum), 0.01);
  }
}

// The slopes at the ends of a step are those of the polynomial through the k.
TEST(RadauTable, ContinuesTheSlopes) {
  for (int q = 0; q < stages; ++q) {
    double at_start = 0, at_end = 0;
    for (int j = 0; j < stages; ++j) {
      at_start += method.between[0][j + 1] * std::pow(c(j), q);
      at_end += method.between[1][j + 1] * std::pow(c(j), q);
    }
    EXPECT_NEAR(at_start, q == 0, 1e-14);
    EXPECT_NEAR(at_end, 1, 1e-14);
  }
}

Settings by(Integrator integrator, double local_error = 0, double gravity_y = 0) {
  return {.integrator = integrator, .local_error = local_error, .gravity_y = gravity_y};
}

// Two bodies on a line, the first on a soft spring of 20 N/m, joined by a stiff one: like one body of 2 kg they swing
// as cos(sqrt(10) t), but for the stretch of the stiff spring.
TEST(Radau, StiffSpringsDoNotShortenItsSteps) {
  for (double stiffness = 1e6; stiffness < 2e12; stiffness *= 100) {
    World<double> world(by(Integrator::radau5, 1e-6));
    const int first = world.add_body({.x = 2, .mass = 1, .inertia = 1});
    const int second = world.add_body({.x = 3, .mass = 1, .inertia = 1});
    world.add_spring({.body_a = world.ground(), .body_b = first, .stiffness = 20, .rest_length = 1});
    world.add_spring({.body_a = first,
                      .body_b = second,
                      .stiffness = stiffness,
                      .rest_length = 1,
                      .damping = 0.1 * std::sqrt(stiffness)});
    run(world, 5, 0.05);
    const StepCounts& counts = world.step_counts();
    const double off = std::abs(world.pose(first).x - 1 - std::cos(5 * std::sqrt(10.0)));
    fmt::print("  {:.0e} N/m: {} steps, {} rejected, {} evaluations, off by {:.1e} m\n", stiffness, counts.taken,
               counts.rejected, counts.evaluations, off);
    EXPECT_EQ(counts.rescued, 0);
    EXPECT_LT(off, 200 / stiffness + 1e-5);
    EXPECT_LT(counts.evaluations, 6000);
  }
}

// A bob on a spring falls from the horizontal, at first without tension. Its direction turns, so that the spring's
// force is far from linear; the motion nears that on a rigid rod like 1 / k.
TEST(Radau, StiffSpringsThatTurnDoNotShortenItsSteps) {
  World<double> rigid(by(Integrator::dop853, 1e-10, -9.81));
  const int bob = rigid.add_body({.x = 1, .mass = 1, .inertia = 0.1});
  distance(rigid, rigid.ground(), bob, 1);
  run(rigid, 2, 0.05);
  const auto end = rigid.pose(bob);
  for (double stiffness = 1e4; stiffness < 2e10; stiffness *= 100) {
    World<double> world(by(Integrator::radau5, 1e-6, -9.81));
    world.add_body({.x = 1, .mass = 1, .inertia = 0.1});
    world.add_spring({.body_a = world.ground(),
                      .body_b = bob,
                      .stiffness = stiffness,
                      .rest_length = 1,
                      .damping = 0.1 * std::sqrt(stiffness)});
    run(world, 2, 0.05);
    const StepCounts& counts = world.step_counts();
    const Balance balance = world.balance();
    const double off = std::hypot(world.pose(bob).x - end.x, world.pose(bob).y - end.y);
    fmt::print("  {:.0e} N/m: {} steps, {} rejected, {} evaluations, {:.1e} m from the rigid one, {:.1e} J lost\n",
               stiffness, counts.taken, counts.rejected, counts.evaluations, off, -balance.method());
    EXPECT_EQ(counts.rescued, 0);
    EXPECT_LT(off, 200 / stiffness + 1e-6);
    EXPECT_LT(counts.evaluations, 8000);
    EXPECT_NEAR(balance.method(), 0, 1e-4);
  }
}

// m x'' = -c x' - k x with c = 1e5 N s/m on 1 kg creeps as x = exp(-k t / c), from the start on or after its first 10
// us.
TEST(Radau, StiffDampersDoNotShortenItsSteps) {
  const double k = 1e5, c = 1e5, rate = (c - std::sqrt(c * c - 4 * k)) / 2;
  for (const double local_error : {0.0, 1e-6})
    for (const double v : {0.0, -rate, 100.0}) {
      World<double> world(by(Integrator::radau5, local_error));
      const int body = world.add_body({.x = 2, .vx = v, .mass = 1, .inertia = 1});
      world.add_spring({.body_a = world.ground(), .body_b = body, .stiffness = k, .rest_length = 1, .damping = c});
      run(world, 1, 1.0 / 60);
      // x = A exp(-rate t) + B exp(-fast t)
      const double fast = c - rate, A = (v + fast) / (fast - rate);
      const StepCounts& counts = world.step_counts();
      fmt::print("  error {:.0e}, {} m/s: {} steps, {} evaluations, off by {:.1e} m\n", local_error, v, counts.taken,
                 counts.evaluations, std::abs(world.pose(body).x - 1 - A * std::exp(-rate)));
      EXPECT_NEAR(world.pose(body).x - 1, A * std::exp(-rate), 1e-6);
      EXPECT_LT(counts.taken, 100);
      EXPECT_EQ(counts.rescued, 0);
    }
}

// A wheel on its centre swings on a torsion spring as 3 sin(w t) / w. Its arm is a round-off, one unit in the last
// place of x, or none, or a right angle's cosine: no length, and no step resolves it. A mechanism as small keeps its
// size.
template <class T>
void expect_no_arm(double x, double pin) {
  World<T> world(by(Integrator::radau5));
  const int wheel = world.add_body({.x = x, .w = 3, .mass = 1, .inertia = 1});
  const int joint = revolute(world, world.ground(), wheel, pin, 0, pin - x, 0);
  add_spring(world, joint, "angle", {.softness = {.by_frequency = false, .stiffness = 40}, .rest = 0});
  run(world, 1, 0.01);
  const double w = std::sqrt(40.0);
  EXPECT_NEAR(world.pose(wheel).angle, 3 * std::sin(w) / w, by_precision<T>(1e-4, 1e-7)) << pin - x;
  EXPECT_EQ(world.step_counts().rescued, 0) << pin - x;
  EXPECT_EQ(world.data().islands.front().size, 1) << pin - x;
}

TEST(Radau, AnArmOfRoundOffIsNone) {
  for (const double pin : {1000.3, std::nextafter(1000.3, 2000)}) expect_no_arm<double>(1000.3, pin);
  expect_no_arm<double>(0, std::cos(pi / 2));
  expect_no_arm<float>(1000.3, 1000.30006);
  World<float> small(by(Integrator::radau5));
  const int bob = small.add_body({.x = 1e-6, .mass = 1, .inertia = 1e-12});
  revolute(small, small.ground(), bob, 0, 0, -1e-6, 0);
  EXPECT_TRUE(small.step(1e-3));
  EXPECT_NEAR(small.data().islands.front().size, 1e-6, 1e-8);
}

// A drive turns a wheel of 0.5 kg m^2 to 0 by k and d = k 1 s, with 2 N m at most: by a = 4 rad/s^2 from -1 rad, until
// w = -theta at t_1, where 4 t_1 = 1 - 2 t_1^2. From there on it holds w = -theta, as closely as it is stiff: by k =
// 1e9 within 2e-9 rad/s, which nothing but short steps finds.
template <class Wheel>
void expect_slides(const char* space, Wheel wheel) {
  const double t_1 = (std::sqrt(24.0) - 4) / 4, theta_1 = 2 * t_1 * t_1 - 1, end = 2;
  for (const double k : {1e5, 1e7, 1e9})
    for (const double local_error : {1e-2, 1e-4, 1e-6}) {
      const auto [angle, counts] = wheel(k, local_error, end);
      const double off = std::abs(angle - theta_1 * std::exp(t_1 - end));
      fmt::print("  {}, k = {:.0e}, error {:.0e}: {} steps, {} rejected, off by {:.1e} rad\n", space, k, local_error,
                 counts.taken, counts.rejected, off);
      EXPECT_LT(off, 4 / k + local_error / 10) << k;
      EXPECT_LT(counts.taken, 1000) << k;
      EXPECT_EQ(counts.rescued, 0) << k;
    }
}

TEST(Radau, StiffDrivesSlideBetweenTheirLimits) {
  const auto values = [](double k) {
    return std::vector<NamedValue>{{"target", {0}}, {"k", {k}}, {"d", {k}}, {"most", {2}}};
  };
  expect_slides("planar", [&](double k, double local_error, double end) {
    World<double> world(by(Integrator::radau5, local_error));
    const int rotor = world.add_body({.angle = -1, .mass = 1, .inertia = 0.5});
    revolute(world, world.ground(), rotor, 0, 0, 0, 0);
    world.add_joint({"position_drive", {rotor, world.ground()}, values(k), {}});
    run(world, end, 0.05);
    return std::pair(world.pose(rotor).angle, world.step_counts());
  });
  expect_slides("spatial", [&](double k, double local_error, double end) {
    SpatialWorld<double> world(by(Integrator::radau5, local_error));
    SpatialBodyDefinition wheel;
    wheel.mass = 1, wheel.inertia = {0.3, 0.3, 0.5};
    const int rotor = world.add_body(wheel);
    const int hinge = join(world, "hinge", world.ground(), rotor, {{"pa", {0, 0, 0}}, {"fa", {0, 0, 1}}});
    auto drive = values(k);
    drive.front().numbers = {1};
    add_effect(world, hinge, "angle", SpecEffect{"position_drive", drive});
    run(world, end, 0.05);
    return std::pair(world.coordinate(hinge, "angle") - 1, world.step_counts());
  });
}

// Its matrices are dense: an island that is too large is refused, not waited for.
TEST(Radau, RefusesLargeIslands) {
  World<double> world(by(Integrator::radau5));
  add_chain(world, 201, 0.3);
  const StepResult result = world.step(0.01);
  EXPECT_EQ(result.problem, StepProblem::too_large);
  EXPECT_EQ(result.island, 0);
  EXPECT_NE(in_words(result, "", "").find("more than 200 bodies"), std::string::npos);
  EXPECT_NE(likely_fix(result.problem, OnFailure::stop).find("dop853"), std::string::npos);
}

}  // namespace
}  // namespace cdot::test::radau_test
