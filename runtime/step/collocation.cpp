#include "runtime/step/collocation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

constexpr int stages = 3;
constexpr size_t most_unknowns = 600;  // velocity components of an island
constexpr int most_rounds = 10, most_exact_rounds = 25;
// Share of the local error that Newton may leave: min(tightest, sqrt(local error)).
constexpr double tightest = 0.03;
// The same with fixed steps, and the least with others, in units of Island::size, rad, and their rates.
template <class T>
constexpr double settled = by_precision<T>(1e-6, 1e-14);
constexpr double first_round = 0.1;  // share of the goal that the first round must meet, whose rate is unknown
constexpr double slowest = 0.99;     // share of a change that the next round may make
constexpr double stalls = 0.5;       // the same, where round-off may be the cause
// Round-off may stop Newton before its goal. This many times `settled` is still small.
constexpr double nearly = 1e4;
constexpr double furthest_guess = 2;  // in lengths of the last step

template <class S>
size_t numbers_of_bodies(const Flow<S>& flow) {
  return flow.now.size() - flow.work.size();
}

// Newton's goal in units of the numbers. Rows with events take what it leaves for a way: in a step behind an impact, a
// body would pass an end that it leaves. A stiff force with limits is within them only in a narrow band of rates.
template <class S>
double goal_of(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  const double allowed = world.settings.local_error;
  double goal = allowed * std::min(tightest, std::sqrt(allowed));
  if (!island.flow.collocation.base_within.empty()) return settled<T>;
  if (island.flow.guarded > 0) goal = std::min(goal, double(slight<T>) * std::min(1.0, double(island.size)));
  return std::max(goal, settled<T>);
}

// The unit of number k; a goal below its last bits is none.
template <class S>
double unit_of(const WorldData<S>& world, const Island<S>& island, size_t k) {
  constexpr double last_bits = 4 * std::numeric_limits<typename S::Scalar>::epsilon();
  const double size = std::abs(double(island.flow.start[k]));
  const int number = static_cast<int>(k % numbers_per_body<S>), of_velocity = number - S::pose_numbers;
  const bool velocity = of_velocity >= 0, length = (velocity ? of_velocity : number) < S::lengths;
  const double unit = world.settings.local_error > 0 || !length ? 1.0 : double(island.size);
  return std::max(velocity ? unit + size : unit, last_bits / goal_of(world, island) * size);
}

// z_i = h_old int_1^(1 + c_i h / h_old) k of the last step's polynomial; otherwise 0.
template <class S>
void guess_increments(Flow<S>& flow, const RungeKuttaOf<S>& method, typename S::Scalar h) {
  using T = typename S::Scalar;
  CollocationWorkspace<T>& work = flow.collocation;
  const size_t n = flow.now.size();
  const T share = work.foresees ? h / flow.length : T(0);
  for (int i = 0; i < stages; ++i) {
    const T s = share <= T(furthest_guess) ? T(method.c[i + 1]) * share : T(0);
    T* z = work.increments.data() + static_cast<size_t>(i) * n;
    for (size_t k = 0; k < n; ++k) z[k] = s * (work.slopes[k] + s * (work.slopes[n + k] + s * work.slopes[2 * n + k]));
  }
}

// The k of a stage with the forces taken for it, and the forces of their laws.
template <class S>
void evaluate_with_forces(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                          typename S::Scalar at) {
  auto& work = island.flow.collocation;
  const size_t first = static_cast<size_t>(stage - 1) * work.base_forces.size();
  if (island.flow.projects_stages) {
    evaluate_stage(world, island, method, stage, at);
    each_known_force(island, [&](const Batch<S>& batch, int i, size_t row) {
      work.forces[first + row] = work.laws[first + row] = batch.lower[i];
    });
    return;
  }
  set_numbers(world, island, island.flow.now.data());
  evaluate_anew(world, island, at);
  island.factored = false;
  ask_for_gamma(world, island, at);
  each_known_force(island, [&](Batch<S>& batch, int i, size_t row) {
    work.laws[first + row] = batch.lower[i];
    batch.lower[i] = batch.upper[i] = work.forces[first + row];
  });
  island.solver->accelerations(world, island);
  note_stage(world, island, method, stage, at);
}

