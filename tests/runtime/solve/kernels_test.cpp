// Settings::kernels: three ways give the same impulses; a case that only `robust` solves.
#include <Eigen/Core>

#include <cdot/detail/kernel_forms.hpp>
#include <cdot/planar/weld.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr Kernels all_kernels[] = {Kernels::fast, Kernels::balanced, Kernels::robust};

// The gap of a bob of 1 kg at the end of a bar of 1 m that is 45 degrees below the horizontal, after a second.
template <class World>
double gap_of_pendulum(Kernels kernels, double inertia) {
  Settings settings;
  settings.solver = Solver::iterative;
  settings.kernels = kernels;
  settings.drift = Drift::none;
  settings.gravity_y = -9.81;
  World world(settings);
  BodyDefinition bob;
  bob.x = bob.y = -std::sqrt(0.5);
  bob.mass = 1, bob.inertia = inertia;
  const int body = world.add_body(bob);
  const int joint = world.add_joint({"revolute", {body, world.ground()}, {{"pa", {-bob.x, -bob.y}}}, {}});
  for (int i = 0; i < 1000; ++i) world.step(1e-3);
  const std::vector<double> gap = world.position_error(joint);
  return std::hypot(gap[0], gap[1]);
}

TEST(Kernels, AgreeWhereNothingIsExtreme) {
  const double expected = gap_of_pendulum<World<double>>(Kernels::balanced, 0.1);
  for (const Kernels kernels : all_kernels) EXPECT_NEAR(gap_of_pendulum<World<double>>(kernels, 0.1), expected, 1e-12);
}

// K of such a bob is (1/m) E + (r^2/I) t t': its second pivot is 2, a difference of two numbers near 5e6, which floats
// cannot represent. The row counts as redundant, and the bob falls out of its joint.
TEST(Kernels, RobustHoldsALongArmOnLittleInertia) {
  const double lost = gap_of_pendulum<World<float>>(Kernels::balanced, 1e-7);
  const double held = gap_of_pendulum<World<float>>(Kernels::robust, 1e-7);
  const double ideal = gap_of_pendulum<World<double>>(Kernels::balanced, 1e-7);
  RecordProperty("lost_held_ideal", std::to_string(lost) + " " + std::to_string(held) + " " + std::to_string(ideal));
  EXPECT_GT(lost, 0.1) << "balanced holds as well: then robust is not needed";
  EXPECT_LT(held, 1.1 * ideal + 1e-3);
}

// Two equal rows: one impulse satisfies both.
TEST(Kernels, AnInverseOfDependentRowsMeetsThem) {
  for (const double ratio : {0.5, 1.0, 3.0, 0.0}) {
    const double K[3] = {2, 2 * ratio, 2 * ratio * ratio}, rhs[2] = {0.7, 0.7 * ratio};
    double G[3], lambda[2];
    invert(K, G);
    multiply(G, rhs, lambda);
    EXPECT_NEAR(K[0] * lambda[0] + K[1] * lambda[1], rhs[0], 1e-14) << ratio;
    EXPECT_NEAR(K[1] * lambda[0] + K[2] * lambda[1], rhs[1], 1e-14) << ratio;
  }
  const double K[3] = {0, 0, 0};
  double G[3];
  invert(K, G);
  for (const double entry : G) EXPECT_EQ(entry, 0);
}

TEST(Kernels, FactorsByRowsAreThoseOfK) {
  const planar::Pose<double> q[2] = {{0.3, -0.2, 0.6, 0.8, 0.9272952180016122}, {-0.5, 0.4, 1, 0, 0}};
  const planar::weld::Parameters<double> p{0.4, -0.3, 0.2, 0.7, 0.1};
  planar::weld::Jacobian<double> J;
  double C[3], K[6], from_K[6], by_rows[6];
  planar::weld::jacobian(q, p, 0.0, C, J);
  // 0: neither body turns, so the third row of K is zero.
  for (const double turning : {1.7, 0.0}) {
    const planar::InverseMass<double> m[2] = {{0.5, turning}, {2, 0.3 * turning}};
    planar::weld::effective_mass(J, m, K);
    planar::weld::factor(K, from_K);
    factor_by_rows<6>(planar::weld{}, J, m, by_rows);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(by_rows[k], from_K[k], 1e-13) << k << ", " << turning;
  }
}

}  // namespace
}  // namespace cdot::test
