// Worlds in extended precision are closer to closed forms than any double. The tests do nothing if long double equals
// double.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include <cdot/world.hpp>

#include "runtime/direct/ldlt.hpp"

namespace cdot::test {
namespace {

using Real = long double;
constexpr bool finer = std::numeric_limits<Real>::digits > std::numeric_limits<double>::digits;
#define CDOT_ONLY_IF_FINER() \
  if (!finer) GTEST_SKIP() << "long double is double here"

// --- the factor ---

// K = J J^T of a chain of blocks with as many rows; each has its own columns and shares columns with the next.
struct Chain {
  BasicLdlt<Real> ldlt;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> K;

  Chain(const std::vector<int>& rows, std::mt19937& random) {
    std::vector<std::pair<int, int>> coupled;
    for (int i = 1; i < static_cast<int>(rows.size()); ++i) coupled.emplace_back(i, i - 1);
    ldlt.analyse(rows, coupled);
    constexpr int own = 10;
    decltype(K) J = decltype(K)::Zero(ldlt.size(), own * (static_cast<int>(rows.size()) + 1));
    for (size_t i = 0; i < rows.size(); ++i)
      for (int r = 0; r < rows[i]; ++r)
        for (int c = 0; c < 2 * own; ++c)
          J(ldlt.first(static_cast<int>(i)) + r, own * static_cast<int>(i) + c) =
              Real(random()) / Real(random.max()) - Real(0.5);
    K = J * J.transpose();
    for (int i = 0; i < K.rows(); ++i)
      for (int j = 0; j <= i; ++j)
        if (K(i, j) != 0) ldlt.values()[static_cast<size_t>(ldlt.place(i, j).at)] = K(i, j);
  }
};

TEST(Extended, TheFactorSolvesToItsEpsilon) {
  constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
  std::mt19937 random(1);
  Real worst_rest = 0, worst_off = 0;
  for (const int block : {1, 2, 3, 5, 6, 8}) {
    Chain chain(std::vector<int>(12, block), random);
    const Eigen::Index n = chain.K.rows();
    const std::vector<Real> none(static_cast<size_t>(n), 0);
    EXPECT_EQ(chain.ldlt.factor(none.data(), nullptr), 0);
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> b = decltype(b)::LinSpaced(n, -1, 2), dense = chain.K.llt().solve(b);
    Eigen::Matrix<Real, Eigen::Dynamic, 1> x(n);
    chain.ldlt.solve(b.data(), x.data());
    worst_rest = std::max(worst_rest, (chain.K * x - b).norm() / (chain.K.norm() * x.norm()));
    worst_off = std::max(worst_off, (x - dense).norm() / dense.norm());
  }
  fmt::print("  leaves {:.1Lf} epsilon of K x, off Eigen's dense solve by {:.1Le}\n", worst_rest / epsilon, worst_off);
  EXPECT_LT(worst_rest, 4 * epsilon);
  EXPECT_LT(worst_off, 2000 * epsilon);
}

// --- the pendulum ---

// Jacobi's amplitude am(u) and K(k) by Gauss's arithmetic-geometric mean.
struct Jacobi {
  static constexpr int most = 12;
  Real a[most + 1], c[most + 1];
  explicit Jacobi(Real k) {
    Real b = std::sqrt((1 - k) * (1 + k));
    a[0] = 1, c[0] = k;
    for (int n = 0; n < most; ++n) {
      a[n + 1] = (a[n] + b) / 2, c[n + 1] = (a[n] - b) / 2;
      b = std::sqrt(a[n] * b);
    }
  }
  Real quarter() const { return std::numbers::pi_v<Real> / (2 * a[most]); }
  Real amplitude(Real u) const {
    Real phi = std::ldexp(a[most] * u, most);
    for (int n = most; n > 0; --n) phi = (phi + std::asin(c[n] / a[n] * std::sin(phi))) / 2;
    return phi;
  }
};

constexpr double mass = 1.5, inertia = 0.3, length = 0.75, gravity = 9.75, step = 1.0 / 128;

// A body released level, on a pin `length` beside its centre.
template <class T>
World<T> pendulum() {
  World<T> world({.integrator = Integrator::dop853, .gravity_y = -gravity});
  const int body = world.add_body({.x = length, .mass = mass, .inertia = inertia});
  world.add_joint({"revolute", {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {-length, 0}}}, {}});
  return world;
}

// From the vertical: sin(angle / 2) = k sn(K + w t), k = sin 45 degrees.
Real angle_at(Real time) {
  const Real k = std::sqrt(Real(0.5)), m = mass, arm = length;
  const Real w = std::sqrt(m * gravity * arm / (inertia + m * arm * arm));
  const Jacobi jacobi(k);
  return 2 * std::asin(k * std::sin(jacobi.amplitude(jacobi.quarter() + w * time)));
}

struct Off {
  Real angle = 0, energy = 0;
};
template <class T>
Off off_after(int steps) {
  World<T> world = pendulum<T>();
  Off off;
  for (int k = 1; k <= steps; ++k) {
    EXPECT_TRUE(world.step(step));
    if (k % 16 != 0) continue;
    const auto q = world.pose(0);
    const auto v = world.velocity(0);
    const Real angle = Real(q.angle) + std::numbers::pi_v<Real> / 2;
    off.angle = std::max(off.angle, std::abs(angle - angle_at(Real(k) * step)));
    const Real vx = v.x, vy = v.y, w = v.w;
    const Real energy = (mass * (vx * vx + vy * vy) + inertia * w * w) / 2 + Real(mass) * gravity * q.y;
    off.energy = std::max(off.energy, std::abs(energy));  // 0 at the start
  }
  return off;
}

TEST(Extended, APendulumKeepsItsPlaceAndItsEnergy) {
  CDOT_ONLY_IF_FINER();
  constexpr int steps = 40 * 128;
  const Off in_doubles = off_after<double>(steps), extended = off_after<Real>(steps);
  fmt::print("  after 40 s off by {:.1Le} rad and {:.1Le} J, in doubles {:.1Le} rad and {:.1Le} J\n", extended.angle,
             extended.energy, in_doubles.angle, in_doubles.energy);
  EXPECT_LT(extended.angle, 1e-16L);
  EXPECT_LT(extended.energy, 1e-16L);
  EXPECT_LT(100 * extended.angle, in_doubles.angle);
  EXPECT_LT(100 * extended.energy, in_doubles.energy);
}

// --- the symmetric top without torque ---

// It precesses about its angular momentum L at |L| / I1 and rotates about its own axis at (1 - I3 / I1) w3.
constexpr double across = 0.5, along = 0.25, spins[] = {0.75, 0, 2};

struct Turn {
  Real e0, e1, e2, e3;
  friend Turn operator*(const Turn& p, const Turn& q) {
    return {
        p.e0 * q.e0 - p.e1 * q.e1 - p.e2 * q.e2 - p.e3 * q.e3, p.e0 * q.e1 + p.e1 * q.e0 + p.e2 * q.e3 - p.e3 * q.e2,
        p.e0 * q.e2 - p.e1 * q.e3 + p.e2 * q.e0 + p.e3 * q.e1, p.e0 * q.e3 + p.e1 * q.e2 - p.e2 * q.e1 + p.e3 * q.e0};
  }
};

template <class T>
Real top_off_after(int steps) {
  SpatialWorld<T> world({.integrator = Integrator::dop853});
  world.add_body({.wx = spins[0], .wz = spins[2], .mass = 1, .inertia = {across, across, along}});
  Real worst = 0;
  const Real Lx = across * spins[0], Lz = along * spins[2], L = std::hypot(Lx, Lz);
  for (int k = 1; k <= steps; ++k) {
    EXPECT_TRUE(world.step(step));
    if (k % 16 != 0) continue;
    const Real time = Real(k) * step, round = L / across * time / 2,
               own = (1 - Real(along) / across) * spins[2] * time / 2;
    const Turn precession{std::cos(round), std::sin(round) * Lx / L, 0, std::sin(round) * Lz / L};
    const Turn q = precession * Turn{std::cos(own), 0, 0, std::sin(own)};
    const auto pose = world.pose(0);
    const Real same = q.e0 * pose.e0 + q.e1 * pose.e1 + q.e2 * pose.e2 + q.e3 * pose.e3, sign = same < 0 ? -1 : 1;
    for (const Real difference :
         {q.e0 - sign * pose.e0, q.e1 - sign * pose.e1, q.e2 - sign * pose.e2, q.e3 - sign * pose.e3})
      worst = std::max(worst, std::abs(difference));
  }
  return worst;
}

TEST(Extended, ATopTurnsAsItsClosedForm) {
  CDOT_ONLY_IF_FINER();
  const Real in_doubles = top_off_after<double>(40 * 128), extended = top_off_after<Real>(40 * 128);
  fmt::print("  after 40 s its quaternion is off by {:.1Le}, in doubles {:.1Le}\n", extended, in_doubles);
  EXPECT_LT(extended, 1e-16L);
  EXPECT_LT(100 * extended, in_doubles);
}

}  // namespace
}  // namespace cdot::test
