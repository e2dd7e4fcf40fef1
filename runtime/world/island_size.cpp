// The size of a mechanism, which scales the tolerance of C.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <cdot/spaces.hpp>

#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

template <class S>
double distance(const typename S::Pose& a, const typename S::Pose& b) {
  const auto p = S::place_of(a), q = S::place_of(b);
  if constexpr (S::dimension == Dimension::planar) return std::hypot(p.x - q.x, p.y - q.y);
  else return std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
}

struct Lengths {
  double longest_arm = 0;  // |dC/d rotation| / |dC/d displacement| of a movable body; 0 for rows without displacements
  // The least |dC/d displacement| of a row, or |dC/d rotation| of one without displacements; infinite: no row moves.
  double least_slope = std::numeric_limits<double>::infinity();
};

// Of a slot's rows.
template <class S>
void measure_rows(const Batch<S>& batch, int slot, const Bodies<S>& all, Lengths& lengths) {
  const int bodies = batch.ops->bodies, width = S::freedom * bodies;
  using Real = ExactNumber<typename S::Scalar>;
  std::vector<Real> J(static_cast<size_t>(batch.ops->rows * width)), weighted(J);
  Real K[most_rows * most_rows];
  batch.ops->dense(batch, slot, all, J.data(), weighted.data(), K, most_rows);
  for (int r = 0; r < batch.ops->rows; ++r) {
    double slope = 0, turning_slope = 0;
    for (int k = 0; k < bodies; ++k) {
      if (all.immovable(batch.body[slot * bodies + k])) continue;
      const Real* row = J.data() + r * width + S::freedom * k;
      Real straight = 0, turning = 0;
      for (int c = 0; c < S::freedom; ++c) (c < S::lengths ? straight : turning) += row[c] * row[c];
      slope = std::max(slope, double(std::sqrt(straight)));
      turning_slope = std::max(turning_slope, double(std::sqrt(turning)));
      if (straight > 0) lengths.longest_arm = std::max(lengths.longest_arm, double(std::sqrt(turning / straight)));
    }
    if (slope == 0) slope = turning_slope;
    if (slope > 0 && (!batch.law || batch.law->reported)) lengths.least_slope = std::min(lengths.least_slope, slope);
  }
}

// The longest distance between two movable bodies of a slot.
template <class S>
double longest_distance(const Batch<S>& batch, int slot, const Bodies<S>& all) {
  const int bodies = batch.ops->bodies;
  double longest = 0;
  for (int k = 0; k < bodies; ++k) {
    for (int l = 0; l < k; ++l) {
      const int a = batch.body[slot * bodies + k], b = batch.body[slot * bodies + l];
      if (!all.immovable(a) && !all.immovable(b)) longest = std::max(longest, distance<S>(all.pose[a], all.pose[b]));
    }
  }
  return longest;
}

// Of an island's movable bodies from the origin.
template <class S>
double farthest(const WorldData<S>& world, const Island<S>& island) {
  double far = 0;
  for (int body : island.bodies) far = std::max(far, distance<S>(world.bodies.pose[body], {}));
  return far;
}

// A wheel that is held at its centre has no arm. Round-off of its place, and of what a scene computes about 1 m (the
// cosine of a right angle), would be one of 1e-17 m, and no step resolves lengths like it.
template <class S>
bool round_off(double size, double far) {
  using T = typename S::Scalar;
  constexpr double digits = std::numeric_limits<double>::epsilon(), digits_of_poses = std::numeric_limits<T>::epsilon();
  return size <= 8 * (digits + digits_of_poses * far);
}

}  // namespace

template <class S>
void measure_size(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  double size = 0;
  Lengths lengths;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    batch.ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, T(world.time));
    for (int slot = segment.begin; batch.ops->rows > 0 && slot < segment.end; ++slot) {
      measure_rows(batch, slot, world.bodies, lengths);
      size = std::max({size, lengths.longest_arm, longest_distance(batch, slot, world.bodies)});
    }
  }
  island.evaluated = false;
  island.size = round_off<S>(size, farthest(world, island)) ? T(1) : T(size);
  // Small are not only mechanisms, but also slopes, as that of a squared distance [m^2].
  island.scale = std::min(T(10) * island.size, T(1)) * T(std::min(lengths.least_slope, 1.0));
}

#define CDOT_INSTANTIATE(S) template void measure_size(WorldData<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
