// How far the ends of coordinates are passed, as those of limits, and how their directions turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <cdot/diagnose.hpp>

#include "runtime/events/latch.hpp"
#include "runtime/state/world_data.hpp"
#include "tests/torture/motion.hpp"

namespace cdot::torture {

// A row of an effect that keeps a coordinate between ends.
struct EndRow {
  int joint = -1;
  double passed = 0;
  double reach = 0;  // what a displacement by the mechanism's length or a turn of 1 rad of one body makes of it
  std::vector<double> direction;  // its row of J, of length 1; turns count with that length
};

// True if the end of a slot began to hold in the last step: it may be passed, which the World tells, and the next step
// moves the bodies there. `rows` are evaluated at the time before that step.
template <class S>
bool began_since(const Batch<S>& rows, int slot) {
  if (!rows.law->distance) return false;
  typename S::Scalar from[2];
  rows.law->distance(rows, slot, 0, 0, from);
  return from[0] > at_event<typename S::Scalar>;
}

template <class S>
void add_end_rows(const WorldData<S>& state, const Batch<S>& batch, double length, double step,
                  std::vector<EndRow>& ends) {
  using Real = ExactNumber<typename S::Scalar>;
  Batch<S> rows = batch;  // a copy, because the next step may start from the World's own rows
  const int count = rows.ops->rows, bodies = rows.ops->bodies;
  rows.ops->evaluate(rows, 0, rows.count(), state.bodies, typename S::Scalar(state.time - step));
  std::vector<bool> began;
  for (int slot = 0; slot < rows.count(); ++slot) began.push_back(step > 0 && began_since(rows, slot));
  rows.ops->evaluate(rows, 0, rows.count(), state.bodies, typename S::Scalar(state.time));
  for (int slot = 0; slot < rows.count(); ++slot) {
    const int joint = rows.joint[static_cast<std::size_t>(slot)];
    if (state.joints[static_cast<std::size_t>(joint)].broken) continue;
    typename S::Scalar error[most_rows];
    Real J[most_rows * S::freedom * most_bodies], weighted[most_rows * S::freedom * most_bodies],
        K[most_rows * most_rows];
    rows.law->error(rows, slot, error);
    rows.ops->dense(rows, slot, state.bodies, J, weighted, K, count);
    for (int r = 0; r < count; ++r) {
      const bool moves = double(K[r * count + r]) > 0;  // else no body can, as one that never turns
      const bool counts = moves && !began[static_cast<std::size_t>(slot)];
      EndRow end{joint, counts ? std::abs(double(error[r])) : 0, 0, {}};
      double square = 0;
      for (int c = 0; c < S::freedom * bodies; ++c) {
        const double slope = double(J[r * S::freedom * bodies + c]) * (c % S::freedom < S::lengths ? length : 1.0);
        end.reach = std::max(end.reach, std::abs(slope));
        end.direction.push_back(slope);
        square += slope * slope;
      }
      for (double& slope : end.direction) slope /= square > 0 ? std::sqrt(square) : 1;
      ends.push_back(std::move(end));
    }
  }
}

template <class S>
std::vector<EndRow> end_rows(BasicWorld<S>& world, double length, double step = 0) {
  const WorldData<S>& state = world.data();
  std::vector<EndRow> ends;
  for (const auto& batch : state.batches)
    if (batch->law && !batch->law->reported && batch->law->error) add_end_rows(state, *batch, length, step, ends);
  std::ranges::stable_sort(ends, {}, &EndRow::joint);  // slots change places when a joint breaks
  return ends;
}

// The largest way past an end, as a share of the mechanism's length, of 1 rad, or of the row's reach: the World
// resolves events by that, and by the arms of its effects. A coordinate's reach grows with the inverse distance from a
// pose where it has no direction.
template <class S>
double passed_share(BasicWorld<S>& world, double length, double step, double held) {
  double share = 0, size = std::max(1.0, length);
  if (world.worst_passed_end().by > held * size)
    for (const Diagnosis::Island& island : diagnose(world, step).islands) size = std::max(size, island.size);
  for (const EndRow& end : end_rows(world, length, step))
    share = std::max(share, end.passed / std::max(size, end.reach));
  return share;
}

// The largest change of the direction of an end that is passed now; 2 if one turned round.
template <class S>
double passed_ends_turned(BasicWorld<S>& before, BasicWorld<S>& after, double length) {
  const std::vector<EndRow> from = end_rows(before, length), to = end_rows(after, length);
  if (from.size() != to.size()) return 0;
  double most = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (to[k].passed == 0) continue;
    double square = 0;
    for (std::size_t c = 0; c < to[k].direction.size(); ++c)
      square += std::pow(to[k].direction[c] - from[k].direction[c], 2);
    most = std::max(most, std::sqrt(square));
  }
  return most;
}

}  // namespace cdot::torture
