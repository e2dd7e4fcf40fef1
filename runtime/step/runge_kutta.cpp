#include "runtime/step/runge_kutta.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/events/events.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/collocation.hpp"
#include "runtime/step/leaps.hpp"
#include "runtime/step/rank_loss.hpp"

namespace cdot {
namespace {

template <class S>
typename S::Scalar* read_rates(const WorldData<S>& world, Island<S>& island, int stage) {
  typename S::Scalar* to = island.flow.rates.data() + static_cast<size_t>(stage) * island.flow.now.size();
  for (int i : island.bodies) {
    S::write_rate(world.bodies.pose[i], world.bodies.velocity[i], to);
    S::write(world.bodies.velocity_rate[i], to + S::pose_numbers);
    to += numbers_per_body<S>;
  }
  return to;
}

// The same, and the power at the end of these rates.
template <class S>
void read_rates(WorldData<S>& world, Island<S>& island, int stage, typename S::Scalar time) {
  auto* const power = read_rates(world, island, stage);
  const size_t count = island.flow.work.size();
  if (count == 0) return;
  if (works_now(world, island)) find_power(world, island, time, power);
  else std::fill_n(power, count, typename S::Scalar(0));
}

// sum_j weights_j rows_j of rows of T, in A. Registers hold some neighbours at a time, each summed in the order of j.
template <class A, class T>
class WeightedSum {
 public:
  void add(A weight, const T* row) {
    if (weight == 0) return;
    weights_[count_] = weight;
    rows_[count_++] = row;
  }
  bool empty() const { return count_ == 0; }

  // f(k, sum) for k = 0 .. n - 1
  template <class F>
  void each(size_t n, F f) const {
    size_t k = 0;
    for (; k + lanes <= n; k += lanes) neighbours<lanes>(k, f);
    for (; k < n; ++k) neighbours<1>(k, f);
  }

 private:
  static constexpr size_t lanes = 4;

  template <size_t count, class F>
  void neighbours(size_t k, F& f) const {
    A sums[count] = {};
    for (int j = 0; j < count_; ++j) {
      const T* const row = rows_[j] + k;
      for (size_t i = 0; i < count; ++i) sums[i] += weights_[j] * A(row[i]);
    }
    for (size_t i = 0; i < count; ++i) f(k + i, sums[i]);
  }

