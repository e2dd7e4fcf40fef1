// The sparse block LDL^T against dense solves of Eigen, on K = J J^T of random joints between
// random bodies.
#include "runtime/direct/ldlt.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <random>

namespace cdot::test {
namespace {

struct Joints {
  std::vector<int> rows;                    // of each joint
  std::vector<std::pair<int, int>> bodies;  // of each joint; -1: the ground
};

// A system and its K as a dense matrix, in the order of the unknowns.
struct Problem {
  Ldlt ldlt;
  Eigen::MatrixXd J, K;
};

bool coupled(const std::pair<int, int>& a, const std::pair<int, int>& b) {
  for (int i : {a.first, a.second})
    if (i >= 0 && (i == b.first || i == b.second)) return true;
  return false;
}

// Each body has `freedom` columns of J.
Problem random_problem(const Joints& joints, int freedom, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Problem problem;
  std::vector<std::pair<int, int>> pairs;
  int last = 0;
  for (int i = 0; i < static_cast<int>(joints.rows.size()); ++i) {
    last = std::max({last, joints.bodies[i].first, joints.bodies[i].second});
    for (int j = 0; j < i; ++j)
      if (coupled(joints.bodies[i], joints.bodies[j])) pairs.emplace_back(i, j);
  }
  problem.ldlt.analyse(joints.rows, pairs);
  problem.J.setZero(problem.ldlt.size(), freedom * (last + 1));
  for (size_t i = 0; i < joints.rows.size(); ++i)
    for (int body : {joints.bodies[i].first, joints.bodies[i].second})
      for (int r = 0; body >= 0 && r < joints.rows[i]; ++r)
        for (int c = 0; c < freedom; ++c)
          problem.J(problem.ldlt.first(static_cast<int>(i)) + r, freedom * body + c) = uniform(random);
  return problem;
}

// K = J J^T into the dense matrix and, number by number, into the sparse one.
void assemble(Problem& problem) {
  problem.K = problem.J * problem.J.transpose();
  std::fill(problem.ldlt.values().begin(), problem.ldlt.values().end(), 0.0);
  for (int i = 0; i < problem.K.rows(); ++i)
    for (int j = 0; j <= i; ++j)
      if (problem.K(i, j) != 0) problem.ldlt.values()[problem.ldlt.place(i, j).at] = problem.K(i, j);
}

// Joints of different sizes in a connected graph.
Joints tangle(int count, int bodies, std::mt19937& random) {
  const int sizes[] = {1, 2, 3, 5, 6, 4, 9};
  Joints joints;
  for (int i = 0; i < count; ++i) {
    joints.rows.push_back(sizes[random() % std::size(sizes)]);
    const int a = static_cast<int>(random() % bodies), b = static_cast<int>(random() % bodies);
    joints.bodies.emplace_back(a, a == b ? -1 : b);
  }
  return joints;
}

// Body i hangs from body i - 1, body 0 from the ground.
Joints chain(int links, int rows) {
  Joints joints;
  for (int i = 0; i < links; ++i) {
    joints.rows.push_back(rows);
    joints.bodies.emplace_back(i - 1, i);
  }
  return joints;
}

Eigen::VectorXd solved(Problem& problem, const Eigen::VectorXd& b) {
  Eigen::VectorXd x(b.size());
  problem.ldlt.solve(b.data(), x.data());
  return x;
}

std::vector<double> none(const Problem& problem) {
  return std::vector<double>(static_cast<size_t>(problem.ldlt.size()), 0.0);
}
std::vector<char> free(const Problem& problem) {
  return std::vector<char>(static_cast<size_t>(problem.ldlt.size()), 0);
}

// Enough columns per body to make every row independent.
constexpr int ample = 40;

TEST(Ldlt, AgreesWithADenseSolve) {
  std::mt19937 random(1);
  double worst = 0;
  for (int count : {1, 2, 5, 12, 40}) {
    for (int attempt = 0; attempt < 5; ++attempt) {
      Problem problem = random_problem(tangle(count, count / 2 + 2, random), ample, random);
      assemble(problem);
      EXPECT_EQ(problem.ldlt.factor(none(problem).data(), free(problem).data()), 0);
      const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(problem.K.rows(), -1, 2);
      const Eigen::VectorXd x = solved(problem, b), expected = problem.K.llt().solve(b);
      const double off = (x - expected).norm() / expected.norm();
      EXPECT_LT(off, 1e-11) << count;
      EXPECT_LT((problem.K * x - b).norm(), 1e-13 * problem.K.norm() * x.norm());
      worst = std::max(worst, off);
      Eigen::VectorXd y(b.size()), in_place = b;
      problem.ldlt.multiply(x.data(), y.data());
      EXPECT_LT((y - problem.K * x).norm(), 1e-14 * problem.K.norm() * x.norm());
      problem.ldlt.solve(in_place.data(), in_place.data());
      EXPECT_EQ(in_place, x);
    }
  }
  fmt::print("off a dense solve by at most {:.2g}\n", worst);
}

TEST(Ldlt, RowsThatAreOutAndAddedDiagonals) {
  std::mt19937 random(2);
  for (int attempt = 0; attempt < 10; ++attempt) {
    Problem problem = random_problem(tangle(12, 6, random), ample, random);
    assemble(problem);
    const int n = problem.ldlt.size();
    std::vector<double> added(static_cast<size_t>(n));
    std::vector<char> out(static_cast<size_t>(n));
    Eigen::MatrixXd expected = problem.K;
    for (int i = 0; i < n; ++i) {
      added[i] = 0.1 * static_cast<double>(random() % 10);
      expected(i, i) += added[i];
      out[i] = static_cast<char>(random() % 3 == 0 ? 1 + random() % 2 : 0);
    }
    for (int i = 0; i < n; ++i) {
      if (!out[i]) continue;
      expected.row(i).setZero();
      expected.col(i).setZero();
      expected(i, i) = 1;
    }
    EXPECT_EQ(problem.ldlt.factor(added.data(), out.data()), 0);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, 1, 2), x = solved(problem, b);
    EXPECT_LT((x - expected.llt().solve(b)).norm(), 1e-11 * x.norm());
    for (int i = 0; i < n; ++i)
      if (out[i]) {
        EXPECT_EQ(x[i], b[i]);
      }
  }
}

// More rows than degrees of freedom: the number of dropped rows is the rank deficiency, also if small pivots magnify
// round-off. The remaining rows solve every consistent system.
TEST(Ldlt, DependentRowsAreCountedAndDropped) {
  std::mt19937 random(3);
  int inexact = 0;
  for (int attempt = 0; attempt < 500; ++attempt) {
    const int freedom = attempt % 2 ? 3 : 6;
    Problem problem = random_problem(tangle(4 + attempt % 30, 5, random), freedom, random);
    const int n = problem.ldlt.size();
    for (int k = 0; k < 3; ++k)  // some row three times another
      problem.J.row(static_cast<int>(random() % n)) *= 3;
    assemble(problem);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(problem.J);
    qr.setThreshold(1e-8);
    EXPECT_EQ(problem.ldlt.factor(none(problem).data(), free(problem).data()), n - qr.rank());
    const Eigen::VectorXd b = problem.K * Eigen::VectorXd::LinSpaced(n, -1, 2);
    const Eigen::VectorXd x = solved(problem, b);
    const double off = (problem.K * x - b).norm() / b.norm();
    inexact += off > 1e-7;
    EXPECT_LT(off, 1e-4) << n << " rows, rank " << qr.rank();
    EXPECT_GE((x.array() == 0).count(), n - qr.rank());
  }
  EXPECT_LE(inexact, 2);
}

// A row that was redundant from the start stays dropped at small errors of C, because it would lock the mechanism. A
// row that was independent stays in use down to round-off. After the removal of the neighbour that it repeated, the
// dropped row is used again.
TEST(Ldlt, RowsRedundantByDesignStayDropped) {
  std::mt19937 random(8);
  Joints joints = chain(4, 3);
  Problem problem = random_problem(joints, 6, random);
  const int last = problem.ldlt.size() - 1;
  const Eigen::RowVectorXd row = problem.J.row(last);
  const auto dependent = [&](Problem& of, double open, const std::vector<char>& out) {
    of.J.row(last) = of.J.row(last - 1) + open * row;
    assemble(of);
    return of.ldlt.factor(none(of).data(), out.data());
  };
  const auto all = free(problem);
  EXPECT_EQ(dependent(problem, 0, all), 1);
  EXPECT_EQ(dependent(problem, 1e-3, all), 1);
  auto without = all;
  without[last - 1] = 1;
  EXPECT_EQ(dependent(problem, 1e-3, without), 0);
  EXPECT_EQ(dependent(problem, 1e-3, all), 0) << "it was needed a moment ago";
  for (int i = 0; i < 100; ++i) EXPECT_EQ(dependent(problem, 0, all), 1);
  EXPECT_EQ(dependent(problem, 1e-3, all), 1) << "it has become a habit";
  EXPECT_EQ(dependent(problem, 1, all), 0);

  Problem passing = random_problem(joints, 6, random);
  EXPECT_EQ(dependent(passing, 1, all), 0);
  EXPECT_EQ(dependent(passing, 1e-3, all), 0);
  EXPECT_EQ(dependent(passing, 0, all), 1) << "at the singular pose";
  EXPECT_EQ(dependent(passing, 1e-3, all), 0);
}

// The last row follows from the one before it and, by a small part, from one that may leave. Without that one it is
// independent at once, with a pivot of 1e-6.
TEST(Ldlt, RowsThatFollowFromPassingOnesAreNoneByDesign) {
  std::mt19937 random(9);
  Problem problem = random_problem(chain(4, 3), 6, random);
  const int last = problem.ldlt.size() - 1;
  problem.J.row(last) = problem.J.row(last - 1) + 1e-3 * problem.J.row(last - 2);
  assemble(problem);
  std::vector<char> passing = free(problem), without = passing;
  without[last - 2] = 1;
  const auto dependent = [&](const std::vector<char>& out) {
    return problem.ldlt.factor(none(problem).data(), out.data(), passing.data());
  };
  EXPECT_EQ(dependent(free(problem)), 1);
  EXPECT_EQ(dependent(without), 1) << "no row passes";
  passing[last - 2] = 1;
  problem.ldlt.forget();
  for (int i = 0; i < 200; ++i) EXPECT_EQ(dependent(free(problem)), 1);
  EXPECT_EQ(dependent(without), 0);
}

// Chains, combs and trees have an order without fill-in.
TEST(Ldlt, ChainsAndTreesFillNothingIn) {
  std::mt19937 random(5);
  Joints comb = chain(20, 2), tree = chain(1, 3);
  for (int i = 0; i < 20; ++i) {
    comb.rows.push_back(3);
    comb.bodies.emplace_back(i, 20 + i);
  }
  for (int i = 1; i < 60; ++i) {
    tree.rows.push_back(i % 6 + 1);
    tree.bodies.emplace_back(static_cast<int>(random() % i), i);
  }
  for (Joints joints : {chain(50, 2), comb, tree}) {
    std::shuffle(joints.bodies.begin(), joints.bodies.end(), random);
    std::vector<std::vector<int>> neighbours(joints.rows.size());
    size_t before = 0, after = 0;
    for (size_t i = 0; i < joints.rows.size(); ++i)
      for (size_t j = 0; j < joints.rows.size(); ++j)
        if (i != j && coupled(joints.bodies[i], joints.bodies[j]))
          neighbours[i].push_back(static_cast<int>(j)), ++before;
    for (const Elimination& one : minimum_degree_order(joints.rows, neighbours, 0)) after += one.neighbours.size();
    EXPECT_EQ(2 * after, before);
  }
}

TEST(Ldlt, AChainCostsInProportionToItsLength) {
  for (int rows : {1, 2, 3, 5, 6}) {
    long cost[3];
    for (int k = 0; k < 3; ++k) {
      std::mt19937 random(6);
      cost[k] = random_problem(chain(100 << k, rows), 1, random).ldlt.multiplications();
    }
    EXPECT_EQ(cost[2] - cost[1], 2 * (cost[1] - cost[0]));
    fmt::print("{} rows a joint: {} multiplications for 100 joints, {} for 200, {} for 400\n", rows, cost[0], cost[1],
               cost[2]);
  }
}

// Discs in a square, each joined to its right and its lower neighbour, seven at the top joined to the ground. Joints
// have two rows; joints that share a disc are coupled.
long multiplications_of_grid(int n) {
  std::vector<std::vector<int>> joints_at(static_cast<size_t>(n * n));
  std::vector<int> rows;
  const auto add_joint = [&](int a, int b) {
    const auto grounded = [&](int disc) { return disc < n && std::abs(disc - n / 2) <= 3; };
    if (grounded(a) && grounded(b)) return;
    for (int disc : {a, b})
      if (!grounded(disc)) joints_at[disc].push_back(static_cast<int>(rows.size()));
    rows.push_back(2);
  };
  for (int disc = 0; disc < n * n; ++disc) {
    if (disc % n > 0) add_joint(disc - 1, disc);
    if (disc >= n) add_joint(disc - n, disc);
  }
  std::vector<std::pair<int, int>> pairs;
  for (const auto& joints : joints_at)
    for (int i : joints)
      for (int j : joints)
        if (j < i) pairs.emplace_back(i, j);
  Ldlt ldlt;
  ldlt.analyse(rows, pairs);
  return ldlt.multiplications();
}

// With nested dissection the cost of a grid of n bodies grows as n^1.5.
TEST(Ldlt, AGridCostsLittleMoreThanByDissection) {
  const long small = multiplications_of_grid(25), middle = multiplications_of_grid(50),
             large = multiplications_of_grid(100);
  const auto exponent = [](long few, long many, double bodies) {
    return std::log(double(many) / few) / std::log(bodies);
  };
  fmt::print("25 x 25: {}, 50 x 50: {} (n^{:.2f}), 100 x 100: {} multiplications (n^{:.2f} from 25 x 25)\n", small,
             middle, exponent(small, middle, 4), large, exponent(small, large, 16));
  EXPECT_LT(exponent(small, large, 16), 1.6);
  EXPECT_LT(exponent(middle, large, 4), 1.6);
}

// The middle joint is eliminated last, and its first neighbour is not its predecessor in the order.
TEST(Ldlt, AChainIsEliminatedFromBothItsEnds) {
  std::mt19937 random(7);
  const Problem problem = random_problem(chain(9, 2), 3, random);
  std::vector<int> place;
  for (int i = 0; i < 9; ++i) place.push_back(problem.ldlt.first(i) / 2);
  EXPECT_EQ(place, (std::vector<int>{0, 2, 4, 6, 8, 7, 5, 3, 1}));
}

// Rows e0 + eps (e1 + ... + ek): each pivot is eps^2, and all rows are independent. The bound on noise doubles from row
// to row, to 5e-12 at the tenth row, above every pivot. The true noise comes only from the previous row: y = (0, ...,
// 0, 1). A copy of the last row is redundant.
TEST(Ldlt, RowsAreNotDroppedForNoiseThatIsOverstated) {
  constexpr int rows = 10;
  const double eps = std::sqrt(5e-13);
  Ldlt ldlt;
  ldlt.analyse({rows + 1}, {});
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= i; ++j) ldlt.values()[ldlt.place(i, j).at] = 1 + eps * eps * (std::min({i, j, rows - 1}) + 1);
  const std::vector<double> added(rows + 1, 0.0);
  EXPECT_EQ(ldlt.factor(added.data(), nullptr), 1);
  for (int k = 1; k < rows; ++k) {
    EXPECT_FALSE(ldlt.dependent(k)) << "row " << k;
    EXPECT_NEAR(ldlt.pivot(k) / (eps * eps), 1, 0.01) << "row " << k;
  }
  EXPECT_TRUE(ldlt.dependent(rows));
}

}  // namespace
}  // namespace cdot::test
