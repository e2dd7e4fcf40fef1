// A World and its matrix -> the numbers that tell whether elimination in K can tell its rows apart.
#pragma once

#include <algorithm>

#include <cdot/jacobian.hpp>

namespace cdot::torture {

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

}  // namespace cdot::torture
