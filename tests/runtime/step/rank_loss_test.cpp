// Mechanisms that pass poses where K loses rank, with steps that land on both sides of them at random.
#include <array>
#include <cmath>
#include <fmt/core.h>
#include <tuple>

#include <cdot/methods.hpp>

#include "tests/runtime/mechanisms.hpp"
#include "tests/runtime/sines.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

constexpr double gravity = 9.81, duration = 10;

// n windows: n + 1 cranks of 1 m and n level couplers, all of 1 kg, at right angles, turning at -1 rad/s. (N-four-bar
// mechanism of the IFToMM library of computational benchmark problems.) Flat at 0 and 180 degrees.
int add_windows(World<double>& world, int n) {
  std::vector<int> cranks;
  for (int k = 0; k <= n; ++k) {
    cranks.push_back(world.add_body(rod(k, 0, pi / 2)));
    world.set_velocity(cranks.back(), {0.5, 0, -1});
    revolute(world, world.ground(), cranks.back(), k, 0, -0.5, 0);
  }
  for (int k = 0; k < n; ++k) {
    const int coupler = world.add_body(rod(k, 1, 0));
    world.set_velocity(coupler, {1, 0, 0});
    revolute(world, cranks[k], coupler, 0.5, 0, -0.5, 0);
    revolute(world, coupler, cranks[k + 1], 0.5, 0, 0.5, 0);
  }
  return cranks.front();
}

