// Errors that projections leave: round-off, and misfits of joints that contradict each other.
#include "runtime/solve/misfits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/solve/projection.hpp"
#include "runtime/solve/reach.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

// The largest error that contradicting joints may share, in units of the island's size.
constexpr double most_shared = 0.05;

// True if a step of h moves no body by a bit: floats are too coarse for its velocity.
template <class S>
bool stands(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  const Bodies<S>& all = world.bodies;
  return std::all_of(island.bodies.begin(), island.bodies.end(), [&](int i) {
    typename S::Scalar before[S::pose_numbers], after[S::pose_numbers];
    S::write(all.pose[i], before), S::write(S::moved(all.pose[i], S::sum({}, all.velocity[i], h)), after);
    return std::equal(before, before + S::pose_numbers, after);
  });
}

// f(segment, its first row in Island::left)
template <class SomeIsland, class F>
void each_run_of_errors(SomeIsland& island, F f) {
  auto* left = island.left.data();
  for (const auto& segment : island.segments) {
    f(segment, left);
    left += (segment.whole_end - segment.begin) * segment.batch->ops->rows;
  }
}

// True if within(r, reach) holds for the rows of a slot that have an `error`.
template <class S, class F>
bool rows_within(const WorldData<S>& world, const Island<S>& island, const Batch<S>& batch, int slot,
                 const typename S::Scalar* error, F within) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  if (std::all_of(error, error + rows, [](T e) { return e == T(0); })) return true;
  Reach<T> reaches[most_rows];
  find_reaches(world, island, batch, slot, reaches);
  for (int r = 0; r < rows; ++r)
    if (error[r] != T(0) && !within(r, reaches[r])) return false;
  return true;
}

// True if within(error, reach) holds for each row's Batch::error.
template <class S, class F>
bool errors_within(const WorldData<S>& world, const Island<S>& island, F within) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int slot = begin; slot < end; ++slot) {
      const auto* const error = batch->error.data() + slot * batch->ops->rows;
      const auto of_row = [&](int r, const Reach<typename S::Scalar>& reach) {
        return within(std::abs(error[r]), reach);
      };
      if (!rows_within(world, island, *batch, slot, error, of_row)) return false;
    }
  return true;
}

// The same for what the last projection left, if it was to correct the drift.
template <class S, class F>
bool left_within(const WorldData<S>& world, const Island<S>& island, F within) {
  if (island.left.empty() || !std::isfinite(double(island.residual))) return false;
  bool all = true;
  each_run_of_errors(island, [&](const Segment<S>& segment, const typename S::Scalar* left) {
    for (int slot = segment.begin; all && slot < segment.end; ++slot, left += segment.batch->ops->rows) {
      const auto of_row = [&](int r, const Reach<typename S::Scalar>& reach) {
        return within(std::abs(left[r]), reach);
      };
      all = rows_within(world, island, *segment.batch, slot, left, of_row);
    }
  });
  return all;
}

// True if no row's error, at present of at most `error`, has changed by more than `allowed` since the last projection,
// or by more than a share of its round-off. A row without an error asks for no correction, as that of an end that no
// longer holds.
template <class S>
bool errors_stay(const WorldData<S>& world, const Island<S>& island, typename S::Scalar error,
                 typename S::Scalar allowed, typename S::Scalar share_of_round_off) {
  using T = typename S::Scalar;
  if (island.left.empty() || !std::isfinite(T(island.residual)))
    return std::abs(error - island.residual) <= std::max(allowed, share_of_round_off * round_off_of(world, island));
  bool stay = true;
  each_run_of_errors(island, [&](const Segment<S>& segment, const T* left) {
    const Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    for (int slot = segment.begin; stay && slot < segment.end; ++slot, left += rows) {
      const T* const now = batch.error.data() + slot * rows;
      const auto change = [&](int r) { return now[r] != T(0) ? std::abs(now[r] - left[r]) : T(0); };
      T most = 0;
      for (int r = 0; r < rows; ++r) most = std::max(most, change(r));
      stay = most <= allowed || rows_within(world, island, batch, slot, now, [&](int r, const Reach<T>& reach) {
               return change(r) <= std::max(allowed, share_of_round_off * reach.round_off);
             });
    }
  });
  return stay;
}

// False for rows within bounds that do nothing, as those of a slack rope.
template <class S>
bool acts(const Segment<S>& segment) {
  const Batch<S>& batch = *segment.batch;
  const int rows = batch.ops->rows;
  for (int i = segment.begin * rows; i < segment.end * rows; ++i)
    if (batch.lambda[i] != 0 || batch.correction[i] != 0 || batch.error[i] != 0) return true;
  return false;
}

}  // namespace

template <class S>
bool may_stay(const Island<S>& island) {
  using T = typename S::Scalar;
  return std::is_same_v<T, float> || island.residual > converged<T> * island.scale;
}

