#include "runtime/solve/cones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/precision.hpp>
#include <cdot/spaces.hpp>

namespace cdot {
namespace {

// The share of its speed at which a slip is noted anew; so it is at the inverse of that.
constexpr double least_slip = 0.01;
// A slower slip is none, in units of the resolution. The way that is lost goes with the square of it.
template <class T>
constexpr T slowest = T(by_precision<T>(4, 1e3));
// The share of its bound that a force reaches, but for round-off.
template <class T>
constexpr T reached = T(1) - T(by_precision<T>(1e-4, 1e-9));

template <class S>
size_t place_among_guarded(const Island<S>& island, const LoadedRow<S>& row) {
  size_t before = 0;
  for (const Segment<S>& segment : island.segments) {
    if (!segment.batch->law || !segment.batch->law->guard) continue;
    const int rows = segment.batch->ops->rows;
    if (segment.batch == row.batch) return before + static_cast<size_t>(row.place() - segment.begin);
    before += static_cast<size_t>((segment.end - segment.begin) * rows);
  }
  return before;
}

template <class S>
Guard<typename S::Scalar> guard_of(const LoadedRow<S>& row) {
  Guard<typename S::Scalar> guard;
  row.batch->law->guard(*row.batch, row.place(), &guard);
  return guard;
}

template <class S>
Mode mode_of(std::span<const LoadedRow<S>> cone) {
  return cone[0].batch->mode[cone[0].place()];
}

// The largest of the resolutions of the rows.
template <class S>
Resolution<typename S::Scalar> resolution_of(const Island<S>& island, std::span<const LoadedRow<S>> cone) {
  using T = typename S::Scalar;
  Resolution<T> largest{};
  for (const LoadedRow<S>& row : cone) {
    const Resolution<T>& one = island.flow.resolution[place_among_guarded(island, row)];
    largest = {std::max(largest.C, one.C), std::max(largest.rate, one.rate), std::max(largest.force, one.force),
               std::max(largest.hop, one.hop)};
  }
  return largest;
}

// value(row) of all rows, as the length of a vector.
template <class S, class F>
typename S::Scalar size_of(std::span<LoadedRow<S>> cone, F value) {
  typename S::Scalar size = 0;
  for (const LoadedRow<S>& row : cone) size = std::hypot(size, value(row));
  return size;
}

template <class S>
typename S::Scalar noted(const LoadedRow<S>& row) {
  return row.batch->share_of_cone(row.place());
}

template <class S>
typename S::Scalar force_of(const LoadedRow<S>& row) {
  return row.batch->lambda[row.place()];
}

}  // namespace

// With the slip w that the force opposes and the noted one, of speed s along n: a stage that passes the end of the slip
// must not turn the force round, so along n the slip counts as at least least_slip s. Across w the force b brakes with
// the rate K b/|w|; steps of a fixed length h are stable only if that is below 2/h, so a slower w counts as that fast.
template <class S>
void aim_cones(const WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (mode_of<S>(cone) != Mode::pushed) return;
    const T s = size_of<S>(cone, noted<S>), b = size_of<S>(cone, force_of<S>);
    T along = 0, K = 0;
    for (LoadedRow<S>& row : cone) {
      Batch<S>& batch = *row.batch;
      const int i = row.place();
      batch.ops->velocity(batch, i, i + 1, world.bodies.velocity.data(), batch.rate.data());
      batch.ops->effective_mass(batch, i, i + 1, world.bodies);
      K = std::max(K, batch.factor[i]);
      row.share = guard_of(row).rate - batch.rate[i] - batch.bias[i];
      along += row.share * noted(row) * inverse(s);
    }
    const auto share = [](const LoadedRow<S>& row) { return row.share; };
    const T least = T(0.5) * island.flow.fixed_step * K * b;
    const T missing = std::max({T(0), T(least_slip) * s - along, least - size_of<S>(cone, share)}) * inverse(s);
    for (LoadedRow<S>& row : cone) row.share += missing * noted(row);
    const T size = size_of<S>(cone, share);
    for (LoadedRow<S>& row : cone) row.share *= inverse(size);
  });
}

template <class S>
void bound_aimed_cones(Island<S>& island) {
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (mode_of<S>(cone) != Mode::pushed) return;
    for (LoadedRow<S>& row : cone) row.batch->lower[row.place()] = row.batch->upper[row.place()] *= row.share;
  });
}

template <class S>
bool offer_bounds_to_cones(Island<S>& island) {
  using T = typename S::Scalar;
  bool open = false;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    const auto missing = [](const LoadedRow<S>& row) {
      return guard_of(row).rate - row.batch->rate[row.place()] - row.batch->bias[row.place()];
    };
    const bool held = std::any_of(cone.begin(), cone.end(),
                                  [](const LoadedRow<S>& row) { return row.batch->mode[row.place()] == Mode::held; });
    const bool slow = held || size_of<S>(cone, missing) <= slowest<T> * resolution_of<S>(island, cone).rate;
    for (LoadedRow<S>& row : cone) {
      Batch<S>& batch = *row.batch;
      const int i = row.place();
      const Guard<T> guard = guard_of(row);
      batch.mode[i] = slow ? Mode::held : Mode::pushed;
      batch.lower[i] = guard.lower, batch.upper[i] = guard.upper;
      if (!slow) batch.share_of_cone(i) = missing(row);
    }
    open = true;
  });
  return open;
}

template <class S>
void decide_about_cones(Island<S>& island) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (mode_of<S>(cone) != Mode::held) return;
    const T size = size_of<S>(cone, force_of<S>), bound = cone[0].upper + cone[0].by_upper * cone[0].load;
    const bool slips = size >= reached<T> * bound;
    const T speed = slowest<T> * resolution_of<S>(island, cone).rate;
    for (LoadedRow<S>& row : cone) {
      Batch<S>& batch = *row.batch;
      const int i = row.place();
      if (slips) batch.mode[i] = Mode::pushed, batch.share_of_cone(i) *= speed;  // of length 1 before
      batch.lower[i] = slips ? force_of(row) : -std::numeric_limits<T>::infinity();
      batch.upper[i] = slips ? force_of(row) : std::numeric_limits<T>::infinity();
    }
  });
}

template <class S>
void measure_margins_of_cones(Island<S>& island) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    const Mode mode = mode_of<S>(cone);
    const Resolution<T> resolution = resolution_of<S>(island, cone);
    T margin = std::numeric_limits<T>::infinity();
    if (mode == Mode::held) {
      const T size = size_of<S>(cone, force_of<S>);
      margin = (guard_of(cone[0]).upper - size) / (resolution.force + (T(1) - reached<T>)*size);
    } else if (mode == Mode::pushed && guard_of(cone[0]).upper > T(0)) {
      const T s = size_of<S>(cone, noted<S>);
      T along = 0;
      for (const LoadedRow<S>& row : cone)
        along += (guard_of(row).rate - island.flow.row_rates[place_among_guarded(island, row)]) * noted(row);
      along *= inverse(s);
      margin = std::min(along - T(least_slip) * s, T(1 / least_slip) * s - along) / resolution.rate;
    }
    for (const LoadedRow<S>& row : cone) {
      T& of_row = island.flow.margins[place_among_guarded(island, row)];
      of_row = std::min(of_row, margin);
    }
  });
}

#define CDOT_INSTANTIATE(S)                                 \
  template void aim_cones(const WorldData<S>&, Island<S>&); \
  template void bound_aimed_cones(Island<S>&);              \
  template bool offer_bounds_to_cones(Island<S>&);          \
  template void decide_about_cones(Island<S>&);             \
  template void measure_margins_of_cones(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
