// A World -> what excuses a method: rows that elimination in K cannot tell apart, a motion whose energy is lost.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/balance.hpp>
#include <cdot/jacobian.hpp>

#include "runtime/direct/ldlt.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "tests/torture/laws.hpp"
#include "tests/torture/observer.hpp"

namespace cdot::torture {

constexpr double nearly_lost = 0.05;  // of the rows' independence at the start

// The smallest pivot of K, as a share of the diagonal, that differs from round-off and from the pivot of a redundant
// row at small errors of C.
template <class T>
constexpr double told_apart = Ldlt::pivot_share<T>;

// The least share that one body has in the diagonal of its row in K: J_b M_b^-1 J_b' / K_rr. Where other rows hold all
// other bodies of the row, elimination leaves that share of K_rr as its pivot.
template <class S>
double least_share_of_a_body(const BasicWorld<S>& world, const SystemMatrix& system) {
  using T = typename S::Scalar;
  double least = 1;
  for (int r = 0; r < system.rows; ++r) {
    double sum = 0, smallest = 0;
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
      T J[S::freedom];
      for (int c = 0; c < S::freedom; ++c) J[c] = T(system.entry(r, S::freedom * static_cast<int>(b) + c));
      const auto row = S::read_velocity(J);
      const double own = S::dot(row, S::weighted(world.inverse_mass(system.bodies[b]), row));
      sum += own;
      if (own > 0 && (smallest == 0 || own < smallest)) smallest = own;
    }
    if (sum > 0) least = std::min(least, smallest / sum);
  }
  return least;
}

// D and K at the present poses in doubles: floats round J, so rows that depend on others look independent.
template <class S>
SystemMatrix exact_system_matrix(BasicWorld<S>& world, const Scene& scene) {
  BasicWorld<typename S::Exact> exact = build_world_in<typename S::Exact>(scene);
  for (int k = 0; k < static_cast<int>(scene.bodies.size()); ++k) exact.set_pose(k, world.place(k));
  return system_matrix(exact);
}

// Why elimination cannot tell rows apart; nullptr if it can.
template <class S>
const char* rows_in_doubt(BasicWorld<S>& world, const Scene& scene) {
  constexpr double told = told_apart<typename S::Scalar>;
  for (const Scene& rows : {scene, without_forces(scene)})
    if (const SystemMatrix exact = exact_system_matrix(world, rows); rows_told_apart(exact, told) < exact.rank)
      return "rows that light bodies or long arms hide";
  const SystemMatrix now = system_matrix(world);
  if (least_share_of_a_body(world, now) < told) return "a body with less than a pivot's resolution of its row";
  if (independence(now, 8 * std::numeric_limits<double>::epsilon()) < std::sqrt(told))
    return "rows so near to dependent that pivots are not told from round-off";
  return nullptr;
}

// Steps that Runge-Kutta leaves to an implicit method may each take thousands of parts. Where the energy's balance has
// failed by then, as cdot-run tells, the rest of the motion tells nothing more.
template <class S>
bool rescued_in_vain(const BasicWorld<S>& world, BalanceWatch& balances, double tolerance) {
  balances.look(world.balance());
  return world.step_counts().rescued > 0 && balances.energy.share() > tolerance;
}

}  // namespace cdot::torture