template <class S>
void reserve_errors(Island<S>& island) {
  int rows = 0;
  for (const Segment<S>& s : island.segments) rows += (s.whole_end - s.begin) * s.batch->ops->rows;
  island.left.assign(static_cast<size_t>(rows), typename S::Scalar(0));
}

template <class S>
void note_errors(Island<S>& island) {
  using T = typename S::Scalar;
  if (island.left.empty() || !may_stay(island)) return;
  each_run_of_errors(island, [](const Segment<S>& segment, T* left) {
    const int rows = segment.batch->ops->rows;
    std::copy_n(segment.batch->error.data() + segment.begin * rows, (segment.end - segment.begin) * rows, left);
  });
}

template <class S>
typename S::Scalar round_off_of(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  T numbers[S::pose_numbers], farthest = 0;
  for (int i : island.bodies) {
    S::write(world.bodies.pose[i], numbers);
    for (T number : numbers) farthest = std::max(farthest, std::abs(number));
  }
  return of_round_off<T> * farthest;
}

template <class S>
bool left_round_off(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  const T least = converged<T> * island.scale;
  if (island.residual <= least) return true;
  return left_within(world, island,
                     [=](T left, const Reach<T>& reach) { return left <= std::max(least, reach.round_off); });
}

template <class S>
bool left_misfits(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  if (!may_stay(island) || !std::isfinite(double(island.residual))) return false;
  return !left_within(world, island, [&](T left, const Reach<T>& reach) {
    return left <= std::max(foreign<T> * std::max<T>(reach.motion, island.scale), reach.round_off);
  });
}

template <class S>
bool stays_misfit(const WorldData<S>& world, const Island<S>& island, typename S::Scalar error, typename S::Scalar h) {
  using T = typename S::Scalar;
  // Round-off of floats leaves errors that are to be corrected, or a slack bridge sags: larger ones are misfits. Where
  // rows are redundant, so are those of its own size. Where no body moves, all are: near a loss of rank a correction of
  // round-off moves bodies by a thousand times as much, and they would wander for ever.
  constexpr T unchanged = T(1e-9), of_noise = T(1) / 16, at_rest = T(1) / 4;
  if (!may_stay(island)) return false;
  if (std::is_same_v<T, float> && stands(world, island, h) && errors_stay(world, island, error, T(0), at_rest))
    return true;
  if (!(island.residual > converged<T> * island.scale)) return false;
  const T above_round_off = T(island.redundant_rows > 0 ? by_precision<T>(0.25, 0) : by_precision<T>(4, 0));
  if (above_round_off > T(0) && left_within(world, island, [=](T left, const Reach<T>& reach) {
        return left <= above_round_off * reach.round_off;
      }))
    return false;
  return errors_stay(world, island, error, unchanged * error, of_noise);
}

template <class S>
bool may_contradict(const Island<S>& island, typename S::Scalar at_start) {
  const auto prescribes = [](const Segment<S>& segment) {
    const Batch<S>& batch = *segment.batch;
    return batch.law ? !batch.law->force && acts(segment) : batch.explicit_time() || has_velocity_rows(batch);
  };
  return !(at_start <= foreign<typename S::Scalar> * island.scale) ||
         std::any_of(island.segments.begin(), island.segments.end(), prescribes);
}

template <class S>
bool left_the_joints(const WorldData<S>& world, const Island<S>& island, typename S::Scalar at_start) {
  using T = typename S::Scalar;
  const bool meant_to_close = world.settings.drift == Drift::projection && island.solver->exact;
  if (!meant_to_close || island.segments.empty() || island.residual <= T(2) * at_start) return false;
  if (island.residual <= converged<T> * island.scale) return false;
  // A Newton that diverges leaves a large share as well.
  const bool contradicts = may_contradict(island, at_start);
  return !errors_within(world, island, [&](T error, const Reach<T>& reach) {
    const T length = std::max<T>(reach.motion, island.scale);
    const bool shares = contradicts && island.misfit <= most_shared * double(length);
    return error <= T(2) * std::max({foreign<T> * length, reach.round_off, shares ? T(island.misfit) : T(0), at_start});
  });
}

template <class S>
void fail_if_open(const WorldData<S>& world, Island<S>& island, typename S::Scalar at_start) {
  if (left_the_joints(world, island, at_start)) island.trouble = StepProblem::joints_apart;
}

#define CDOT_INSTANTIATE(S)                                                                \
  template bool may_stay(const Island<S>&);                                                \
  template void reserve_errors(Island<S>&);                                                \
  template void note_errors(Island<S>&);                                                   \
  template S::Scalar round_off_of(const WorldData<S>&, const Island<S>&);                  \
  template bool left_round_off(const WorldData<S>&, const Island<S>&);                     \
  template bool left_misfits(const WorldData<S>&, const Island<S>&);                       \
  template bool stays_misfit(const WorldData<S>&, const Island<S>&, S::Scalar, S::Scalar); \
  template bool may_contradict(const Island<S>&, S::Scalar);                               \
  template bool left_the_joints(const WorldData<S>&, const Island<S>&, S::Scalar);         \
  template void fail_if_open(const WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
