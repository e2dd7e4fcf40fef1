// Rows whose bounds grow with a load: friction in proportion to what a contact or a joint carries. The load is the
// force of other rows of the same solution, so a solver finds both together.
//
// Rows of a cone share one force of at most b, as friction in a plane does. A solver knows bounds of single rows, so
// they get those of a box whose corner c lies on |c| = b. Where the force is at its bound, the right corner is opposite
// to the slip w. From a solution lambda, w within a box the next corner is that of projected descent,
//
//   c = b p / |p|,   p = lambda - w / K,   K = the largest of the rows' K,
//
// until it stays where it is. Each box contains the projection of p onto the disc of b, so for a given b the energy
// that the solution minimises falls from box to box: it ends at the minimum over the disc.
#pragma once

#include <cmath>
#include <span>

#include "runtime/state/world_data.hpp"

namespace cdot {

// Lists the island's loaded rows. Allocates.
template <class S>
void list_loads(const WorldData<S>& world, Island<S>& island);

// Takes the bounds without a load from Batch::lower and upper, as `fill` or `guard` left them, and the coefficients at
// the present poses.
template <class S>
void begin_loads(WorldData<S>& world, Island<S>& island);
// Writes Batch::lower and upper for this share of LoadedRow::load, and without a load.
template <class S>
void bound_by_loads(Island<S>& island, typename S::Scalar share = 1);
template <class S>
void unload(Island<S>& island);

// The load that the carrier's rows have: lambda(batch, index, row of the system). 0 without a carrier.
template <class S, class Lambda>
typename S::Scalar carried(const Island<S>& island, const LoadedRow<S>& row, Lambda lambda) {
  using T = typename S::Scalar;
  if (!row.carrier) return T(0);
  const Batch<S>& of = *row.carrier;
  const int rows = of.ops->rows, slot = of.slot_of[row.carrier_home];
  const int first = row.carrier_block < 0 ? 0 : island.at_work().blocks[row.carrier_block].first;
  const T share = island.corrections_in_cones;
  const auto whole = [&](int i, int r) { return lambda(of, i, first + r) + share * of.correction[i]; };
  if (row.batch->law->load_of) return std::abs(whole(slot, 0));
  T force[3] = {};
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < 3; ++k) force[k] += row.arms[3 * r + k] * whole(slot * rows + r, r);
  return std::hypot(force[0], force[1], force[2]);
}

// The impulse or force that a row exerts, with what the present kick counts of the other ones.
template <class S>
auto impulse_of_rows(const Island<S>& island) {
  return [share = island.corrections_in_loads](const Batch<S>& batch, int i, int) {
    return batch.lambda[i] + share * batch.correction[i];
  };
}

// The solution for one row: its force, its slip J v + bias, and K.
template <class T>
struct RowSolution {
  T force, slip, K;
};

// A row of a cone and the rows of the cone after it.
template <class S>
std::span<LoadedRow<S>> cone_from(Island<S>& island, size_t first) {
  return {island.loads.data() + first, static_cast<size_t>(island.loads[first].batch->law->cone_rows)};
}
// f(rows) for every cone.
template <class S, class F>
void each_cone(Island<S>& island, F f) {
  for (size_t k = 0; k < island.loads.size(); ++k) {
    const auto& law = *island.loads[k].batch->law;
    if (law.cone_rows > 0 && law.cone_row == 0) f(cone_from(island, k));
  }
}

// The next corner, given p in corner_found and |p|: along p, or as the present one if that box has p.
template <class S>
void turn_corner(std::span<LoadedRow<S>> cone, typename S::Scalar size);

// The corners of cones that turn from the loads found and solution(row).
template <class S, class Solution>
void find_corners(Island<S>& island, Solution solution) {
  using T = typename S::Scalar;
  each_cone(island, [&](std::span<LoadedRow<S>> cone) {
    if (!cone[0].turns) return;
    T K = 0, size = 0;
    for (const LoadedRow<S>& row : cone) K = std::max(K, T(solution(row).K));
    for (LoadedRow<S>& row : cone) {
      const RowSolution<T> now = solution(row);
      row.corner_found = now.force + row.before - now.slip * inverse(K);
      size = std::hypot(size, row.corner_found);
    }
    turn_corner(cone, size);
  });
}

