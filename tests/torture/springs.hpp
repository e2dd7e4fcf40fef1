// The terms of springs in the bound of the energy: springs between points, springs on coordinates, rows of soft joints.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot::torture {

struct SpringRow {
  int joint = -1;             // -1: none
  double c = 0, rate = 0;     // stretch and its rate
  double force = 0;           // without damping
  double stiffness = 0;       // a difference over a small share of c
  double tangent = 0;         // the slope that an implicit step takes: near a kink it may differ from that difference
  double mass = 0;            // K of the row: |M^-1 J'|^2 in the metric of the masses; 0: broken
  bool by_frequency = false;  // the stiffness changes with the pose
};

// Forces of a slot's rows at rest next to C, which tells their stiffness; on the other side where there is no force, as
// of a gas spring shorter than 0. forces_of(rows, slot, forces)
template <class S, class Forces, class Law>
std::vector<double> find_ways_to(Batch<S>& rows, int slot, const Law& forces_of, Forces& forces) {
  using T = typename S::Scalar;
  const auto count = static_cast<std::size_t>(rows.ops->rows), first = static_cast<std::size_t>(slot) * count;
  const std::vector<T> C(&rows.C[first], &rows.C[first] + count);
  std::vector<double> ways(count);
  for (const double share : {1e-3, -1e-3}) {
    for (std::size_t r = 0; r < count; ++r) {
      ways[r] = share * std::max(std::abs(double(C[r])), 1e-6);
      rows.C[first + r] = T(double(C[r]) - ways[r]);
    }
    forces_of(rows, slot, forces.data());
    std::copy(C.begin(), C.end(), &rows.C[first]);
    if (std::all_of(forces.begin(), forces.end(), [](T force) { return std::isfinite(force); })) break;
  }
  return ways;
}

// The rows of a slot under forces_of(rows, slot, forces); tangent(row, stiffness) of the difference.
template <class S, class Law, class Tangent>
void add_rows_of(const WorldData<S>& state, Batch<S>& rows, int slot, const Law& forces_of, const Tangent& tangent,
                 std::vector<SpringRow>& springs) {
  using T = typename S::Scalar;
  const int count = rows.ops->rows, joint = rows.joint[static_cast<std::size_t>(slot)];
  const double whole = state.joints[static_cast<std::size_t>(joint)].broken ? 0 : 1;
  const bool by_frequency = rows.law->by_mass && rows.law->by_mass(rows, slot);
  std::vector<T> force(static_cast<std::size_t>(count)), further(force);
  forces_of(rows, slot, force.data());
  const std::vector<double> ways = find_ways_to(rows, slot, forces_of, further);
  for (int r = 0; r < count; ++r) {
    const auto of_row = static_cast<std::size_t>(r);
    const auto i = static_cast<std::size_t>(slot * count + r);
    const auto k = static_cast<std::size_t>(slot * rows.triangle() + r * (r + 1) / 2 + r);
    const double stiffness = double(further[of_row] - force[of_row]) / ways[of_row];
    springs.push_back({joint, double(rows.C[i]), double(rows.rate[i]), whole * double(force[of_row]), stiffness,
                       tangent(of_row, stiffness), whole * double(rows.factor[k]), by_frequency});
  }
}