  A weights_[most_stages];
  const T* rows_[most_stages];
  int count_ = 0;
};

// now = start + h sum_j weights_j rates_j, of the first `numbers`.
template <class S>
void combine(Flow<S>& flow, const ExactNumber<typename S::Scalar>* weights, int count, typename S::Scalar h,
             size_t numbers) {
  using T = typename S::Scalar;
  const size_t n = flow.start.size();
  WeightedSum<T, T> sum;
  for (int j = 0; j < count; ++j) sum.add(T(weights[j]), flow.rates.data() + static_cast<size_t>(j) * n);
  const T* const start = flow.start.data();
  T* const now = flow.now.data();
  sum.each(numbers, [&](size_t k, T rate) { now[k] = start[k] + h * rate; });
}

// The largest of an embedded estimate, number by number in units of unit(k).
template <class S, class F>
double largest_error(const Flow<S>& flow, const RungeKuttaOf<S>& method, int estimate, typename S::Scalar h, F unit) {
  const size_t n = flow.now.size();
  const size_t of_bodies = n - flow.work.size();
  WeightedSum<double, typename S::Scalar> sum;
  for (int j = 0; j <= method.stages; ++j)
    sum.add(method.error[estimate][j], flow.rates.data() + static_cast<size_t>(j) * n);
  double worst = 0;
  if (sum.empty()) return worst;
  sum.each(of_bodies, [&](size_t k, double rate) {
    const double error = std::abs(double(h) * rate) / unit(k);
    if (!(error <= worst)) worst = error;
  });
  return worst;
}

template <class S, class F>
double largest_error_of_collocation(const Flow<S>& flow, F unit) {
  double worst = 0;
  for (size_t k = 0; k < flow.now.size() - flow.work.size(); ++k) {
    const double error = std::abs(double(flow.collocation.error[k])) / unit(k);
    if (!(error <= worst)) worst = error;
  }
  return worst;
}

// Combines both estimates. The squares of smaller ones underflow.
template <class S, class F>
double estimated_error(Flow<S>& flow, const RungeKuttaOf<S>& method, typename S::Scalar h, F unit) {
  if (method.implicit) return largest_error_of_collocation(flow, unit);
  const double first = largest_error(flow, method, 0, h, unit), second = largest_error(flow, method, 1, h, unit);
  flow.alike = second < 1e-100 ? 0.0f : static_cast<float>(first / second);
  if (second < 1e-100) return first;
  return first * first / std::sqrt(first * first + 0.01 * second * second);
}

}  // namespace

template <class S>
void read_numbers(const WorldData<S>& world, const Island<S>& island, typename S::Scalar* to) {
  for (int i : island.bodies) {
    S::write(world.bodies.pose[i], to);
    S::write(world.bodies.velocity[i], to + S::pose_numbers);
    to += numbers_per_body<S>;
  }
  std::copy(island.flow.work.begin(), island.flow.work.end(), to);
}

template <class S>
void set_numbers(WorldData<S>& world, Island<S>& island, const typename S::Scalar* from) {
  for (int i : island.bodies) {
    world.bodies.pose[i] = S::read(from);
    world.bodies.velocity[i] = S::read_velocity(from + S::pose_numbers);
    from += numbers_per_body<S>;
  }
  std::copy_n(from, island.flow.work.size(), island.flow.work.begin());
}

template <class S>
void evaluate_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                    typename S::Scalar at) {
  set_numbers(world, island, island.flow.now.data());
  if (island.flow.projects_stages) {
    project(world, island, at, true);
  } else {
    evaluate_anew(world, island, at);
    island.factored = false;
    accelerate(world, island, at);
  }
  note_stage(world, island, method, stage, at);
}

template <class S>
void note_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                typename S::Scalar at) {
  read_rates(world, island, stage, at);
  if (stage < method.stages) note_pivots(island, stage);
}

template <class S>
void take_stage(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, int stage,
                typename S::Scalar time, typename S::Scalar h) {
  Flow<S>& flow = island.flow;
  combine(flow, method.a[stage], stage, h, flow.now.size() - flow.work.size());  // no stage asks for work
  evaluate_stage(world, island, method, stage, time + typename S::Scalar(method.c[stage]) * h);
}

template <class S>
bool take_stages(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                 typename S::Scalar h) {
  if (method.implicit) return collocate(world, island, method, time, h);
  for (int stage = 1; stage < method.stages; ++stage) {
    take_stage(world, island, method, stage, time, h);
    if (world.settings.local_error > 0)
      note_forces(world, island, stage, time + typename S::Scalar(method.c[stage]) * h, double(method.c[stage]));
  }
  combine(island.flow, method.a[method.stages], method.stages, h, island.flow.now.size());
  set_numbers(world, island, island.flow.now.data());
  return true;
}

template <class S>
void project(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  const bool projects = world.settings.drift == Drift::projection && !island.segments.empty();
  for (int i : island.bodies) world.bodies.displacement[i] = {};
  if (projects) island.solver->positions(world, island, time, fresh);
  evaluate_anew(world, island, time);
  island.factored = false;
  if (projects) {
    project_velocities(world, island);
    if constexpr (S::has_gyroscopes) set_inertias(world, island);
  }
  note_rates(world, island);
  accelerate(world, island, time);
}

template <class S>
void project_end(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time) {
  project(world, island, time, false);
  measure_margins(world, island, time);
  read_rates(world, island, method.stages, time);
}

template <class S>
double error_of_step(Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h, double allowed) {
  constexpr double epsilon = std::numeric_limits<typename S::Scalar>::epsilon();
  return estimated_error(island.flow, method, h,
                         [&](size_t k) {
                           const double size = std::abs(double(island.flow.start[k]));
                           const bool velocity = k % numbers_per_body<S> >= S::pose_numbers;
                           return std::max(velocity ? 1 + size : 1.0, epsilon * size / allowed);
                         }) /
         allowed;
}

