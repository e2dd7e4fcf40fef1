#include "runtime/events/slackening.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

// Of the largest second derivative of C: less is round-off, as of a rope beside a rod.
template <class T>
constexpr T noticed = T(by_precision<T>(1e-3, 1e-6));
constexpr double golden = 0.6180339887498949;  // its multiples spread evenly

// f(row, batch, i) for the ends that the last solution held. A pin, with both ends at one place, does not let go.
template <class S, class F>
void each_held_end(System<S>& system, F f) {
  system.each_row([&](int row, Batch<S>& batch, int i) {
    if (has_ends(batch) && batch.mode[i] == Mode::held && !system.broken[row] &&
        std::isinf(batch.lower[i]) != std::isinf(batch.upper[i]))
      f(row, batch, i);
  });
}

template <class S>
int redundant_rows(const System<S>& system) {
  int count = 0;
  for (int r = 0; r < system.rows(); ++r) count += system.dependent(r);
  return count;
}

// b += weight gamma, at the velocities `direction` dv/dt.
template <class S>
void add_gamma(WorldData<S>& world, Island<S>& island, typename S::Scalar time, double direction, double weight) {
  auto& all = world.bodies;
  System<S>& system = island.at_work();
  for (int i : island.bodies) {
    all.increment[i] = all.velocity[i];
    all.velocity[i] = S::sum({}, all.velocity_rate[i], typename S::Scalar(direction));
  }
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->gamma(*batch, begin, end, all, time, batch->bias.data());
  system.each_row([&](int row, const Batch<S>& batch, int i) { system.b[row] += weight * batch.bias[i]; });
  for (int i : island.bodies) all.velocity[i] = std::exchange(all.increment[i], {});
}

// b = d2C/dt2 by a motion with v = dv/dt, apart from what joints do against it. gamma is quadratic in v; the parts of
// time and of the first power of v fall out of (gamma(v) + gamma(-v)) / 2 - gamma(0). Returns the largest.
template <class S>
double find_bends(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  System<S>& system = island.at_work();
  std::fill(system.b.begin(), system.b.end(), 0);
  add_gamma(world, island, time, 1, 0.5);
  add_gamma(world, island, time, -1, 0.5);
  add_gamma(world, island, time, 0, -1);
  double largest = 0;
  for (int r = 0; r < system.rows(); ++r)
    if (!system.broken[r]) largest = std::max(largest, std::abs(double(system.b[r])));
  return largest;
}

// d2C/dt2 of a row that is left out, beside the others: these keep theirs at 0.
template <class S>
double bend_beside_others(System<S>& system, int row) {
  for (int r = 0; r < system.rows(); ++r) system.lambda[r] = system.fixed[r] || system.broken[r] ? 0 : system.b[r];
  system.solve_factored(system.lambda.data());
  system.find_excess();
  return double(system.excess(row));
}

// By a motion, about an end that was held; kept in Batch::impulse.
enum Tells : int { nothing = 0, closes = 1, opens = 2 };

// True if the joints allow the motion with v = dv/dt: round-off, as at rest, is none. By Cauchy and Schwarz,
// |J_r v| <= sqrt(K_rr v'Mv).
template <class S>
bool joints_allow_motion(const WorldData<S>& world, Island<S>& island) {
  const auto& motion = world.bodies.velocity_rate;
  System<S>& system = island.at_work();
  double twice_energy = 0;
  for (int i : island.bodies) twice_energy += S::dot(S::force(world.bodies.inverse_mass[i], motion[i]), motion[i]);
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->velocity(*batch, begin, end, motion.data(), batch->rate.data());
  bool allow = twice_energy > 0;
  const double most = std::pow(double(noticed<typename S::Scalar>), 2) * twice_energy;
  system.each_row([&](int row, const Batch<S>& batch, int i) {
    if (batch.law || batch.explicit_time() || system.broken[row]) return;
    allow = allow && double(batch.rate[i]) * double(batch.rate[i]) <= most * double(system.diagonal(row));
  });
  return allow;
}

// Asks the motion with v = dv/dt about the ends of which nothing is told.
template <class S>
void look_along(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  if (!joints_allow_motion(world, island)) return;
  System<S>& system = island.at_work();
  const double least = double(noticed<T>) * find_bends(world, island, time);
  Guard<T> guards[most_rows];
  each_held_end(system, [&](int row, Batch<S>& batch, int i) {
    if (batch.impulse[i] != T(nothing)) return;
    batch.law->guard(batch, i / batch.ops->rows, guards);
    const double bend = bend_beside_others(system, row);
    if (std::abs(bend) > least)
      batch.impulse[i] = T((bend > 0) == (guards[i % batch.ops->rows].lower == T(0)) ? opens : closes);
  });
}

// dv/dt = any motion that the joints allow.
template <class S>
void wander(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  auto& motion = world.bodies.velocity_rate;
  int count = 0;
  for (int body : island.bodies) {
    T number[S::freedom];
    for (T& one : number) one = T(std::fmod(golden * ++count, 1.0) - 0.5);
    motion[body] = world.bodies.immovable(body) ? typename S::Velocity{} : S::read_velocity(number);
  }
  system.choose([](const Batch<S>& batch, int) { return !batch.law; });
  system.factor();
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->velocity(*batch, begin, end, motion.data(), batch->rate.data());
  system.each_row([&](int row, const Batch<S>& batch, int i) { system.lambda[row] = batch.law ? 0 : -batch.rate[i]; });
  system.solve_factored(system.lambda.data());
  system.each_row([&](int row, Batch<S>& batch, int i) { batch.error[i] = batch.law ? T(0) : T(system.lambda[row]); });
  exert(world, island, system, &BatchWorkspace<S>::error, motion.data());
}

// Of ends that are left out and of which nothing is told: those that do not repeat the rows that are selected tell
// nothing by their bends. True if some do. Leaves the factor of the selection.
template <class S>
bool some_repeat_others(System<S>& system) {
  using T = typename S::Scalar;
  const int redundant = system.factor();
  bool any = false;
  each_held_end(system, [&](int row, Batch<S>& batch, int i) {
    if (batch.impulse[i] != T(nothing)) return;
    system.fixed[row] = System<S>::free;
    const bool repeats = system.factor() > redundant;
    system.fixed[row] = System<S>::at_lower;
    if (!repeats) batch.impulse[i] = T(closes);
    any |= repeats;
  });
  if (any) system.factor();
  return any;
}

template <class S>
void swap_rates(WorldData<S>& world, const Island<S>& island) {
  for (int i : island.bodies) std::swap(world.bodies.velocity[i], world.bodies.velocity_rate[i]);
}

}  // namespace

template <class S>
bool let_go_of_slackening_ends(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  if (!island.solver->exact || redundant_rows(system) == 0) return false;
  int ends = 0;
  each_held_end(system, [&](int row, Batch<S>& batch, int i) {
    system.fixed[row] = System<S>::at_lower, batch.impulse[i] = T(nothing);
    ++ends;
  });
  if (ends == 0) return false;
  if (some_repeat_others(system)) {
    swap_rates(world, island), look_along(world, island, time), swap_rates(world, island);
    look_along(world, island, time);
    wander(world, island);
    if (some_repeat_others(system)) look_along(world, island, time);
    each_held_end(system, [&](int, Batch<S>& batch, int i) {
      if (batch.impulse[i] == T(opens)) batch.mode[i] = Mode::off, batch.lower[i] = batch.upper[i] = 0;
    });
  }
  return true;
}

#define CDOT_INSTANTIATE(S) template bool let_go_of_slackening_ends(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
