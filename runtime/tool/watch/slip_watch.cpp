#include "runtime/tool/watch/slip_watch.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/state/world_data.hpp"

namespace cdot {
namespace {

// Friction that a blow loads exceeds that of forces by this factor at least; else it hardly counts.
constexpr double of_blow = 10;

// RATTLE takes such a blow in one step, and others locate it.
template <class S>
bool parts_blows(const WorldData<S>& world, const Island<S>& island) {
  const bool whole = world.settings.integrator == Integrator::rattle && island.solver->exact;
  return !island.loads.empty() && !island.asleep && !island.flow.locates && !whole;
}

}  // namespace

template <class S>
void SlipWatch::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  const auto parts = [&](const auto& island) { return parts_blows(data, island); };
  if (found_.joint >= 0 || std::ranges::none_of(data.islands, parts)) return;
  struck_.look(data);
  since_.resize(data.islands.size(), 0);
  ++newest_;
  std::size_t k = 0;
  for (std::size_t n = 0; n < data.islands.size(); ++n) {
    const Island<S>& island = data.islands[n];
    since_[n] = struck_[static_cast<int>(n)] ? 0 : since_[n] + 1;
    if (of_rows_.size() < k + island.loads.size()) of_rows_.resize(k + island.loads.size());
    for (const LoadedRow<S>& row : island.loads) {
      const Batch<S>& batch = *row.batch;
      Impulses& impulses = of_rows_[k++];
      const int i = row.place();
      impulses[newest_ % impulses.size()] = double(batch.lambda[i]) + double(batch.correction[i]);
      if (parts(island) && since_[n] == 2 && found_.joint < 0 && turns_round(impulses, newest_))
        found_ = {static_cast<int>(batch.joint[i / batch.ops->rows]), time};
    }
  }
}

bool SlipWatch::turns_round(const Impulses& impulses, std::size_t newest) {
  const auto ago = [&](std::size_t steps) { return impulses[(newest - steps) % impulses.size()]; };
  const auto larger = [&](std::size_t a, std::size_t b) { return std::max(std::abs(ago(a)), std::abs(ago(b))); };
  return ago(0) * ago(3) < 0 && larger(1, 2) > of_blow * larger(0, 3);
}

#define CDOT_INSTANTIATE(S) template void SlipWatch::look(BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
