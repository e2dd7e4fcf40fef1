#include "runtime/tool/watch/struck_islands.hpp"

#include <cdot/spaces.hpp>

#include "runtime/tool/watch/watched_ends.hpp"

namespace cdot {

template <class S>
void StruckIslands::look(const WorldData<S>& world) {
  struck_.assign(world.islands.size(), false);
  pressed_.resize(world.batches.size());
  for (std::size_t k = 0; k < world.batches.size(); ++k) {
    const Batch<S>& batch = *world.batches[k];
    if (!batch.law || !batch.law->guard) continue;
    const int rows = batch.ops->rows;
    each_kept<S, char>(batch, pressed_[k], rows, 0, [&](int slot, char* before) {
      for (int r = 0; r < rows; ++r) {
        const int i = slot * rows + r;
        const bool presses = batch.lambda[i] != 0 || batch.correction[i] != 0;
        if (presses && !before[r]) struck_[static_cast<std::size_t>(island_of_joint(world, batch.joint[slot]))] = true;
        before[r] = presses;
      }
    });
  }
}

#define CDOT_INSTANTIATE(S) template void StruckIslands::look(const WorldData<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