// The k of the stages at the present increments and forces.
template <class S>
void evaluate_stages(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                     typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const size_t n = flow.now.size();
  for (int i = 0; i < stages; ++i) {
    const T* z = flow.collocation.increments.data() + static_cast<size_t>(i) * n;
    for (size_t k = 0; k < n; ++k) flow.now[k] = flow.start[k] + z[k];
    evaluate_with_forces(world, island, method, i + 1, time + T(method.c[i + 1]) * h);
  }
}

// Adds da/dF (law(y) - F) to the k of the stages.
template <class S>
void add_missing_forces(Flow<S>& flow) {
  using T = typename S::Scalar;
  const CollocationWorkspace<T>& work = flow.collocation;
  const size_t rows = work.base_forces.size(), m = work.base.size(), n = flow.now.size();
  for (size_t i = 0; i < stages; ++i)
    for (size_t k = 0; k < m && rows > 0; ++k) {
      double sum = 0;
      for (size_t row = 0; row < rows; ++row)
        sum += work.by_force[k * rows + row] * double(work.laws[i * rows + row] - work.forces[i * rows + row]);
      flow.rates[(i + 1) * n + index_of_velocity<S>(k)] += T(sum);
    }
}

// F = law(y) + dlaw/dy dy
template <class S>
void take_forces(Flow<S>& flow) {
  using T = typename S::Scalar;
  CollocationWorkspace<T>& work = flow.collocation;
  const size_t rows = work.base_forces.size(), m = work.base.size(), n = flow.now.size();
  for (size_t i = 0; i < stages && rows > 0; ++i) {
    const T* change = work.changes.data() + i * n;
    for (size_t k = 0; k < work.real_side.size(); ++k) work.real_side[k] = double(change[k]);
    turn_back<S>(work.turns, work.real_side, work.real_turned);
    for (size_t row = 0; row < rows; ++row) {
      double sum = 0;
      for (size_t k = 0; k < m; ++k)
        sum += work.force_by_pose[row * m + k] * work.real_turned[k] +
               work.force_by_velocity[row * m + k] * work.real_side[index_of_velocity<S>(k)];
      work.forces[i * rows + row] = work.laws[i * rows + row] + T(sum);
    }
  }
}

// sum_j (A^-1)_ij z_j / h
template <class S>
typename S::Scalar slope_at(const Flow<S>& flow, int stage, size_t k, typename S::Scalar h) {
  using T = typename S::Scalar;
  const size_t n = flow.now.size();
  const T* z = flow.collocation.increments.data();
  const auto& row = radau_inverse<ExactNumber<T>>[stage];
  return (T(row[0]) * z[k] + T(row[1]) * z[n + k] + T(row[2]) * z[2 * n + k]) / h;
}

// One round: the changes of z from what the present k lack.
template <class S>
void improve(Flow<S>& flow, typename S::Scalar h) {
  using T = typename S::Scalar;
  constexpr const RadauTransformation& by = radau_transformation;
  CollocationWorkspace<T>& work = flow.collocation;
  const size_t n = flow.now.size(), count = work.real_side.size();
  for (size_t k = 0; k < count; ++k) {
    double lack[stages], w[stages] = {};
    for (int i = 0; i < stages; ++i)
      lack[i] = double(flow.rates[static_cast<size_t>(i + 1) * n + k] - slope_at(flow, i, k, h));
    for (int i = 0; i < stages; ++i)
      for (int j = 0; j < stages; ++j) w[i] += by.inverse[i][j] * lack[j];
    work.real_side[k] = w[0];
    work.complex_side[k] = {w[1], w[2]};
  }
  const double per_time = 1 / double(h);
  solve_shifted<S>(work, work.real, by.real * per_time, work.real_side, work.real_turned);
  solve_shifted<S>(work, work.complex, Complex{by.alpha * per_time, by.beta * per_time}, work.complex_side,
                   work.complex_turned);
  for (int i = 0; i < stages; ++i)
    for (size_t k = 0; k < count; ++k)
      work.changes[static_cast<size_t>(i) * n + k] = T(
          by.T[i][0] * work.real_side[k] + by.T[i][1] * work.complex_side[k].re + by.T[i][2] * work.complex_side[k].im);
}

