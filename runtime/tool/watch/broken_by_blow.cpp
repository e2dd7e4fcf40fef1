#include "runtime/tool/watch/broken_by_blow.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/events/bonds.hpp"
#include "runtime/events/latch.hpp"
#include "runtime/solve/direct.hpp"

namespace cdot {
namespace {

// Without the blow a load grows by at most so many times as much as in the step before.
constexpr double usual_growth = 2;

template <class S>
bool tears(const Batch<S>& batch) {
  return batch.law && batch.law->distance;
}

// How far a row is from its end, by a force.
template <class S>
double distance_from_end(const Batch<S>& batch, int row, typename S::Scalar force) {
  typename S::Scalar from[2];
  batch.law->distance(batch, row, batch.rate[row], force, from);
  return double(from[1]);
}

template <class S>
int island_of_joint(const WorldData<S>& world, int joint) {
  return world.island_of[movable_body(world, world.joints[joint])];
}

// f(slot, before) for each slot of the batch, with the number that was kept for it; `none` at first.
template <class S, class Number, class F>
void each_kept(const Batch<S>& batch, std::vector<Number>& kept, int each, Number none, F f) {
  kept.resize(static_cast<std::size_t>(batch.count() * each), none);
  for (int slot = 0; slot < batch.count(); ++slot) f(slot, &kept[static_cast<std::size_t>(batch.home[slot] * each)]);
}

}  // namespace

template <class S>
void BlowWatch::look(BasicWorld<S>& world, double time) {
  const WorldData<S>& data = world.data();
  const auto torn = [](const auto& batch) { return tears(*batch); };
  if (found_.joint >= 0 || (data.bonds.empty() && std::ranges::none_of(data.batches, torn))) return;
  find_struck_islands(data);
  look_at_bonds(data, time);
  look_at_rows(data, time);
}

template <class S>
void BlowWatch::find_struck_islands(const WorldData<S>& world) {
  struck_.assign(world.islands.size(), false);
  pressed_.resize(world.batches.size());
  for (std::size_t k = 0; k < world.batches.size(); ++k) {
    const Batch<S>& batch = *world.batches[k];
    if (!has_ends(batch)) continue;
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

template <class S>
void BlowWatch::look_at_bonds(const WorldData<S>& world, double time) {
  of_bonds_.resize(world.bonds.size());
  for (std::size_t k = 0; k < world.bonds.size(); ++k) {
    const Bond& bond = world.bonds[k];
    const int island = island_of_joint(world, bond.joint);
    if (world.islands[island].flow.locates) continue;
    const bool broken = world.joints[bond.joint].broken;
    if (broken && struck_[static_cast<std::size_t>(island)]) note(bond.joint, of_bonds_[k], time);
    of_bonds_[k].add(distance_from_break(world, bond, time));
  }
}

template <class S>
void BlowWatch::look_at_rows(const WorldData<S>& world, double time) {
  using T = typename S::Scalar;
  of_rows_.resize(world.batches.size());
  for (std::size_t k = 0; k < world.batches.size(); ++k) {
    const Batch<S>& batch = *world.batches[k];
    if (!tears(batch)) continue;
    each_kept<S, Distances>(batch, of_rows_[k], 1, {}, [&](int slot, Distances* before) {
      const int island = island_of_joint(world, batch.joint[slot]);
      if (world.islands[island].flow.locates) return;
      const bool torn = (static_cast<int>(batch.happened[slot]) & static_cast<int>(Event::ended)) != 0;
      if (torn && struck_[static_cast<std::size_t>(island)] && distance_from_end(batch, slot, T(0)) > at_event<T>)
        note(batch.joint[slot], *before, time);
      const T impulse = batch.lambda[slot] + batch.correction[slot];
      before->add(torn ? Distances::unknown : distance_from_end(batch, slot, impulse / T(world.last_step)));
    });
  }
}

// Once it is broken, both distances or one of them are infinite or unknown, and so is their difference.
void BlowWatch::note(int joint, const Distances& before, double time) {
  const double without_blow = before.last - usual_growth * std::abs(before.last - before.last_but_one);
  if (found_.joint < 0 && without_blow > 0) found_ = {joint, 1 - before.last, time};
}

#define CDOT_INSTANTIATE(S) template void BlowWatch::look(BasicWorld<S>&, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
