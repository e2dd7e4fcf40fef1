// Compares diagnoses with closed forms and with the dense K.
#include <Eigen/Dense>
#include <fmt/core.h>

#include <cdot/diagnose.hpp>
#include <cdot/jacobian.hpp>

#include "tests/methods.hpp"
#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/spatial_support.hpp"

namespace cdot::test {
namespace {

constexpr double h = 1e-3;

// L_n, by (k + 1) L_{k+1} = (2 k + 1 - x) L_k - k L_{k-1}.
double laguerre(int n, double x) {
  double before = 0, now = 1;
  for (int k = 0; k < n; ++k) {
    const double next = ((2 * k + 1 - x) * now - k * before) / (k + 1);
    before = now, now = next;
  }
  return now;
}

// All lie below 4 n; the largest is where the sign changes last.
double largest_root_of_laguerre(int n) {
  const double step = 1e-3;
  double high = 4.0 * n;
  while (laguerre(n, high) * laguerre(n, high - step) > 0) high -= step;
  double low = high - step;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (laguerre(n, middle) * laguerre(n, high) > 0 ? high : low) = middle;
  }
  return low;
}

template <class T>
void add_beads(World<T>& world, int count, double mass) {
  int before = world.ground();
  for (int k = 1; k <= count; ++k) {
    const int bead = world.add_body({.y = -0.5 * k, .mass = mass, .inertia = mass});
    distance(world, before, bead, 0.5);
    before = bead;
  }
}

// n equal beads on a hanging thread, l = 0.5 m apart: omega^2 = g / l times the roots of L_n (Bernoulli).
template <class T>
void check_hanging_beads(double within) {
  for (const int n : {1, 3, 10}) {
    World<T> world(settings(Solver::direct, Drift::projection, -9.81));
    add_beads(world, n, 0.2);
    const Diagnosis found = diagnose(world, h);
    ASSERT_EQ(found.islands.size(), 1u);
    const double right = 9.81 / 0.5 * largest_root_of_laguerre(n);
    fmt::print("  {} beads: omega^2 = {:.4f}, from Laguerre's polynomial {:.4f} 1/s^2\n", n,
               found.islands[0].stiffest.square, right);
    EXPECT_NEAR(found.islands[0].stiffest.square / right, 1, within);
    EXPECT_NEAR(found.islands[0].stiffest.tension / found.islands[0].stiffest.square, 1, 1e-6);
  }
}

TEST(Diagnose, StiffestMotionOfAHangingThread) {
  check_hanging_beads<double>(5e-3);
  check_hanging_beads<float>(2e-2);
}

// A rod that hangs by its end: omega^2 = 3 g / 2 l, in the plane and in space, with both solvers. Upside down omega^2
// is negative: the rod falls.
TEST(Diagnose, StiffestMotionOfAPendulum) {
  for (const auto& [name, solver, sweeps] : solvers) {
    World<double> world(settings(solver, Drift::projection, -9.81));
    add_chain(world, 1, -pi / 2);
    EXPECT_NEAR(diagnose(world, h).islands.at(0).stiffest.square, 1.5 * 9.81, 1e-3) << name;
    World<double> upright(settings(solver, Drift::projection, -9.81));
    add_chain(upright, 1, pi / 2);
    EXPECT_NEAR(diagnose(upright, h).islands.at(0).stiffest.square, -1.5 * 9.81, 1e-3) << name;
  }
}

// omega^2 = k (1 / m_a + 1 / m_b), at the lighter body, for a method with explicit spring forces.
TEST(Diagnose, StiffestMotionOfASpring) {
  Settings s = settings(Solver::direct);
  s.integrator = Integrator::rattle;
  World<double> world(s);
  const int heavy = world.add_body({.mass = 3, .inertia = 1}),
            light = world.add_body({.x = 2, .mass = 0.5, .inertia = 1});
  world.add_spring({.body_a = heavy, .body_b = light, .stiffness = 200, .rest_length = 2});
  const Diagnosis found = diagnose(world, h);
  ASSERT_EQ(found.islands.size(), 1u);
  EXPECT_NEAR(found.islands[0].stiffest.square / (200 * (1 / 3.0 + 1 / 0.5)), 1, 1e-6);
  EXPECT_EQ(found.islands[0].stiffest.body, light);
  EXPECT_NEAR(found.islands[0].stiffest.tension, 0, 1e-9);
  EXPECT_EQ(found.islands[0].rows, 0);
}

// A spring on a coordinate, with a damper: omega = sqrt(k / I) of a rod about its end for methods with explicit spring
// forces, 0 for methods that solve for them.
TEST(Diagnose, StiffestMotionOfASpringOnACoordinate) {
  for (const auto& [name, integrator] : integrators) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator;
    World<double> world(s);
    add_chain(world, 1, 0);
    add_spring(world, 0, "angle", {.softness = {.by_frequency = false, .stiffness = 300, .damping = 2}});
    const bool solved_for = integrator == Integrator::euler || integrator == Integrator::implicit;
    EXPECT_NEAR(diagnose(world, h).islands.at(0).stiffest.square, solved_for ? 0 : 300 * 3, 1e-3) << name;
  }
}

