// Sequential impulses: a sweep solves one block after another for J v = -bias, or for C = 0.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/solve/loads.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/rivals.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

template <class S>
void renew(WorldData<S>& world, Island<S>& island) {
  island.factored = false;
  factorize_rows(world, island);
}

// Exact rows are solved block by block, in the kernels. Rows under a law are solved one by one, since each may stop at
// a bound of its own; the batch's `factor` keeps their K:
//   (K_rr + softness) change = -(J v + bias + softness lambda),  lower <= lambda + change <= upper
template <class S>
void iterate_bounded(Batch<S>& batch, int begin, int end, const Bodies<S>& all, typename S::Velocity* v) {
  using T = typename S::Scalar;
  const BlockOps<S>& ops = *batch.ops;
  const int rows = ops.rows, triangle = batch.triangle();
  const T *const softness = batch.softness.data(), *const lower = batch.lower.data(), *const upper = batch.upper.data();
  T *const Jv = batch.rate.data(), *const lambda = batch.lambda.data(), *const change = batch.impulse.data();
  for (int slot = begin; slot < end; ++slot) {
    ops.velocity(batch, slot, slot + 1, v, Jv);
    const T* const K = batch.factor.data() + slot * triangle;
    for (int r = 0, i = slot * rows; r < rows; ++r, ++i) {
      const T b = -(Jv[i] + batch.bias[i] + softness[i] * lambda[i]);
      const T wanted = lambda[i] + b * inverse(K[r * (r + 1) / 2 + r] + softness[i]);
      const T after = std::clamp(wanted, lower[i], upper[i]);
      change[i] = after - lambda[i];
      lambda[i] = after;
      for (int s = r + 1; s < rows; ++s) Jv[slot * rows + s] += K[s * (s + 1) / 2 + r] * change[i];
    }
    ops.apply(batch, slot, slot + 1, all, change, v);
  }
}

// The same for poses, and for the part of C that the law calls an error.
template <class S>
void correct_bounded(Batch<S>& batch, int begin, int end, Bodies<S>& all, typename S::Scalar time) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  for (int slot = begin; slot < end; ++slot) {
    batch.ops->position(batch, slot, slot + 1, all, time);
    T error[most_rows], lambda[most_rows];
    batch.law->error(batch, slot, error);
    const T* const K = batch.factor.data() + slot * batch.triangle();
    for (int r = 0; r < rows; ++r) {
      lambda[r] = -error[r] * inverse(K[r * (r + 1) / 2 + r]);
      for (int s = r + 1; s < rows; ++s) error[s] += K[s * (s + 1) / 2 + r] * lambda[r];
    }
    batch.ops->displace(batch, slot, all, lambda);
  }
}

template <class S>
void warm_start(WorldData<S>& world, Island<S>& island, typename S::Velocity* v, typename S::Scalar share) {
  using T = typename S::Scalar;
  const bool warm = world.settings.warm_start;
  if (!warm) share = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    T* const lambda = batch.lambda.data();
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) lambda[i] *= share;
    if (warm) batch.ops->apply(batch, segment.begin, segment.end, world.bodies, batch.lambda.data(), v);
  }
}

// Bounds follow the loads and the slip of the sweep before.
template <class S>
void follow_loads(Island<S>& island, const typename S::Velocity* v) {
  if (island.loads.empty()) return;
  for (LoadedRow<S>& row : island.loads) row.load = row.found = carried(island, row, impulse_of_rows(island));
  find_corners(island, [v](const LoadedRow<S>& row) {
    Batch<S>& batch = *row.batch;
    const int i = row.place();
    batch.ops->velocity(batch, i, i + 1, v, batch.rate.data());
    const auto slip = batch.rate[i] + batch.bias[i] + batch.softness[i] * batch.lambda[i];
    return RowSolution<typename S::Scalar>{batch.lambda[i], slip, batch.factor[i]};
  });
  take_corners(island);
  bound_by_loads(island);
}