// Rows of batches under a law with a force, at the present poses. What an energy stores and the rest of the force may
// cancel, but each does its own work: two rows.
template <class S>
void add_spring_rows(const WorldData<S>& state, const Batch<S>& batch, std::vector<SpringRow>& springs) {
  using T = typename S::Scalar;
  Batch<S> rows = batch;  // a copy, because the next step may start from the World's own rows
  const auto count = static_cast<std::size_t>(rows.ops->rows);
  const std::vector<T> no_rate(count);
  std::vector<SpringNumbers<T>> slopes(count);
  rows.ops->evaluate(rows, 0, rows.count(), state.bodies, T(state.time));
  rows.ops->effective_mass(rows, 0, rows.count(), state.bodies);
  rows.ops->velocity(rows, 0, rows.count(), state.bodies.velocity.data(), rows.rate.data());
  const auto unstored = [&](const Batch<S>& of, int slot, T* to) { of.law->unstored(of, slot, no_rate.data(), to); };
  const auto stored = [&](const Batch<S>& of, int slot, T* to) {
    std::vector<T> rest(count);
    of.law->force(of, slot, no_rate.data(), to);
    if (of.law->stores_part) unstored(of, slot, rest.data());
    for (std::size_t r = 0; r < count; ++r) to[r] -= rest[r];
  };
  for (int slot = 0; slot < rows.count(); ++slot) {
    if (rows.law->spring) rows.law->spring(rows, slot, slopes.data());
    std::vector<double> left(count);
    for (std::size_t r = 0; r < count; ++r) left[r] = double(slopes[r].k);
    const auto own = [&](std::size_t r, double stiffness) { return left[r] -= stiffness, stiffness; };
    if (rows.law->stores_part) add_rows_of(state, rows, slot, unstored, own, springs);
    add_rows_of(
        state, rows, slot, stored, [&](std::size_t r, double) { return left[r]; }, springs);
  }
}

template <class S>
std::vector<SpringRow> spring_rows(BasicWorld<S>& world) {
  const WorldData<S>& state = world.data();
  std::vector<SpringRow> springs;
  for (const auto& batch : state.batches)
    if (batch->law && batch->law->force) add_spring_rows(state, *batch, springs);
  // Slots change places when a joint breaks.
  std::stable_sort(springs.begin(), springs.end(),
                   [](const SpringRow& a, const SpringRow& b) { return a.joint < b.joint; });
  return springs;
}

// An upper bound of |h F| of all springs, in the metric of the masses.
inline double push_of(const std::vector<SpringRow>& springs, double h) {
  double sum = 0;
  for (const SpringRow& s : springs) sum += h * std::abs(s.force) * std::sqrt(s.mass);
  return sum;
}

// The largest error of a first-order step in a spring's work. c goes from c0 to c1 by h J v + beta with J of the start,
// under one force f, which is f0 or, implicitly, f1 + k beta:
//   h J v f - (f0 + f1) (c1 - c0) / 2, at most |c1 - c0| |f1 - f0| / 2 + |beta| (|f0| + 2 |f1| + k |beta|),
//   beta = (c1 - c0) - h J v0 - h J dv, |J dv| <= sqrt(K) |dv|.
// A bent law leaves its tangent by e = |f1 - f0 + k0 (c1 - c0)|, and an implicit step takes the tangent. The law is
// between tangent and chord: + |c1 - c0| (e + e / 2). Where a cord becomes taut, its slope is between those beside it,
// and the larger e counts. The work of a stiffness that changes is c^2 (k1 - k0) / 2.
inline double missed_work(const SpringRow& s, const SpringRow& e, double h, double dv) {
  if (e.mass == 0) return 0;
  const double way = e.c - s.c, further = e.force - s.force;
  const double bent = std::max(std::abs(further + s.stiffness * way), std::abs(further + s.tangent * way));
  const double beta = std::abs(way - h * s.rate) + h * std::sqrt(s.mass) * dv;
  const double stretch = std::max(std::abs(s.c), std::abs(e.c));
  return std::abs(way) * (std::abs(e.force - s.force) / 2 + 1.5 * bent) +
         (e.by_frequency ? stretch * stretch * std::abs(e.stiffness - s.stiffness) / 2 : 0) +
         beta * (std::abs(s.force) + 2 * std::abs(e.force) + std::abs(e.stiffness) * beta);
}

// The change of a stiffness in a step, relative: over a way w the trapezoidal rule misses w^3 k' / 12 of the work under
// a bent law, its first-order error w |k w| / 2 times |k1 - k0| / k, and each further order is one more factor.
inline double stiffened(const SpringRow& s, const SpringRow& e) {
  const double most = std::max(std::abs(s.stiffness), std::abs(e.stiffness));
  return most > 0 ? std::abs(e.stiffness - s.stiffness) / most : 0;
}

}  // namespace cdot::torture
