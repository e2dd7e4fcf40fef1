// How far the C of a row goes: by motions as large as the mechanism, and by the round-off of poses. Rows in m, rad, m^2
// and without a unit have no scale in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/state/world_data.hpp"

namespace cdot {

// An estimate of the round-off of a sum, as a share of its largest term.
template <class T>
inline constexpr T of_round_off = T(64) * std::numeric_limits<T>::epsilon();

template <class T>
struct Reach {
  T motion = 0;     // the most that a displacement by the island's size or a turn of 1 rad of one body makes of it
  T round_off = 0;  // of the poses and of arms as long as the island
};

// The largest |J| of one row and body: of lengths, and of turns.
template <class T>
struct Slopes {
  T straight = 0, turning = 0;
  T motion(T size) const { return std::max(straight * size, turning); }
};
template <class S, class Real>
Slopes<typename S::Scalar> slopes_of(const Real* J) {
  using T = typename S::Scalar;
  Slopes<T> slopes;
  for (int i = 0; i < S::freedom; ++i) {
    T& slope = i < S::lengths ? slopes.straight : slopes.turning;
    slope = std::max(slope, T(std::abs(J[i])));
  }
  return slopes;
}

// Of the rows of one slot, by J as it was last evaluated.
template <class S>
void find_reaches(const WorldData<S>& world, const Island<S>& island, const Batch<S>& batch, int slot,
                  Reach<typename S::Scalar>* reaches);

}  // namespace cdot