// Impulses that grow with the step would let the errors of sweeps grow with them.
template <class S>
void sweep_velocities(WorldData<S>& world, Island<S>& island, typename S::Velocity* v, typename S::Scalar share) {
  warm_start(world, island, v, std::min(typename S::Scalar(1), share));
  begin_loads(world, island);
  start_loads(island, impulse_of_rows(island));
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    follow_loads(island, v);
    for (const auto& [batch, begin, end, whole] : island.segments) {
      if (batch->law) iterate_bounded(*batch, begin, end, world.bodies, v);
      else batch->ops->iterate(*batch, begin, end, world.bodies, v, batch->lambda.data());
    }
  }
  if (!island.acceleration_level) count_rivals(world, island);
}

template <class S>
void sweep_softly(WorldData<S>& world, Island<S>& island, SoftSweep<typename S::Scalar> soft, bool springs) {
  auto* const v = world.bodies.velocity.data();
  begin_loads(world, island);
  start_loads(island, impulse_of_rows(island));
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    follow_loads(island, v);
    for (const auto& [batch, begin, end, whole] : island.segments) {
      if (!batch->law) batch->ops->soften(*batch, begin, end, world.bodies, v, batch->lambda.data(), soft);
      else if (springs || !batch->law->force) iterate_bounded(*batch, begin, end, world.bodies, v);
    }
  }
  count_rivals(world, island);
}

template <class S>
void sweep_soft(WorldData<S>& world, Island<S>& island, SoftSweep<typename S::Scalar> soft, typename S::Scalar share) {
  warm_start(world, island, world.bodies.velocity.data(), share);
  sweep_softly(world, island, soft, true);
}

// Springs have acted over the whole step.
template <class S>
void sweep_relaxed(WorldData<S>& world, Island<S>& island) {
  sweep_softly(world, island, {}, false);
}

template <class S>
void sweep_accelerations(WorldData<S>& world, Island<S>& island) {
  factorize_rows(world, island);
  sweep_velocities(world, island, world.bodies.velocity_rate.data(), typename S::Scalar(1));
}

// The largest error found by a sweep.
template <class S>
typename S::Scalar errors_met(const Island<S>& island) {
  typename S::Scalar worst = 0;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    if (batch.law) continue;
    const int rows = batch.ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) worst = std::max(worst, std::abs(batch.C[i]));
  }
  return worst;
}

// At acceleration level only held rows are corrected: the event search must see the others pass their ends.
template <class S>
void sweep_lawful_poses(WorldData<S>& world, const Island<S>& island, const Segment<S>& segment,
                        typename S::Scalar time) {
  Batch<S>& batch = *segment.batch;
  if (!batch.law->error) return;
  if (!island.acceleration_level) return correct_bounded(batch, segment.begin, segment.end, world.bodies, time);
  for (int slot = segment.begin; slot < segment.end; ++slot) {
    const auto mode = batch.mode.begin() + slot * batch.ops->rows;
    if (std::any_of(mode, mode + batch.ops->rows, holds)) correct_bounded(batch, slot, slot + 1, world.bodies, time);
  }
}

// If a sweep finds larger errors than the last one, the step's J is out of date and is renewed.
template <class S>
void sweep_positions(WorldData<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  using T = typename S::Scalar;
  const auto renew_directions = [&] {
    evaluate_anew(world, island, time);
    factorize_rows(world, island);
  };
  if (fresh) renew_directions();
  T first = std::numeric_limits<T>::infinity();
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->correct(batch, segment.begin, segment.end, world.bodies, time);
      else sweep_lawful_poses(world, island, segment, time);
    }
    const T met = errors_met(island);
    if (sweep == 0) first = met;
    if (met > T(2) * first) {
      renew_directions();
      first = met;
    }
  }
  island.residual = find_errors(world, island, time);
}

// The bounds fix the impulse of rows that are not held.
template <class S>
void bound_for_projection(const Island<S>& island) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) {
      const bool held = holds(batch.mode[i]);
      batch.softness[i] = 0;
      batch.lower[i] = held ? -std::numeric_limits<T>::infinity() : batch.lambda[i];
      batch.upper[i] = held ? std::numeric_limits<T>::infinity() : batch.lambda[i];
    }
  }
}