// Adds the changes to z. Returns the largest in its unit.
template <class S>
double take_changes(const WorldData<S>& world, Island<S>& island) {
  CollocationWorkspace<typename S::Scalar>& work = island.flow.collocation;
  const size_t n = island.flow.now.size(), count = numbers_of_bodies(island.flow);
  double worst = 0;
  for (size_t k = 0; k < count; ++k) {
    double change = 0;
    for (size_t i = 0; i < stages; ++i) {
      work.increments[i * n + k] += work.changes[i * n + k];
      const double size = std::abs(double(work.changes[i * n + k]));
      if (!(size <= change)) change = size;
    }
    change /= unit_of(world, island, k);
    if (!(change <= worst)) worst = change;
  }
  return worst;
}

template <class S>
bool find_increments(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                     typename S::Scalar h) {
  const int most = world.settings.local_error > 0 ? most_rounds : most_exact_rounds;
  const double goal = goal_of(world, island), near = nearly * settled<typename S::Scalar>;
  double before = 0;
  for (int round = 0; round < most; ++round) {
    evaluate_stages(world, island, method, time, h);
    add_missing_forces(island.flow);
    improve(island.flow, h);
    const double change = take_changes(world, island);
    take_forces(island.flow);
    if (!std::isfinite(change)) return false;
    const double rate = change / before;  // of convergence
    // All that the next rounds would change.
    if (round == 0 ? change <= first_round * goal : change * rate <= (1 - rate) * goal) return true;
    if (round > 0 && rate > stalls && change <= near) return true;
    if (round > 2 && rate >= slowest) return false;
    before = change;
  }
  return false;
}

// The k of bodies come from the increments: the stiff ones are exact to round-off, which f(y + z) is not.
template <class S>
void take_slopes(Flow<S>& flow, typename S::Scalar h) {
  const size_t n = flow.now.size(), count = numbers_of_bodies(flow);
  for (int i = 0; i < stages; ++i)
    for (size_t k = 0; k < count; ++k) flow.rates[static_cast<size_t>(i + 1) * n + k] = slope_at(flow, i, k, h);
}

template <class S>
void set_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  const size_t n = flow.now.size(), count = numbers_of_bodies(flow);
  for (size_t k = 0; k < count; ++k) flow.now[k] = flow.start[k] + flow.collocation.increments[2 * n + k];
  for (size_t k = count; k < n; ++k) {
    flow.now[k] = flow.start[k];
    for (size_t i = 1; i <= stages; ++i) flow.now[k] += h * T(method.a[method.stages][i]) * flow.rates[i * n + k];
  }
  set_numbers(world, island, flow.now.data());
}

// (real / h - df/dy)^-1 (slope + sum_i e_i z_i / h), with a slope at the start.
template <class S>
void estimate_error(Flow<S>& flow, const typename S::Scalar* slope, typename S::Scalar h) {
  using T = typename S::Scalar;
  CollocationWorkspace<T>& work = flow.collocation;
  const size_t n = flow.now.size(), count = numbers_of_bodies(flow);
  for (size_t k = 0; k < count; ++k) {
    double sum = 0;
    for (size_t i = 0; i < stages; ++i) sum += radau_error[i] * double(work.increments[i * n + k]);
    work.real_side[k] = double(slope[k]) + sum / double(h);
  }
  solve_shifted<S>(work, work.real, radau_transformation.real / double(h), work.real_side, work.real_turned);
  for (size_t k = 0; k < count; ++k) work.error[k] = T(work.real_side[k]);
}

}  // namespace

template <class S>
bool fits_collocation(const Island<S>& island) {
  return island.bodies.size() * S::freedom <= most_unknowns;
}

