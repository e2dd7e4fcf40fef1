// The derivatives of an island's accelerations by its poses and velocities, from differences.
#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/solve/misfits.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/collocation.hpp"

namespace cdot {
namespace {

// Of a difference that crosses a limit of a force: further attempts, each second one by a part of the length.
constexpr int most_moves = 9;
template <class T>
constexpr T shorter_move = T(1) / 16;

template <class S>
typename S::Velocity along(int component, typename S::Scalar by) {
  typename S::Scalar numbers[S::freedom] = {};
  numbers[component] = by;
  return S::read_velocity(numbers);
}

// f(row, component of dv/dt) for all bodies.
template <class S, class F>
void each_acceleration(const WorldData<S>& world, const Island<S>& island, F f) {
  size_t row = 0;
  for (int i : island.bodies) {
    typename S::Scalar rate[S::freedom];
    S::write(world.bodies.velocity_rate[i], rate);
    for (const auto number : rate) f(row++, number);
  }
}

// The changes of accelerations and known forces since the start, over `by`, into a column.
template <class S>
void write_column(const WorldData<S>& world, Island<S>& island, std::vector<double>& rates, std::vector<double>& forces,
                  size_t column, double by) {
  const auto& work = island.flow.collocation;
  const size_t m = work.base.size();
  each_acceleration(world, island,
                    [&](size_t row, auto now) { rates[row * m + column] = (double(now) - work.base[row]) / by; });
  each_known_force(island, [&](const Batch<S>& batch, int i, size_t row) {
    forces[row * m + column] = (double(batch.lower[i]) - work.base_forces[row]) / by;
  });
}

// Half the digits of a length of the island, of a turn, or of a velocity.
template <class S>
typename S::Scalar length_of_difference(const Island<S>& island, int component, typename S::Scalar size) {
  using T = typename S::Scalar;
  const T unit = component < S::lengths ? T(island.size) : T(1);
  return std::sqrt(std::numeric_limits<T>::epsilon()) * std::max(unit, std::abs(size));
}

// f(known force, whether it is within its limits) for every one that has some, at the present C and dC/dt.
template <class S, class F>
void each_limited_force(WorldData<S>& world, const Island<S>& island, F f) {
  SpringNumbers<typename S::Scalar> now[most_rows], within[most_rows];
  size_t row = 0;
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->law || !batch->law->force) continue;
    const int rows = batch->ops->rows;
    if (!batch->law->within_limits) {
      row += static_cast<size_t>((end - begin) * rows);
      continue;
    }
    batch->ops->effective_mass(*batch, begin, end, world.bodies);
    batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
    for (int slot = begin; slot < end; ++slot) {
      batch->law->spring(*batch, slot, now), batch->law->within_limits(*batch, slot, within);
      for (int r = 0; r < rows; ++r) f(row++, now[r].k == within[r].k && now[r].d == within[r].d);
    }
  }
}

template <class S>
void note_limits(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  auto& within_at_base = island.flow.collocation.base_within;
  if (within_at_base.empty()) return;
  evaluate_anew(world, island, time);
  each_limited_force(world, island, [&](size_t row, bool within) { within_at_base[row] = within; });
}

// A force at a limit has no slope, so a difference tells none of one that comes to a limit or leaves it. Moves by this
// length, or if it crosses a limit, the other way; or less far. move(by) moves.
template <class S, class F>
typename S::Scalar move_within_limits(WorldData<S>& world, Island<S>& island, typename S::Scalar by,
                                      typename S::Scalar time, F move) {
  const auto& within_at_base = island.flow.collocation.base_within;
  const auto crosses = [&] {
    bool crossed = false;
    each_limited_force(world, island, [&](size_t row, bool within) { crossed |= within != bool(within_at_base[row]); });
    return crossed;
  };
  for (int attempt = 0;; ++attempt) {
    move(by);
    evaluate_anew(world, island, time);  // restores dC/dt, which gamma replaced
    if (within_at_base.empty() || attempt == most_moves || !crosses()) return by;
    by *= attempt % 2 == 0 ? typename S::Scalar(-1) : shorter_move<typename S::Scalar>;
  }
}

