#include "runtime/solve/reach.hpp"

#include <cdot/spaces.hpp>

namespace cdot {
template <class S>
void find_reaches(const WorldData<S>& world, const Island<S>& island, const Batch<S>& batch, int slot,
                  Reach<typename S::Scalar>* reaches) {
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;
  const int rows = batch.ops->rows, bodies = batch.ops->bodies, width = S::freedom * bodies;
  Real J[most_rows * S::freedom * most_bodies], weighted[most_rows * S::freedom * most_bodies],
      K[most_rows * most_rows];
  batch.ops->dense(batch, slot, world.bodies, J, weighted, K, rows);
  std::fill_n(reaches, rows, Reach<T>{});
  for (int k = 0; k < bodies; ++k) {
    T numbers[S::pose_numbers], far = T(island.size), turned = 1;
    S::write(world.bodies.pose[batch.body[slot * bodies + k]], numbers);
    for (int i = 0; i < S::pose_numbers; ++i) {
      T& most = i < S::lengths ? far : turned;
      most = std::max(most, std::abs(numbers[i]));
    }
    for (int r = 0; r < rows; ++r) {
      const Slopes<T> slopes = slopes_of<S>(J + r * width + S::freedom * k);
      const T rounded = slopes.straight * far + slopes.turning * turned;
      reaches[r].motion = std::max(reaches[r].motion, slopes.motion(T(island.size)));
      reaches[r].round_off = std::max(reaches[r].round_off, of_round_off<T> * rounded);
    }
  }
}

#define CDOT_INSTANTIATE(S) \
  template void find_reaches(const WorldData<S>&, const Island<S>&, const Batch<S>&, int, Reach<S::Scalar>*);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
