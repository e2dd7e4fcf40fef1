#include "runtime/events/slackening.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/loads.hpp"
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

// v'Mv of the motion with v = dv/dt.
template <class S>
double twice_energy(const WorldData<S>& world, const Island<S>& island) {
  const auto& v = world.bodies.velocity_rate;
  double sum = 0;
  for (int i : island.bodies) sum += S::dot(S::force(world.bodies.inverse_mass[i], v[i]), v[i]);
  return sum;
}

// True if the joints, and the ends that are not left out, allow the motion with v = dv/dt: round-off, as at rest, is
// none. By Cauchy and Schwarz, |J_r v| <= sqrt(K_rr v'Mv).
template <class S>
bool is_allowed_motion(const WorldData<S>& world, Island<S>& island) {
  const auto& motion = world.bodies.velocity_rate;
  System<S>& system = island.at_work();
  const double energy = twice_energy(world, island);
  for (const auto& [batch, begin, end, whole] : island.segments)
    batch->ops->velocity(*batch, begin, end, motion.data(), batch->rate.data());
  bool allowed = energy > 0;
  const double most = std::pow(double(noticed<typename S::Scalar>), 2) * energy;
  const auto look = [&](int row, const Batch<S>& batch, int i) {
    if (batch.explicit_time() || system.fixed[row] || system.broken[row]) return;
    allowed = allowed && double(batch.rate[i]) * double(batch.rate[i]) <= most * double(system.diagonal(row));
  };
  system.each_row([&](int row, const Batch<S>& batch, int i) {
    if (!batch.law) look(row, batch, i);
  });
  each_held_end(system, look);
  return allowed;
}

// True if the end opens, rather than closes, where d2C/dt2 has the sign of `bend`.
template <class S>
bool opens_by(const Batch<S>& batch, int i, double bend) {
  return (bend > 0) == (guard_of(batch, i).lower == typename S::Scalar(0));
}