template <class S>
double share_of_size(Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar h) {
  return estimated_error(island.flow, method, h, [&](size_t k) {
    const int number = static_cast<int>(k % numbers_per_body<S>), of_velocity = number - S::pose_numbers;
    const bool velocity = of_velocity >= 0;
    const double size = (velocity ? of_velocity : number) < S::lengths ? double(island.size) : 1.0;
    return velocity ? size + std::abs(double(island.flow.start[k])) : size;
  });
}

template <class S>
void prepare_runge_kutta(Island<S>& island, const RungeKuttaOf<S>& method) {
  Flow<S>& flow = island.flow;
  const size_t n = island.bodies.size() * numbers_per_body<S> + flow.work.size();
  flow.start.assign(n, 0);
  flow.now.assign(n, 0);
  flow.start_left.assign(island.left.size(), 0);
  flow.rates.assign(n * static_cast<size_t>(method.stages + 1 + method.further_stages), 0);
  flow.end.assign(n, 0);
  flow.further_terms.assign(n * static_cast<size_t>(method.further_terms), 0);
  size_t rows = 0;
  for (const Segment<S>& segment : island.segments)
    rows += static_cast<size_t>((segment.end - segment.begin) * segment.batch->ops->rows);
  flow.end_forces.assign(rows, 0);
  if (method.implicit) prepare_collocation(island);
  count_guarded_rows(island);
  flow.at_stages.assign(flow.ways.size() * most_stages, 0);
  prepare_rank_loss(island, method);
}

// The last step has found the power at its end. J may be older, for example after a rollback.
template <class S>
void keep_start(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                bool goes_on) {
  Flow<S>& flow = island.flow;
  book_work(world, island);
  read_numbers(world, island, flow.start.data());
  if (goes_on) {
    const auto last = flow.rates.begin() + (method.stages + 1) * static_cast<std::ptrdiff_t>(flow.now.size());
    std::copy(last - static_cast<std::ptrdiff_t>(flow.work.size()), last, read_rates(world, island, 0));
  } else {
    read_rates(world, island, 0, time);
  }
  if (method.implicit) begin_collocation(island, goes_on);
  flow.start_residual = island.residual;
  flow.start_left.assign(island.left.begin(), island.left.end());
  keep_turns(island);
}

template <class S>
void go_back(WorldData<S>& world, Island<S>& island) {
  set_numbers(world, island, island.flow.start.data());
  island.residual = island.flow.start_residual;
  island.left = island.flow.start_left;
  restore_turns(island);
  halt_immovable_bodies(world, island);
}

template <class S>
void reject_step(WorldData<S>& world, Island<S>& island) {
  ++world.counts->rejected;
  go_back(world, island);
  if (!island.solver->exact || !island.loads.empty()) fill_lambda(island, typename S::Scalar(0));
}

#define CDOT_INSTANTIATE(S)                                                                               \
  template void read_numbers(const WorldData<S>&, const Island<S>&, S::Scalar*);                          \
  template void set_numbers(WorldData<S>&, Island<S>&, const S::Scalar*);                                 \
  template void evaluate_stage(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, int, S::Scalar);        \
  template void note_stage(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, int, S::Scalar);            \
  template void take_stage(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, int, S::Scalar, S::Scalar); \
  template void project(WorldData<S>&, Island<S>&, S::Scalar, bool);                                      \
  template void prepare_runge_kutta(Island<S>&, const RungeKuttaOf<S>&);                                  \
  template void keep_start(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, bool);           \
  template void go_back(WorldData<S>&, Island<S>&);                                                       \
  template void reject_step(WorldData<S>&, Island<S>&);                                                   \
  template bool take_stages(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar, S::Scalar);     \
  template void project_end(WorldData<S>&, Island<S>&, const RungeKuttaOf<S>&, S::Scalar);                \
  template double error_of_step(Island<S>&, const RungeKuttaOf<S>&, S::Scalar, double);                   \
  template double share_of_size(Island<S>&, const RungeKuttaOf<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