// Takes the corners found, or the directions of the last step for a first one.
template <class S>
void take_corners(Island<S>& island);
template <class S>
void begin_corners(Island<S>& island);
// Loads and corners before the first solution.
template <class S, class Lambda>
void start_loads(Island<S>& island, Lambda lambda) {
  for (LoadedRow<S>& row : island.loads) row.load = carried(island, row, lambda);
  begin_corners(island);
}
template <class S>
bool turns_cones(const Island<S>& island);
// Adds Island::load_changes to loads and corners. False if one had to grow in their place.
template <class S>
bool move_on(Island<S>& island);

// Writes what solve() changed in loads and corners to Island::load_changes. Returns the largest change, as a share of
// the largest of them. Beside the largest impulse of the solution, loads are no surer than its round-off.
template <class S>
typename S::Scalar find_load_changes(Island<S>& island);

// True if the loads found have changed by more than those from which they follow, since the last call in this search.
// Rows that do not turn keep both in their corners.
template <class S>
bool run_away(Island<S>& island, bool first);

enum class Settled : char {
  no,
  yes,
  beyond  // loads from which a little more makes friction that adds more than that
};

// Repeats solve(), which reads the bounds, until the loads and the corners are those that it yields, where friction
// takes this share of its loads: Broyden's method on both. Where a load would become negative, friction grows faster
// than the load that it needs: then the load grows until the row no longer slips. So does a corner that would turn
// round. Cones of bodies with several contacts stick and slip by turns, which misleads Broyden's method: after some
// rounds they take each solution as it is.
template <class S, class Solve, class Lambda, class Solution>
Settled settle_share(Island<S>& island, typename S::Scalar share, Solve solve, Lambda lambda, Solution solution) {
  using T = typename S::Scalar;
  constexpr int rounds = 80, careful_rounds = 20;
  constexpr T enough = T(by_precision<T>(1e-6, 1e-13)), by_round_off = T(by_precision<T>(1e-3, 1e-9));
  constexpr T fine = T(by_precision<T>(1e-2, 1e-6)), rough = T(by_precision<T>(1e-2, 1e-4));  // of corners that turn
  const auto tolerance = [](int round) {
    return round < careful_rounds ? enough : round < rounds ? by_round_off : round < 2 * rounds ? fine : rough;
  };
  const auto restart = [&] { island.load_search.begin([](size_t) { return T(1); }); };
  restart();
  const bool turns = turns_cones(island);
  bool beyond = false;
  for (int round = 0; round < (turns ? 3 : 1) * rounds; ++round) {
    bound_by_loads(island, share);
    solve();
    for (LoadedRow<S>& row : island.loads) row.found = carried(island, row, lambda);
    find_corners(island, solution);
    if (!turns) beyond |= run_away(island, round == 0);
    if (!(find_load_changes(island) > tolerance(round))) {
      take_corners(island);
      return beyond ? Settled::beyond : Settled::yes;
    }
    const bool plain = turns && round >= 2 * careful_rounds;
    if (plain && round >= rounds)
      for (T& change : island.load_changes) change *= T(0.5);
    const bool found = plain || island.load_search.next(island.load_changes.data());
    if (!move_on(island) || !found) restart();
  }
  return Settled::no;
}

// The same for whole loads; false if that does not end. Where friction changes its own load by more than it is, more
// than one load is possible. The right one is the least, to which the load tends as friction grows from none: no
// bearing that gives way by a hair would keep the next one, beyond which loads run away.
template <class S, class Solve, class Lambda, class Solution>
bool settle_loads(Island<S>& island, Solve solve, Lambda lambda, Solution solution) {
  using T = typename S::Scalar;
  constexpr int parts = 16;
  start_loads(island, lambda);
  const auto settle = [&](T share) { return settle_share(island, share, solve, lambda, solution); };
  const Settled settled = settle(T(1));
  if (settled != Settled::beyond) return settled == Settled::yes;
  for (LoadedRow<S>& row : island.loads) row.load = 0;
  for (int part = 1; part < parts && settle(T(part) / T(parts)) == Settled::yes;) ++part;
  return settle(T(1)) != Settled::no;
}

}  // namespace cdot