// Of a damper on the angle of a rod about its end, d / I, of one between points, d (1 / m_a + 1 / m_b), and of drag,
// by every method.
TEST(Diagnose, FastestDecay) {
  for (const auto& [name, integrator] : integrators) {
    Settings s = settings(Solver::direct);
    s.integrator = integrator;
    World<double> rod(s), pair(s), dragged(s);
    add_chain(rod, 1, 0);
    add_spring(rod, 0, "angle", {.softness = {.by_frequency = false, .stiffness = 300, .damping = 200}});
    EXPECT_NEAR(diagnose(rod, h).islands.at(0).fastest_decay.rate, 200 * 3, 1e-4) << name;
    const int heavy = pair.add_body({.mass = 3, .inertia = 1}),
              light = pair.add_body({.x = 2, .mass = 0.5, .inertia = 1});
    pair.add_spring({.body_a = heavy, .body_b = light, .rest_length = 2, .damping = 70});
    EXPECT_NEAR(diagnose(pair, h).islands.at(0).fastest_decay.rate, 70 * (1 / 3.0 + 1 / 0.5), 1e-4) << name;
    EXPECT_EQ(diagnose(pair, h).islands.at(0).fastest_decay.body, light) << name;
    dragged.add_body({.mass = 3, .inertia = 1, .linear_damping = 5, .angular_damping = 8});
    EXPECT_NEAR(diagnose(dragged, h).islands.at(0).fastest_decay.rate, 8, 1e-6) << name;
  }
}

// Round-off of a spring's 1e4 N is 1e-3 N there.
TEST(Diagnose, FastestDecayInFloats) {
  Settings s = settings(Solver::direct);
  s.integrator = Integrator::rattle;
  for (const double damping : {0.0, 70.0}) {
    World<float> world(s);
    const int a = world.add_body({.mass = 3, .inertia = 1}), b = world.add_body({.x = 2, .mass = 0.5, .inertia = 1});
    world.add_spring({.body_a = a, .body_b = b, .stiffness = 1e4, .rest_length = 1, .damping = damping});
    EXPECT_NEAR(diagnose(world, h).islands.at(0).fastest_decay.rate, damping * (1 / 3.0 + 1 / 0.5), 1);
  }
}

TEST(Diagnose, NothingDecaysWithoutDampers) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  add_chain(world, 3, 0);
  EXPECT_EQ(diagnose(world, h).islands.at(0).fastest_decay.rate, 0);
  EXPECT_EQ(diagnose(world, h).islands.at(0).fastest_decay.body, -1);
}

// The linearly implicit step removes the stiffness of tension on rods and on beads: no oscillation exceeds 1 rad per
// step. With the iterative solver the stiffness on beads remains.
TEST(Diagnose, SubtractsTheStiffnessThatTheImplicitStepRemoves) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = Integrator::implicit;
  constexpr double step = 1.0 / 60;
  World<double> rods(s), beads(s);
  s.solver = Solver::iterative;
  World<double> swept_beads(s);
  add_chain(rods, 10, -pi / 2, 0.1);
  const int lowest = rods.body_count() - 1, load = rods.add_body({.y = -10, .mass = 1000, .inertia = 1});
  revolute(rods, lowest, load, 0.5, 0, 0, 0);
  for (World<double>* world : {&beads, &swept_beads}) {
    add_beads(*world, 10, 0.1);
    const int bottom = world->body_count() - 1;
    distance(*world, bottom, world->add_body({.y = -5.5, .mass = 1000, .inertia = 1}), 0.5);
  }
  const auto radians = [&](World<double>& world) {
    return step * std::sqrt(diagnose(world, step).islands.at(0).stiffest.square);
  };
  const double of_rods = radians(rods), of_beads = radians(beads), swept = radians(swept_beads);
  fmt::print("  per step: rods {:.3f} rad, beads {:.3f} rad, beads under sweeps {:.3f} rad\n", of_rods, of_beads,
             swept);
  EXPECT_LT(of_rods, 1);
  EXPECT_LT(of_beads, 1);
  EXPECT_GT(swept, 10);
}