template <class S>
void prepare_collocation(Island<S>& island) {
  CollocationWorkspace<typename S::Scalar>& work = island.flow.collocation;
  if (!fits_collocation(island)) return;
  const size_t m = island.bodies.size() * S::freedom, n = island.flow.now.size(),
               count = island.bodies.size() * numbers_per_body<S>;
  work.by_pose.assign(m * m, 0.0), work.by_velocity.assign(m * m, 0.0);
  work.turns.assign(m * S::pose_numbers, 0.0);
  work.real.reserve(m), work.complex.reserve(m);
  work.real_side.assign(count, 0.0), work.real_turned.assign(m, 0.0);
  work.complex_side.assign(count, {}), work.complex_turned.assign(m, {});
  for (auto* numbers : {&work.increments, &work.changes, &work.slopes}) numbers->assign(stages * n, 0);
  work.error.assign(n, 0);
  size_t rows = 0;
  bool limited = false;
  each_known_force(island, [&](const Batch<S>& batch, int, size_t) {
    ++rows;
    limited |= batch.law->within_limits != nullptr;
  });
  work.base.assign(m, 0.0), work.base_forces.assign(rows, 0.0), work.base_within.assign(limited ? rows : 0, 1);
  for (auto* matrix : {&work.by_force, &work.force_by_pose, &work.force_by_velocity}) matrix->assign(m * rows, 0.0);
  work.forces.assign(stages * rows, 0), work.laws.assign(stages * rows, 0);
}

// k(theta) = k_3 + (theta - 1) d + (theta - 1) (theta - c_2) e through the stages, integrated from 1 on.
template <class S>
void begin_collocation(Island<S>& island, bool goes_on) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  CollocationWorkspace<T>& work = flow.collocation;
  work.differentiated = false;
  work.foresees = goes_on && flow.length > T(0);
  if (!work.foresees) return;
  constexpr const auto& c = radau5<ExactNumber<T>>.c;
  const size_t n = flow.now.size();
  const T *k = flow.rates.data() + n, h = flow.length, c1 = T(c[1]), c2 = T(c[2]);
  for (size_t i = 0; i < numbers_of_bodies(flow); ++i) {
    const T d = (k[2 * n + i] - k[n + i]) / (1 - c2);
    const T e = (d - (k[n + i] - k[i]) / (c2 - c1)) / (1 - c1);
    work.slopes[i] = h * k[2 * n + i];
    work.slopes[n + i] = h * (d + (1 - c2) * e) / 2;
    work.slopes[2 * n + i] = h * e / 3;
  }
}

template <class S>
bool collocate(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
               typename S::Scalar h) {
  using T = typename S::Scalar;
  Flow<S>& flow = island.flow;
  CollocationWorkspace<T>& work = flow.collocation;
  std::fill(flow.pivots.begin(), flow.pivots.end(), 1.0);
  if (!work.differentiated) differentiate(world, island, time);
  const double per_time = 1 / double(h);
  constexpr const RadauTransformation& by = radau_transformation;
  if (!factor_shifted(work, by.real * per_time, work.real)) return false;
  if (!factor_shifted(work, Complex{by.alpha * per_time, by.beta * per_time}, work.complex)) return false;
  guess_increments(flow, method, h);
  for (size_t k = 0; k < work.forces.size(); ++k) work.forces[k] = T(work.base_forces[k % work.base_forces.size()]);
  if (!find_increments(world, island, method, time, h)) return false;
  take_slopes(flow, h);
  set_end(world, island, method, h);
  estimate_error(flow, flow.rates.data(), h);
  return true;
}

template <class S>
void refine_error(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                  typename S::Scalar h) {
  Flow<S>& flow = island.flow;
  const size_t n = flow.now.size();
  for (size_t k = 0; k < n; ++k) flow.now[k] = flow.start[k] + flow.collocation.error[k];
  evaluate_stage(world, island, method, method.stages, time);
  estimate_error(flow, flow.rates.data() + static_cast<size_t>(method.stages) * n, h);
  set_end(world, island, method, h);
}

#define CDOT_INSTANTIATE(S)                                                                         \
  template bool fits_collocation(const Island<S>&);                                                 \
  template void prepare_collocation(Island<S>&);                                                    \
  template void begin_collocation(Island<S>&, bool);                                                \
  template bool collocate(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar); \
  template void refine_error(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
