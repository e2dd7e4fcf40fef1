// Rows whose bounds grow with a load: friction in proportion to what a contact or a joint carries. The load is the
// force of other rows of the same solution, so a solver finds both together.
#pragma once

#include <cmath>

#include "runtime/state/world_data.hpp"

namespace cdot {

// Lists the island's loaded rows. Allocates.
template <class S>
void list_loads(const WorldData<S>& world, Island<S>& island);

// Takes the bounds without a load from Batch::lower and upper, as `fill` or `guard` left them, and the coefficients at
// the present poses.
template <class S>
void begin_loads(WorldData<S>& world, Island<S>& island);
// Writes Batch::lower and upper for LoadedRow::load, and without a load.
template <class S>
void bound_by_loads(Island<S>& island);
template <class S>
void unload(Island<S>& island);

// The load that the carrier's rows have: lambda(batch, index, row of the system).
template <class S, class Lambda>
typename S::Scalar carried(const Island<S>& island, const LoadedRow<S>& row, Lambda lambda) {
  using T = typename S::Scalar;
  const Batch<S>& of = *row.carrier;
  const int rows = of.ops->rows, slot = of.slot_of[row.carrier_home];
  const int first = row.carrier_block < 0 ? 0 : island.at_work().blocks[row.carrier_block].first;
  if (row.batch->law->load_of) return std::abs(lambda(of, slot, first));
  T force[3] = {};
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < 3; ++k) force[k] += row.arms[3 * r + k] * lambda(of, slot * rows + r, first + r);
  return std::hypot(force[0], force[1], force[2]);
}

// The impulse or force that a row exerts, with what the present kick counts of the other ones.
template <class S>
auto impulse_of_rows(const Island<S>& island) {
  return [share = island.corrections_in_loads](const Batch<S>& batch, int i, int) {
    return batch.lambda[i] + share * batch.correction[i];
  };
}

// Repeats solve(), which reads the bounds, until the loads are those that it yields: Broyden's method on the loads.
// Where they would become negative, friction grows faster than the load that it needs: then the load grows until the
// row no longer slips. False if that does not end.
template <class S, class Solve, class Lambda>
bool settle_loads(Island<S>& island, Solve solve, Lambda lambda) {
  using T = typename S::Scalar;
  constexpr int rounds = 80;
  constexpr T enough = T(by_precision<T>(1e-6, 1e-13)), by_round_off = T(by_precision<T>(1e-3, 1e-9));
  const auto restart = [&] { island.load_search.begin([](size_t) { return T(1); }); };
  restart();
  for (LoadedRow<S>& row : island.loads) row.load = carried(island, row, lambda);
  for (int round = 0; round < rounds; ++round) {
    bound_by_loads(island);
    solve();
    T worst = 0, largest = 0;
    for (size_t k = 0; k < island.loads.size(); ++k) {
      LoadedRow<S>& row = island.loads[k];
      row.found = carried(island, row, lambda);
      island.load_changes[k] = row.found - row.load;
      worst = std::max(worst, std::abs(row.found - row.load)), largest = std::max(largest, row.found);
    }
    if (!(worst > (round < rounds / 4 ? enough : by_round_off) * largest)) return true;
    bool goes_on = island.load_search.next(island.load_changes.data());
    for (size_t k = 0; k < island.loads.size(); ++k) {
      LoadedRow<S>& row = island.loads[k];
      const T next = row.load + island.load_changes[k];
      const bool grows = !(next >= T(0)) || !std::isfinite(next);
      goes_on &= !grows;
      row.load = grows ? T(2) * std::max(row.load, row.found) : next;
    }
    if (!goes_on) restart();
  }
  return false;
}

}  // namespace cdot