template <class S>
void sweep_projection(WorldData<S>& world, Island<S>& island) {
  renew(world, island);
  auto* const v = world.bodies.velocity.data();
  if (island.acceleration_level) bound_for_projection(island);
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->iterate(batch, segment.begin, segment.end, world.bodies, v, batch.correction.data());
      else if (island.acceleration_level) iterate_bounded(batch, segment.begin, segment.end, world.bodies, v);
    }
  }
}

template <class S, class F>
void each_exact_row(const Island<S>& island, F f) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int i = begin * batch->ops->rows; !batch->law && i < end * batch->ops->rows; ++i) f(*batch, i);
}

// Batch::rate = K direction, over the exact rows; `direction` is an array of Batch.
template <class S, class Array>
void multiply(WorldData<S>& world, const Island<S>& island, Array direction) {
  auto& pushed = world.bodies.increment;
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (!batch->law) batch->ops->apply(*batch, begin, end, world.bodies, (batch->*direction).data(), pushed.data());
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (!batch->law) batch->ops->velocity(*batch, begin, end, pushed.data(), batch->rate.data());
  for (int i : island.bodies) pushed[i] = {};
}

// Sweeps load the first of redundant rows. Conjugate gradients for K shared = K lambda that start from 0 end at the
// least `shared`. Batch::bias holds their direction, Batch::error what is left.
template <class S>
void share_loads(WorldData<S>& world, Island<S>& island, StateArray<typename S::Scalar> BatchState<S>::*impulses) {
  using T = typename S::Scalar;
  constexpr int rounds = 200;
  constexpr double left_out = 1e-6;  // of K lambda, squared
  const auto square = [](T number) { return double(number) * double(number); };
  multiply(world, island, impulses);
  double left = 0;
  each_exact_row(island, [&](Batch<S>& batch, int i) {
    batch.bias[i] = batch.error[i] = batch.rate[i], batch.impulse[i] = 0;
    left += square(batch.rate[i]);
  });
  const double enough = left_out * left;
  for (int round = 0; round < rounds && left > enough; ++round) {
    multiply(world, island, &BatchWorkspace<S>::bias);
    double curvature = 0, remains = 0;
    each_exact_row(island, [&](Batch<S>& batch, int i) { curvature += double(batch.bias[i]) * double(batch.rate[i]); });
    const T step = T(left / curvature);
    each_exact_row(island, [&](Batch<S>& batch, int i) {
      batch.impulse[i] += step * batch.bias[i], batch.error[i] -= step * batch.rate[i];
      remains += square(batch.error[i]);
    });
    each_exact_row(island, [kept = T(remains / left)](Batch<S>& batch, int i) {
      batch.bias[i] = batch.error[i] + kept * batch.bias[i];
    });
    left = remains;
  }
  if (left <= enough) each_exact_row(island, [&](Batch<S>& batch, int i) { (batch.*impulses)[i] = batch.impulse[i]; });
}

template <class S>
void share_all_loads(WorldData<S>& world, Island<S>& island) {
  share_loads(world, island, &BatchState<S>::lambda);
  share_loads(world, island, &BatchState<S>::correction);
  island.evaluated = island.factored = false;
  island.flow.forget();
}

}  // namespace

template <class S>
const RowSolver<S>& iterative_solver() {
  static constexpr RowSolver<S> solver{.exact = false,
                                       .renew = renew<S>,
                                       .factor = renew<S>,
                                       .velocities = sweep_velocities<S>,
                                       .soften = sweep_soft<S>,
                                       .relax = sweep_relaxed<S>,
                                       .accelerations = sweep_accelerations<S>,
                                       .positions = sweep_positions<S>,
                                       .projection = sweep_projection<S>,
                                       .share = share_all_loads<S>};
  return solver;
}

#define CDOT_INSTANTIATE(S) template const RowSolver<S>& iterative_solver();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
