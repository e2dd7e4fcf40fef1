#include "runtime/events/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/events/guarded.hpp"
#include "runtime/solve/reach.hpp"

namespace cdot {
namespace {

// The largest change of a row's C by a displacement of the island's size or a rotation of 1 rad, of one body. Rows that
// count whole turns would count these.
template <class S>
typename S::Scalar change_far_away(WorldData<S>& world, const Island<S>& island, Batch<S>& batch, int slot, int row) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows, bodies = batch.ops->bodies;
  if (batch.ops->counters > 0) return 0;
  T C[most_rows], largest = 0;
  std::copy_n(batch.C.begin() + slot * rows, rows, C);
  for (int k = 0; k < bodies; ++k) {
    const int body = batch.body[slot * bodies + k];
    if (world.bodies.immovable(body)) continue;
    const auto pose = world.bodies.pose[body];
    for (int i = 0; i < S::freedom; ++i) {
      T way[S::freedom] = {};
      way[i] = i < S::lengths ? T(island.size) : T(1);
      world.bodies.pose[body] = S::moved(pose, S::read_velocity(way));
      batch.ops->position(batch, slot, slot + 1, world.bodies, island.evaluated_at);
      largest = std::max(largest, std::abs(batch.C[slot * rows + row] - C[row]));
    }
    world.bodies.pose[body] = pose;
  }
  std::copy_n(C, rows, batch.C.begin() + slot * rows);
  return largest;
}

}  // namespace

template <class S>
void find_resolution(WorldData<S>& world, const Island<S>& island, Batch<S>& batch, int slot, typename S::Scalar h,
                     Resolution<typename S::Scalar>* resolution) {
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;
  const Bodies<S>& all = world.bodies;
  const int rows = batch.ops->rows, bodies = batch.ops->bodies, width = S::freedom * bodies;
  Real J[most_rows * S::freedom * most_bodies], weighted[most_rows * S::freedom * most_bodies],
      K[most_rows * most_rows];
  batch.ops->dense(batch, slot, all, J, weighted, K, rows);
  for (int r = 0; r < rows; ++r) {
    T c = 0, rate = 0, acceleration = 0, along = 0, inverse_mass = 0;
    for (int k = 0; k < bodies; ++k) {
      const int body = batch.body[slot * bodies + k];
      if (all.immovable(body)) continue;
      T v[S::freedom], dv[S::freedom], linear = 0;
      c = std::max(c, slopes_of<S>(J + r * width + S::freedom * k).motion(T(island.size)));
      S::write(all.velocity[body], v), S::write(all.velocity_rate[body], dv);
      for (int i = 0; i < S::freedom; ++i) {
        const T slope = T(J[r * width + S::freedom * k + i]), j = std::abs(slope);
        if (i < S::lengths) linear = std::max(linear, std::abs(dv[i]));
        rate += j * std::abs(v[i]);
        along += slope * dv[i];
        acceleration += j * (i < S::lengths ? std::abs(dv[i]) : std::max(std::abs(dv[i]), linear / island.size));
      }
      inverse_mass += all.inverse_mass[body].m;
    }
    const T k = K[r * rows + r] > 0 ? T(K[r * rows + r]) : inverse_mass;  // no motion: bodies that never turn
    if (!(c > T(0))) c = change_far_away(world, island, batch, slot, r);
    if (!(c > T(0))) c = island.size;
    const T by_force = k * std::abs(batch.lambda[slot * rows + r]);
    acceleration = std::max(acceleration, by_force);
    rate = std::max({rate, std::sqrt(acceleration * c), std::numeric_limits<T>::epsilon() / slight<T> * c / h});
    resolution[r].C = slight<T> * c;
    resolution[r].rate = std::max(resolution[r].rate, slight<T> * rate);
    resolution[r].hop = std::max(resolution[r].hop, T(6) * slight<T> * c * std::max(std::abs(along), by_force));
    resolution[r].force = std::max(resolution[r].force, slight<T> * (acceleration + rate * rate / c) / k);
  }
}

#define CDOT_INSTANTIATE(S) \
  template void find_resolution(WorldData<S>&, const Island<S>&, Batch<S>&, int, S::Scalar, Resolution<S::Scalar>*);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