template <class S>
void by_velocities(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  auto& work = island.flow.collocation;
  size_t column = 0;
  for (int i : island.bodies) {
    const auto at = world.bodies.velocity[i];
    T v[S::freedom];
    S::write(at, v);
    for (int c = 0; c < S::freedom; ++c, ++column) {
      // K and its factor stay.
      const T by = move_within_limits(world, island, length_of_difference(island, c, v[c]), time,
                                      [&](T length) { world.bodies.velocity[i] = S::sum(at, along<S>(c, 1), length); });
      accelerate(world, island, time);
      write_column(world, island, work.by_velocity, work.force_by_velocity, column, double(by));
    }
    world.bodies.velocity[i] = at;
  }
}

template <class S>
void by_poses(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  auto& work = island.flow.collocation;
  // Round-off of poses far from the origin.
  const T round_off = std::sqrt(std::numeric_limits<T>::epsilon()) * round_off_of(world, island);
  size_t column = 0;
  for (int i : island.bodies) {
    const auto at = world.bodies.pose[i];
    for (int c = 0; c < S::freedom; ++c, ++column) {
      move_within_limits(world, island, length_of_difference(island, c, round_off), time,
                         [&](T length) { world.bodies.pose[i] = S::moved(at, along<S>(c, length)); });
      island.factored = false;
      accelerate(world, island, time);
      T moved[S::freedom];
      S::write(S::difference(world.bodies.pose[i], at), moved);
      write_column(world, island, work.by_pose, work.force_by_pose, column, double(moved[c]));
    }
    world.bodies.pose[i] = at;
  }
}

// The accelerations of unit forces: a solve without velocities, other forces or gamma.
template <class S>
void by_forces(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  auto& work = island.flow.collocation;
  const size_t rows = work.base_forces.size();
  for (const Segment<S>& segment : island.segments) {
    auto& bias = segment.batch->bias;
    std::fill(bias.begin() + segment.begin * segment.batch->ops->rows,
              bias.begin() + segment.end * segment.batch->ops->rows, T(0));
  }
  std::vector<double>& base = work.real_turned;  // of rows that push with a force of their own
  for (size_t column = 0; column <= rows; ++column) {
    each_known_force(island, [&](Batch<S>& batch, int i, size_t row) {
      batch.lower[i] = batch.upper[i] = T(row + 1 == column ? 1 : 0);
    });
    for (int i : island.bodies) world.bodies.velocity_rate[i] = {};
    island.solver->accelerations(world, island);
    each_acceleration(world, island, [&](size_t row, auto now) {
      if (column == 0) base[row] = double(now);
      else work.by_force[row * rows + column - 1] = double(now) - base[row];
    });
  }
}

// The columns of B of every body.
template <class S>
void note_turns(const WorldData<S>& world, Island<S>& island) {
  auto* to = island.flow.collocation.turns.data();
  for (int i : island.bodies)
    for (int c = 0; c < S::freedom; ++c) {
      typename S::Scalar rate[S::pose_numbers];
      S::write_rate(world.bodies.pose[i], along<S>(c, 1), rate);
      to = std::copy_n(rate, S::pose_numbers, to);
    }
}

}  // namespace

template <class S>
void differentiate(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  CollocationWorkspace<typename S::Scalar>& work = island.flow.collocation;
  go_back(world, island);
  evaluate_anew(world, island, time);
  island.factored = false;
  accelerate(world, island, time);
  each_acceleration(world, island, [&](size_t row, auto now) { work.base[row] = double(now); });
  each_known_force(island,
                   [&](const Batch<S>& batch, int i, size_t row) { work.base_forces[row] = double(batch.lower[i]); });
  note_turns(world, island);
  note_limits(world, island, time);
  by_velocities(world, island, time);
  if (!work.base_forces.empty()) by_forces(world, island);
  by_poses(world, island, time);
  go_back(world, island);
  work.differentiated = true;
}

#define CDOT_INSTANTIATE(S) template void differentiate(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