// Of the K of `cdot-run diagnose --matrix`, dense, rows scaled to 1.
template <class S>
double dense_condition(BasicWorld<S>& world) {
  const SystemMatrix system = system_matrix(world);
  Eigen::MatrixXd K(system.rows, system.rows);
  for (int r = 0; r < system.rows; ++r)
    for (int c = 0; c < system.rows; ++c) K(r, c) = system.K[static_cast<std::size_t>(r * system.rows + c)];
  const Eigen::VectorXd scale = K.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scale.asDiagonal() * K * scale.asDiagonal()).eigenvalues();
  return values.maxCoeff() / values.minCoeff();
}

TEST(Diagnose, ConditionIsThatOfTheDenseK) {
  for (const double ratio : {1.0, 1e3, 1e6}) {
    World<double> world(settings(Solver::direct));
    const auto rods = add_chain(world, 8, -0.4);
    revolute(world, rods.back(), world.add_body({.x = 8, .y = -4, .mass = ratio, .inertia = ratio}), 0.5, 0, 0.1, 0);
    const double right = dense_condition(world), found = diagnose(world, h).islands.at(0).condition;
    fmt::print("  mass ratio {:.0e}: condition {:.4e}, of the dense K {:.4e}\n", ratio, found, right);
    EXPECT_LE(found, right * (1 + 1e-9));
    EXPECT_GE(found, 0.9 * right);
  }
}

// Ten revolutes in one place: 18 of 20 rows are redundant, and each names the joint that it repeats.
TEST(Diagnose, NamesRedundantRows) {
  World<double> world(settings(Solver::direct));
  const int body = world.add_body(rod(0, 0, 0));
  for (int k = 0; k < 10; ++k) revolute(world, world.ground(), body, 0, 0, -0.5, 0);
  const Diagnosis::Island found = diagnose(world, h).islands.at(0);
  EXPECT_EQ(found.rows, 20);
  EXPECT_EQ(found.rank, 2);
  ASSERT_EQ(found.redundant.size(), 18u);
  for (const Diagnosis::Redundant& row : found.redundant) {
    EXPECT_FALSE(row.conflicting);
    EXPECT_EQ(row.joints.size(), 2u);
  }
}

// A side is 0.02 m too long: the contradicting row is off by that length, and all three joints take part.
TEST(Diagnose, ReportsTheSizeOfConflicts) {
  World<double> world(settings(Solver::direct));
  const auto side = [&](double x, double length) {
    return world.add_body({.x = x, .mass = 1, .inertia = length / 12});
  };
  const int a = side(0.5, 1), b = side(1.5, 1), c = side(1, 2.02), other = side(9, 1);
  revolute(world, world.ground(), other, 8.5, 0, -0.5, 0);
  revolute(world, a, b, 0.5, 0, -0.5, 0);
  revolute(world, b, c, 0.5, 0, 1.01, 0);
  revolute(world, c, a, -1.01, 0, -0.5, 0);
  for (const Diagnosis::Island& found : diagnose(world, h).islands) {
    if (found.bodies.front() == other) {
      EXPECT_TRUE(found.redundant.empty());
      continue;
    }
    EXPECT_EQ(found.rank, 5);
    ASSERT_EQ(found.redundant.size(), 1u);
    EXPECT_TRUE(found.redundant[0].conflicting);
    EXPECT_NEAR(std::abs(found.redundant[0].missed), 0.02, 1e-12);
    EXPECT_EQ(found.redundant[0].joints, (std::vector<int>{1, 2, 3}));
  }
}