// Asks the motion with v = dv/dt about the ends of which nothing is told.
template <class S>
void look_along(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  if (!is_allowed_motion(world, island)) return;
  System<S>& system = island.at_work();
  const double least = double(noticed<T>) * find_bends(world, island, time);
  each_held_end(system, [&](int row, Batch<S>& batch, int i) {
    if (batch.impulse[i] != T(nothing)) return;
    const double bend = bend_beside_others(system, row);
    if (std::abs(bend) > least) batch.impulse[i] = T(opens_by(batch, i, bend) ? opens : closes);
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

template <class S>
void leave_out_ends(System<S>& system) {
  each_held_end(system, [&](int row, Batch<S>&, int) { system.fixed[row] = System<S>::at_lower; });
}

// The row goes on with the force at its upper or its lower bound: an end without one, friction that slips.
template <class S>
void let_go(System<S>& system, int row, Batch<S>& batch, int i, bool up) {
  system.fixed[row] = System<S>::at_lower;
  batch.mode[i] = guard_of(batch, i).one_sided() ? Mode::off : up ? Mode::pushed : Mode::pulled;
}

// Offers the rows that let go their bounds without a load.
template <class S>
void bound_rows_that_let_go(Island<S>& island) {
  unload(island);
  each_guarded_slot(island, [](Batch<S>& batch, int slot) {
    for (int i = slot * batch.ops->rows; i < (slot + 1) * batch.ops->rows && batch.law->cone_rows == 0; ++i) {
      if (batch.mode[i] == Mode::off) batch.lower[i] = batch.upper[i] = 0;
      if (batch.mode[i] != Mode::pushed && batch.mode[i] != Mode::pulled) continue;
      batch.load[i] = 0;
      const auto guard = guard_of(batch, i);
      if (!guard.bilateral())
        batch.lower[i] = batch.upper[i] = batch.mode[i] == Mode::pushed ? guard.upper : guard.lower;
    }
  });
}

// lambda = z with z_dropped = 1 and sum_r z_r J_r = 0: forces along z move nothing.
template <class S>
void find_null_vector(System<S>& system, int dropped) {
  const auto rows = static_cast<size_t>(system.rows());
  std::fill_n(system.b.begin(), rows, 0);
  system.b[dropped] = 1;
  system.multiply(system.b.data(), system.lambda.data());
  for (size_t r = 0; r < rows; ++r) system.lambda[r] = system.fixed[r] || system.broken[r] ? 0 : -system.lambda[r];
  system.solve_factored(system.lambda.data());
  system.lambda[dropped] = 1;
}

// f(row, batch, i) for the held rows whose force has a bound.
template <class S, class F>
void each_bounded_row(System<S>& system, F f) {
  system.each_row([&](int row, Batch<S>& batch, int i) {
    if (!batch.law || !batch.law->guard || batch.law->cone_rows > 0) return;
    if (batch.mode[i] != Mode::held || system.broken[row]) return;
    if (!(std::isinf(batch.lower[i]) && std::isinf(batch.upper[i]))) f(row, batch, i);
  });
}

// Selects the rows that the solution holds, or that reached a bound without a motion: how the solver shared the load
// led there. True if some of them are redundant.
template <class S>
bool choose_resting_rows(System<S>& system) {
  bool bounded = false, at_bounds = false;
  system.find_excess();
  each_bounded_row(system, [&](int row, Batch<S>& batch, int i) {
    const bool rests = system.fixed[row] && batch.lower[i] < batch.upper[i] && system.has_rate(row);
    if (rests) system.fixed[row] = System<S>::free;
    bounded = true, at_bounds |= rests;
  });
  return bounded && (redundant_rows(system) > 0 || at_bounds) && system.factor() > 0;
}

// Shifts the forces along z = lambda, downhill in sum_r lambda_r d2C_r/dt2, until a row reaches a bound: that lets go.
// False if none ever does.
template <class S>
bool shift_to_first_bound(System<S>& system, double downhill) {
  using T = typename S::Scalar;
  double largest = 0, way = std::numeric_limits<double>::infinity();
  for (int r = 0; r < system.rows(); ++r)
    largest = std::max(largest, std::abs(double(system.lambda[r])) * std::sqrt(double(system.diagonal(r))));
  const auto way_of = [&](int row, const Batch<S>& batch, int i) {
    const double by = downhill * double(system.lambda[row]), part = std::abs(by) * std::sqrt(system.diagonal(row));
    if (!(part > double(noticed<T>) * largest)) return std::numeric_limits<double>::infinity();
    return std::max(
        0.0, double(by > 0 ? batch.upper[i] - batch.lambda[i] : batch.lambda[i] - batch.lower[i]) / std::abs(by));
  };
  each_bounded_row(system, [&](int row, Batch<S>& batch, int i) {
    if (!system.fixed[row]) way = std::min(way, way_of(row, batch, i));
  });
  if (std::isinf(way)) return false;
  bool found = false;
  each_bounded_row(system, [&](int row, Batch<S>& batch, int i) {
    if (system.fixed[row]) return;
    const bool first = !std::exchange(found, found || way_of(row, batch, i) <= way) && found;
    const double by = downhill * double(system.lambda[row]);
    batch.lambda[i] += T(way * by);
    if (first) let_go(system, row, batch, i, by > 0);
  });
  return found;
}

// True if dv/dt is a motion, beside which that of the velocities bends no row by what accelerations would tell.
template <class S>
bool begins_to_move(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  System<S>& system = island.at_work();
  if (!is_allowed_motion(world, island)) return false;
  swap_rates(world, island), find_bends(world, island, time), swap_rates(world, island);
  const double energy = twice_energy(world, island);
  for (int r = 0; r < system.rows(); ++r) {
    const double told = double(slight<typename S::Scalar>) * std::sqrt(double(system.diagonal(r)) * energy);
    if (!system.broken[r] && std::abs(double(system.b[r])) > told) return false;
  }
  return true;
}

// Rows that repeat each other share a load as they like. The motion with v = dv/dt bends them apart: of all forces that
// lead to it, those with the least sum_r lambda_r d2C_r/dt2 hold it, as virtual work tells. True if a row lets go.
template <class S>
bool let_go_of_one(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  System<S>& system = island.at_work();
  if (system.factor() == 0) return false;
  const double least = double(noticed<typename S::Scalar>) * find_bends(world, island, time);
  for (int row = 0; row < system.rows(); ++row) {
    if (system.fixed[row] || system.broken[row] || !system.dependent(row)) continue;
    const double bend = bend_beside_others(system, row);
    if (!(std::abs(bend) > least)) continue;
    find_null_vector(system, row);
    if (shift_to_first_bound(system, bend > 0 ? -1 : 1)) return true;
    find_bends(world, island, time);
  }
  return false;
}

// True if rows let go that repeated others, as the motion begins.
template <class S>
bool let_go_of_shared_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  if (!choose_resting_rows(island.at_work()) || !begins_to_move(world, island, time)) return false;
  bool any = false;
  while (let_go_of_one(world, island, time)) any = true;
  return any;
}

// True if it has looked for ends that repeat joints. Those that open let go.
template <class S>
bool let_go_of_ends_beside_joints(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  System<S>& system = island.at_work();
  bool any = false;
  each_held_end(system, [&](int, Batch<S>& batch, int i) { batch.impulse[i] = T(nothing), any = true; });
  if (!any) return false;
  leave_out_ends(system);
  if (!some_repeat_others(system)) return true;
  swap_rates(world, island), look_along(world, island, time), swap_rates(world, island);
  look_along(world, island, time);
  wander(world, island);
  if (some_repeat_others(system)) look_along(world, island, time);
  each_held_end(system, [&](int row, Batch<S>& batch, int i) {
    if (batch.impulse[i] == T(opens)) let_go(system, row, batch, i, false);
  });
  return true;
}

}  // namespace

template <class S>
bool let_go_of_slackening_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  if (!island.solver->exact) return false;
  const bool redundant = redundant_rows(island.at_work()) > 0;
  const bool shared = let_go_of_shared_rows(world, island, time);
  const bool any = (redundant && let_go_of_ends_beside_joints(world, island, time)) || shared;
  if (any) bound_rows_that_let_go(island);
  return any;
}

#define CDOT_INSTANTIATE(S) template bool let_go_of_slackening_rows(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