// All bodies move as one: ((n + 1) / 3 + n) angle'' = -g cos(angle) ((n + 1) / 2 + n). RK4 with steps of 1e-5 s.
double angle_of_windows(int n) {
  const double rate = gravity * ((n + 1) / 2.0 + n) / ((n + 1) / 3.0 + n), h = 1e-4;
  double angle = pi / 2, spin = -1;
  for (long k = 0; k < std::lround(duration / h); ++k) {
    const auto f = [&](double at) { return -rate * std::cos(at); };
    const double a1 = f(angle), a2 = f(angle + h / 2 * spin), a3 = f(angle + h / 2 * spin + h * h / 4 * a1),
                 a4 = f(angle + h * spin + h * h / 2 * a2);
    angle += h * spin + h * h / 6 * (a1 + a2 + a3);
    spin += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return angle;
}

double error_of_windows(const Settings& s, int n, double h) {
  World<double> world(s);
  const int crank = add_windows(world, n);
  run(world, duration, h);
  EXPECT_EQ(world.step_counts().rescued > 0, s.integrator == Integrator::radau5) << "n = " << n << ", h = " << h;
  return std::abs(world.pose(crank).angle - angle_of_windows(n));
}

TEST(RankLoss, EveryFixedStepPassesTheFlatPosesOfParallelograms) {
  for (const int n : {1, 2, 5}) {
    for (const double h : {0.05, 0.02, 0.01, 0.005, 0.002}) {
      const double off = error_of_windows(runge_kutta(Integrator::dop853), n, h);
      fmt::print("  {} windows, steps of {} s: {:.1e} rad off\n", n, h, off);
      EXPECT_LT(off, 1e-6);
    }
  }
}

TEST(RankLoss, EveryAdaptiveStepPassesTheFlatPosesOfParallelograms) {
  for (const int n : {1, 2, 5}) {
    for (const double allowed : {1e-6, 1e-8, 1e-10, 1e-12}) {
      const double off = error_of_windows(runge_kutta(Integrator::dop853, allowed), n, 1.0 / 240);
      fmt::print("  {} windows, local error {:.0e}: {:.1e} rad off\n", n, allowed, off);
      EXPECT_LT(off, std::max(1e3 * allowed, 1e-8));
    }
  }
}

// Steps in parts end where whole ones end. Radau IIA leaves the flat poses to this rule.
TEST(RankLoss, TheMidpointRulePassesThemAtSecondOrder) {
  for (const Integrator integrator : {Integrator::implicit, Integrator::radau5}) {
    for (const int n : {1, 2, 5}) {
      for (const double h : {0.02, 0.01, 0.005, 0.002}) {
        const double off = error_of_windows(runge_kutta(integrator), n, h);
        fmt::print("  {} windows, {} by steps of {} s: {:.1e} rad off, {:.2f} h^2\n", n, row_of(integrator).name, h,
                   off, off / (h * h));
        EXPECT_LT(off, 200 * h * h);
      }
    }
  }
}

// Lengths 1 + 4 = 2 + 3: a four-bar that is no parallelogram and lies flat once per turn of its crank. The two branches
// cross there, but for a gap that the joints' places leave when they are rounded to `place` [m].
struct FourBar {
  explicit FourBar(const Settings& s, double place = 0) : world(s) {
    const auto rounded = [&](double x) { return place > 0 ? std::round(x / place) * place : x; };
    const double t = 1, w = 6, x = std::cos(t), y = std::sin(t), dx = 2 - x, dy = -y, r = std::hypot(dx, dy);
    const double along = (r * r + 16 - 9) / (2 * r), beside = std::sqrt(16 - along * along);
    const double px = rounded(x), py = rounded(y), qx = rounded(x + (along * dx - beside * dy) / r),
                 qy = rounded(y + (along * dy + beside * dx) / r);
    crank = add_bar(world, {0, 0, px, py});
    const int coupler = add_bar(world, {px, py, qx, qy}), rocker = add_bar(world, {2, 0, qx, qy});
    pin(world, world.ground(), crank, 0, 0);
    pin(world, crank, coupler, px, py);
    pin(world, coupler, rocker, qx, qy);
    pin(world, world.ground(), rocker, 2, 0);
    // (q - p) (q' - p') = 0 and (q - d) q' = 0
    const double ax = qx - px, ay = qy - py, bx = qx - 2, by = qy, vx = -w * py, vy = w * px;
    const double right = ax * vx + ay * vy, det = ax * by - ay * bx, ux = right * by / det, uy = -right * bx / det;
    world.set_velocity(crank, {vx / 2, vy / 2, w});
    world.set_velocity(coupler, {(vx + ux) / 2, (vy + uy) / 2, (ax * (uy - vy) - ay * (ux - vx)) / 16});
    world.set_velocity(rocker, {ux / 2, uy / 2, (bx * uy - by * ux) / 9});
  }
  World<double> world;
  int crank;
};

TEST(RankLoss, EveryStepPassesTheChangePointOfAGeneralFourBar) {
  double angle = 0;
  const auto check = [&](const Settings& s, double h, double energy_off, double angle_off) {
    FourBar bar(s);
    const double start = bar.world.energy();
    double worst = 0;
    for (long k = 0; k < std::lround(duration / h); ++k) {
      bar.world.step(h);
      worst = std::max(worst, std::abs(bar.world.energy() - start));
    }
    const double end = bar.world.pose(bar.crank).angle;
    if (angle == 0) angle = end;
    fmt::print("  steps of {} s, local error {:.0e}: energy {:.1e} of {:.1f} J off, crank at {:.10f} rad\n", h,
               s.local_error, worst, start, end);
    EXPECT_EQ(bar.world.step_counts().rescued, 0);
    EXPECT_LT(worst, energy_off);
    EXPECT_NEAR(end, angle, angle_off);
  };
  check(runge_kutta(Integrator::dop853, 1e-12), 1.0 / 240, 1e-5, 0);
  for (const double h : {0.01, 0.005, 0.002, 0.001}) check(runge_kutta(Integrator::dop853), h, 1e-3, 1e-4);
  for (const double allowed : {1e-6, 1e-8, 1e-10})
    check(runge_kutta(Integrator::dop853, allowed), 1.0 / 240, 1e4 * allowed, 1e4 * allowed);
}

// Small steps would follow a branch of the rounded four-bar through the gap.
TEST(RankLoss, BranchesThatCrossButForRoundedNumbersArePassedStraightOn) {
  const auto angle_after = [](double place, double allowed) {
    FourBar bar(runge_kutta(Integrator::dop853, allowed), place);
    run(bar.world, duration, 1.0 / 240);
    fmt::print("  places rounded to {:.0e} m, local error {:.0e}: crank at {:.8f} rad, {} gaps crossed\n", place,
               allowed, bar.world.pose(bar.crank).angle, bar.world.step_counts().crossed);
    return std::pair(bar.world.pose(bar.crank).angle, bar.world.step_counts().crossed);
  };
  const double exact = angle_after(0, 1e-12).first;
  long long crossed = 0;
  for (const double place : {1e-12, 1e-10, 1e-9})
    for (const double allowed : {1e-6, 1e-8, 1e-10, 1e-12}) {
      const auto [angle, count] = angle_after(place, allowed);
      EXPECT_NEAR(angle, exact, 0.02) << place << " " << allowed;
      crossed += count;
    }
  EXPECT_GT(crossed, 0);
}

// 1000 kg, 1 g, 1000 kg in a row: a pivot of K falls to a millionth as the light rod turns, without any loss of rank.
// Nothing but its error bounds the first step. RK4 by equal steps is the second route.
TEST(RankLoss, ALightRodBetweenHeavyOnesIsNone) {
  const auto end_of = [&](const Settings& s, double h) {
    World<double> world(s);
    int before = world.ground();
    for (int k = 0; k < 3; ++k) {
      const int next = add_bar(world, {1.0 * k, 0, k + 1.0, 0}, k == 1 ? 1e-3 : 1e3);
      pin(world, before, next, k, 0);
      before = next;
    }
    run(world, 5, h);
    return world.pose(before);
  };
  const auto truth = end_of(runge_kutta(Integrator::rk4), 5e-5);
  for (const double h : {0.25, 5.0 / 64, 0.05}) {
    const auto end = end_of(runge_kutta(Integrator::dop853, 1e-13), h);
    const double off = std::max(std::hypot(end.x - truth.x, end.y - truth.y), std::abs(end.angle - truth.angle));
    fmt::print("  steps of {} s: {:.1e} off\n", h, off);
    EXPECT_LT(off, 3e-11);
  }
}

// A heavy body on a constant-velocity joint, its shaft upright at the start, falls past the pose where the shafts point
// against each other. There the third row of the joint vanishes, and every turn about the shaft keeps the joint.
std::array<double, 3> after_fall(Settings s, double h, double x, double y, double z) {
  s.gravity_y = 0, s.gravity_z = -gravity;
  SpatialWorld<double> world(s);
  const int body = world.add_body({.x = x, .y = y, .z = z, .mass = 2, .inertia = {0.3, 0.2, 0.25}});
  world.add_joint(
      {"constant_velocity", {world.ground(), body}, {{"pa", {0, 0, 0}}, {"pb", {-x, -y, -z}}, {"fa", {0, 0, 1}}}, {}});
  for (long k = 0; k < std::lround(1.5 / h); ++k) EXPECT_TRUE(world.step(h));
  const auto place = world.place(body);
  return {place.x, place.y, place.z};
}

TEST(RankLoss, ShaftsThatPassEachOtherKeepTheirBranch) {
  constexpr double starts[][3] = {{0.45, 0.15, 0.23}, {0.34, -0.08, 0.14}, {0.36, -0.13, 0.11}, {0.49, 0.27, 0.12}};
  double worst = 0;
  for (const auto& [x, y, z] : starts) {
    const auto passed = after_fall(runge_kutta(Integrator::rattle), 1e-4, x, y, z);
    for (const auto& [integrator, local_error] :
         {std::pair(Integrator::dop853, 1e-6), {Integrator::dop853, 1e-9}, {Integrator::rk4, 1e-8}}) {
      const auto there = after_fall(runge_kutta(integrator, local_error), 0.01, x, y, z);
      for (size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(there[k] - passed[k]));
      for (size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(there[k], passed[k], 5e-6)
            << name_of(integrators, integrator) << " at " << local_error << ", " << x;
    }
  }
  fmt::print("  shafts that pass each other: at most {:.1e} m from RATTLE by steps of 1e-4 s\n", worst);
}

// A plate rolls on a fixed ball, and a straight wire on it runs through a fixed bead. So the bead stays where it is on
// the wire, and the plate turns about the line from the contact to it, but where that line is at right angles to the
// wire: there a row of the wire follows from rolling.
struct PlateOnBall {
  double slid, lost;  // the farthest way of the bead [m]; the largest share of the kinetic energy
  long long steered;  // steps by projected stages
};
PlateOnBall plate_on_ball(Settings s, double h) {
  s.gravity_x = 9.2, s.gravity_y = 8.5, s.gravity_z = 2.9;
  SpatialWorld<double> world(s);
  constexpr double inertia = 3.19;
  SpatialBodyDefinition d{.x = 1.28831, .y = -0.371709, .z = -3.03595, .mass = 1};
  d.e0 = -0.258283, d.e1 = 0.112348, d.e2 = 0.872133, d.e3 = 0.400065;
  d.inertia = {inertia, inertia, inertia};
  const int plate = world.add_body(d), ground = world.ground();
  world.set_velocity(plate, {0.122498, 0.0570927, 0.0113616, -0.0186461, 0.021543, 0.0927824});
  const std::vector<double> of_plate = {-0.103, -0.768, -0.632, 0.995, -0.0797, -0.0655};
  const std::vector<double> of_wire = {0.0633994, -0.047961, -0.996835};
  world.add_joint(
      {"rolling_sphere", {plate, ground}, {{"fa", of_plate}, {"radius", {1.77}}, {"pa", {2.9, 3.03, 0.207}}}, {}});
  const int wire =
      world.add_joint({"point_on_line",
                       {plate, ground},
                       {{"pa", {0.947899, 1.06331, 1.03224}}, {"pb", {0.546672, 1.09448, -2.4075}}, {"fa", of_wire}},
                       {}});
  EXPECT_TRUE(world.project(1e-12));
  const double start = world.coordinate(wire, "slide"), energy = world.energy();
  PlateOnBall seen{};
  for (long k = 0; k < std::lround(1.5 / h); ++k) {
    EXPECT_TRUE(world.step(h));
    const auto v = world.velocity(plate);
    const double kinetic =
        (v.x * v.x + v.y * v.y + v.z * v.z + inertia * (v.wx * v.wx + v.wy * v.wy + v.wz * v.wz)) / 2;
    seen.slid = std::max(seen.slid, std::abs(world.coordinate(wire, "slide") - start));
    seen.lost = std::max(seen.lost, std::abs(world.energy() - energy) / std::max(kinetic, 1.0));
  }
  seen.steered = world.step_counts().steered;
  return seen;
}

TEST(RankLoss, APlateThatRollsOnABallPassesIt) {
  for (const auto& [integrator, h, most] : {std::tuple(Integrator::euler, 0.0075, 0.1),
                                            {Integrator::euler, 0.001, 0.02},
                                            {Integrator::implicit, 0.03, 1e-3},
                                            {Integrator::implicit, 0.0075, 1e-4},
                                            {Integrator::rattle, 0.03, 2e-3},
                                            {Integrator::rattle, 0.0075, 1e-4},
                                            {Integrator::rattle, 0.001, 2e-6},
                                            {Integrator::rk4, 0.03, 1e-4},
                                            {Integrator::rk4, 0.0075, 1e-6},
                                            {Integrator::dop853, 0.03, 1e-10}}) {
    const PlateOnBall seen = plate_on_ball(runge_kutta(integrator), h);
    fmt::print("  {} by {} s: the bead slides by {:.1e} m, {:.1e} of the energy is lost\n",
               name_of(integrators, integrator), h, seen.slid, seen.lost);
    EXPECT_LT(seen.slid, most);
    EXPECT_LT(seen.lost, most);
    EXPECT_EQ(seen.steered > 0, works_on_accelerations(integrator));
  }
}

// Two rods in line, pulled along themselves, with a rope across their pin. In line the rope repeats the rows of the pin
// and is as long as it ever gets: it must not hinder the rods from bending, at once or, as they turn, when their
// brake begins to slip.
TEST(RankLoss, OfARopeInLineWithItsJointsLeavesThemFree) {
  const auto bent = [](const Settings& s, bool braked, bool roped) {
    World<double> world(s);
    const int rods[] = {world.add_body(rod(0, 0, 0, 2)), world.add_body(rod(1, 0, 0))};
    revolute(world, world.ground(), rods[0], 0, 0, -0.5, 0);
    revolute(world, rods[0], rods[1], 0.5, 0, -0.5, 0);
    if (braked) {
      add_effect(world, 0, "angle", SpecEffect{"ratchet", {{"count", {6}}, {"most", {10}}}});
      add_effect(world, 1, "angle", SpecEffect{"freewheel", {}});
      add_effect(world, 1, "angle", SpecEffect{"air_brake", {{"torque", {2}}, {"rise", {0.5}}}});
      add_effect(world, 1, "angle", SpecEffect{"pin_friction", {{"mu", {0.1}}, {"radius", {0.02}}}});
    }
    if (roped)
      world.add_joint({"max_distance", {rods[0], rods[1]}, {{"pa", {-0.3, 0}}, {"pb", {-0.2, 0}}, {"l", {1.1}}}, {}});
    run(world, 0.5, 0.01);
    EXPECT_EQ(world.step_counts().rescued, 0) << name_of(integrators, s.integrator) << ' ' << s.local_error;
    return world.pose(rods[1]).angle;
  };
  for (Settings s : {runge_kutta(Integrator::dop853, 1e-9), runge_kutta(Integrator::dop853, 1e-4),
                     runge_kutta(Integrator::radau5, 1e-8), runge_kutta(Integrator::rk4)}) {
    for (const bool braked : {false, true}) {
      s.gravity_x = braked ? 0 : 10;
      EXPECT_NEAR(bent(s, braked, true), bent(s, braked, false), std::max(1e-7, s.local_error))
          << name_of(integrators, s.integrator) << ' ' << s.local_error << (braked ? ", braked" : "");
    }
  }
}

// Rods fall, and are straight again after 0.6 s. By equal steps, whose ends act before they are met, the rope stops
// them there or does not: that is told. A limit stops them in any case.
TEST(RankLoss, OfARopeInLineWithItsJointsIsToldByEqualSteps) {
  for (const Integrator integrator : {Integrator::rattle, Integrator::implicit})
    for (const bool roped : {true, false}) {
      Settings s = settings(Solver::direct, Drift::projection, -gravity);
      s.integrator = integrator;
      World<double> world(s);
      const auto rods = add_chain(world, 2, 0);
      if (roped)
        world.add_joint({"max_distance", {rods[0], rods[1]}, {{"pa", {-0.3, 0}}, {"pb", {-0.2, 0}}, {"l", {1.1}}}, {}});
      else add_limit(world, 1, "angle", {.lower = -0.3, .upper = 0.3});
      while (world.time() < 0.7 && world.step(1e-3)) {
      }
      EXPECT_EQ(world.step_counts().undecided > 0, roped) << name_of(integrators, integrator);
      EXPECT_EQ(world.step_counts().undecided_joint, roped ? 2 : -1) << name_of(integrators, integrator);
    }
}

}  // namespace
}  // namespace cdot::test