TEST(Diagnose, TheSizeOfAnIslandIsItsLongestArmOrDistance) {
  World<double> world(settings(Solver::direct));
  const int a = world.add_body({.mass = 1, .inertia = 1}), b = world.add_body({.x = 3, .mass = 1, .inertia = 1});
  distance(world, a, b, 3);  // between the centres: no arm
  revolute(world, world.ground(), world.add_body({.x = 11, .mass = 1, .inertia = 1}), 9, 0, -2, 0);
  const Diagnosis found = diagnose(world, h);
  ASSERT_EQ(found.islands.size(), 2u);
  EXPECT_EQ(found.islands[0].size, 3);
  EXPECT_EQ(found.islands[1].size, 2);
}

// A diagnosis changes no bit of the state or of the run, with any method.
template <class S, class Build>
void check_that_looking_is_free(Build build) {
  const int methods = for_each_method(settings(Solver::direct, Drift::projection, -9.81),
                                      [&](const Settings& s, const std::string& name) {
                                        BasicWorld<S> world(s), unseen(s);
                                        build(world), build(unseen);
                                        for (int k = 0; k < 10; ++k) {
                                          diagnose(world, 0.01);
                                          world.step(0.01), unseen.step(0.01);
                                          ASSERT_EQ(world.hash(), unseen.hash()) << name;
                                        }
                                      });
  EXPECT_GE(methods, 12);
}

TEST(Diagnose, ChangesNothing) {
  check_that_looking_is_free<Planar<double>>([](auto& world) {
    add_chain(world, 4, -0.4);
    add_motor(world, 1, "angle", {.speed = 1, .max_force = 2});
    add_limit(world, 2, "angle", {.lower = -0.1, .upper = 0.1});
  });
  check_that_looking_is_free<Spatial<float>>([](auto& world) { add_free_mechanism(world); });
}

// A parallelogram of cranks of 1 m, 2 m apart, starts flat. Its tips have the accelerations -w_a^2 and -w_b^2 along the
// coupler, which turns at (w_b - w_a) / 2: its length asks for w_a^2 - w_b^2 + 2 ((w_b - w_a) / 2)^2 = 0, that is
// w_b = w_a or w_b = -3 w_a.
TEST(Diagnose, TellsIfVelocitiesDecideNoBranch) {
  const auto undecided = [](double wa, double wb) {
    World<double> world;
    const int a = add_bar(world, {0, 0, 1, 0}), b = add_bar(world, {2, 0, 3, 0}),
              coupler = add_bar(world, {1, 0, 3, 0});
    pin(world, world.ground(), a, 0, 0);
    pin(world, a, coupler, 1, 0);
    pin(world, coupler, b, 3, 0);
    pin(world, world.ground(), b, 2, 0);
    world.set_velocity(a, {0, wa / 2, wa});
    world.set_velocity(b, {0, wb / 2, wb});
    world.set_velocity(coupler, {0, (wa + wb) / 2, (wb - wa) / 2});
    const Diagnosis found = diagnose(world, h);
    EXPECT_EQ(found.islands[0].redundant.size(), 1u);
    return std::abs(found.islands[0].redundant[0].undecided);
  };
  EXPECT_EQ(undecided(1, 1), 0);
  EXPECT_EQ(undecided(1, -3), 0);
  EXPECT_EQ(undecided(0, 0), 0);
  EXPECT_NEAR(undecided(1, 0), 1.5, 1e-12);
  EXPECT_NEAR(undecided(2, -1), 4 - 1 + 4.5, 1e-12);
}

// Hinges in a ring whose last axis is tilted: rigid, but only by the tilt.
TEST(Diagnose, NamesARowThatAloneLocksAStructure) {
  for (const double tilt : {1e-2, 1e-3, 1e-4, 0.0}) {
    SpatialWorld<double> world;
    add_tilted_ring(world, tilt);
    const Diagnosis::Island found = diagnose(world, h).islands[0];
    fmt::print("  tilted by {} rad: mobility {}, {} nearly redundant rows\n", tilt, found.mobility,
               found.nearly_redundant.size());
    EXPECT_EQ(found.mobility, tilt == 0 ? 1 : 0);
    if (tilt == 0 || tilt > 5e-3) {
      EXPECT_TRUE(found.nearly_redundant.empty());
      continue;
    }
    ASSERT_EQ(found.nearly_redundant.size(), 1u);
    EXPECT_LT(found.nearly_redundant[0].per_way, 2 * tilt);
    EXPECT_GT(found.nearly_redundant[0].per_way, 0.1 * tilt);
  }
}

}  // namespace
}  // namespace cdot::test
