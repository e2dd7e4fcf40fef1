// Of a part of a midpoint step: the work of its joints, and the energy against which it counts.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/state/world_data.hpp"
#include "runtime/step/kick_drift.hpp"

namespace cdot {

// Of the joints in a part, as a share of the kinetic energy.
template <class T>
constexpr double slight_work = by_precision<T>(1e-2, 1e-4);

// The work of the joints, which is 0 along the exact motion: lambda (J v_m + dC/dt), in [J].
template <class S>
double work_of_joints(const Island<S>& island) {
  double work = 0;
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (batch->law) continue;
    each_row(*batch, begin, end, [&, of = batch](int i) {
      work += double(of->correction[i]) * (double(of->rate[i]) + double(of->bias[i]));
    });
  }
  return work;
}

// The kinetic energy of the motions that the joints changed in this part. Others, as of a wheel that merely spins or of
// a cart on a rail, count as much as makes the round-off of their work slight.
template <class S>
double moved_energy(const WorldData<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  constexpr double same = by_precision<T>(1e-4, 1e-9);
  constexpr double of_round_off = 8 * double(std::numeric_limits<T>::epsilon()) / slight_work<T>;
  double energy = 0;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    T v[S::freedom], before[S::freedom], momentum[S::freedom];
    S::write(world.bodies.velocity[i], v), S::write(island.flow.velocity[k], before);
    S::write(S::force(world.bodies.inverse_mass[i], world.bodies.velocity[i]), momentum);
    for (const auto& [from, to] : {std::pair{0, S::lengths}, std::pair{S::lengths, S::freedom}}) {
      double own = 0, change = 0, size = 0;
      for (int c = from; c < to; ++c) {
        own += 0.5 * double(momentum[c]) * double(v[c]);
        change += std::abs(double(v[c]) - double(before[c])), size += std::abs(double(v[c]));
      }
      energy += change > same * size ? own : of_round_off * own;
    }
  }
  return energy;
}

// Too slow for a judgement of its energy.
template <class S>
bool hardly_moves(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T speed = T(by_precision<T>(1e-4, 1e-6)) * island.size / h;
  return std::all_of(island.bodies.begin(), island.bodies.end(),
                     [&](int i) { return S::slower(world.bodies.velocity[i], speed); });
}

// At rest joints that share a misfit do work against each other, and what ropes between them take they give. Poses that
// move by some bits tell it to a share.
template <class S>
double given_at_rest(const Island<S>& island, double work) {
  constexpr double rounded = by_precision<typename S::Scalar>(1. / 16, 1e-9);
  return island.driven ? 0 : std::max(work, 0.0) + rounded * std::abs(work);
}

// True if the work of the joints is slight. A last part may lose energy. `given`: what they give back to ropes.
template <class S>
bool joints_fit(const WorldData<S>& world, const Island<S>& island, typename S::Scalar h, bool last, double& given) {
  const double work = work_of_joints(island);
  if (hardly_moves(world, island, h)) {
    given = given_at_rest<S>(island, work);
    return true;
  }
  return (last ? work : std::abs(work)) <= slight_work<typename S::Scalar> * moved_energy(world, island);
}

}  // namespace cdot
