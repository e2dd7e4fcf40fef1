// Worlds with effects from specs, and the order at which their errors vanish.
#pragma once

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/balance.hpp>
#include <cdot/integrators.hpp>
#include <cdot/methods.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test::effects {

inline Settings with(Integrator integrator, double gravity = 0) {
  Settings s = settings(Solver::direct, Drift::projection, gravity);
  s.integrator = integrator;
  return s;
}

inline int ball(World<double>& world, double x, double y, double vx = 0, double vy = 0, double mass = 1) {
  return world.add_body({.x = x, .y = y, .vx = vx, .vy = vy, .mass = mass, .inertia = 1});
}

// A wheel on an axle of the ground.
inline int wheel(World<double>& world, double inertia, double angle = 0, double w = 0) {
  const int body = world.add_body({.angle = angle, .w = w, .mass = 1, .inertia = inertia});
  revolute(world, world.ground(), body, 0, 0, 0, 0);
  return body;
}

inline void advance(World<double>& world, double duration, double h) {
  for (long k = 0; k < std::lround(duration / h); ++k) ASSERT_TRUE(world.step(h));
}

struct Expected {
  double floor = 1e-11;  // below it the error is round-off
  int by_kicks = 2;      // the order of RATTLE and of the midpoint rule
};

// Halving the step divides the error by 2^order, to 20 %, by every integrator.
template <class Error>
void expect_orders(const char* what, double h, double largest, const Error& error_of, Expected expected = {}) {
  for (const IntegratorRow& row : integrator_rows) {
    const double coarse = error_of(row.integrator, h), fine = error_of(row.integrator, h / 2);
    const int order = row.order == 2 ? expected.by_kicks : row.order;
    fmt::print("  {}, {}: {:.1e} at {} s, {:.1e} at half of it\n", what, row.name, coarse, h, fine);
    EXPECT_LT(coarse, largest) << row.name;
    EXPECT_TRUE(fine < expected.floor || coarse / fine > 0.8 * std::pow(2, order))
        << what << ", " << row.name << ": " << coarse / fine;
  }
}

// The energy that appeared or disappeared without a source, as a share of what moved; over a run.
inline double unaccounted(World<double>& world, double duration, double h) {
  BalanceWatch watch;
  watch.look(world.balance());
  for (long k = 0; k < std::lround(duration / h); ++k) {
    EXPECT_TRUE(world.step(h));
    watch.look(world.balance());
  }
  return watch.energy.share();
}

}  // namespace cdot::test::effects
