#include "runtime/world/rollback.hpp"

#include <algorithm>
#include <cstring>

#include <cdot/spaces.hpp>

#include "runtime/events/bonds.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/integrators.hpp"

namespace cdot {
namespace {

// For a few numbers a loop is cheaper than a call of memcpy.
inline void copy_range(const std::byte* from, std::byte* to, Block::Range range) {
  std::size_t at = range.begin;
  if (range.end - at > 48) return void(std::memcpy(to + at, from + at, range.end - at));
  for (; at + 8 <= range.end; at += 8) std::memcpy(to + at, from + at, 8);
  for (; at < range.end; ++at) to[at] = from[at];
}

// Copy all bytes that a step of one island, or of all awake ones, may change.
template <class S>
void copy_island(const WorldData<S>& world, int index, const std::vector<std::byte>& from, std::vector<std::byte>& to) {
  for (const Block::Range& range : world.block.islands[index]) copy_range(from.data(), to.data(), range);
}
template <class S>
void copy_awake(const WorldData<S>& world, const std::vector<std::byte>& from, std::vector<std::byte>& to) {
  copy_range(from.data(), to.data(), world.block.common);
  for (int index : world.awake) copy_island(world, index, from, to);
}

}  // namespace

template <class S>
void compute_again(WorldData<S>& world, Island<S>& island) {
  island.system.slacken();
  island.trouble = StepProblem::none;
  if (!island.evaluated) return;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, island.evaluated_at);
  if (island.factored || stepper_of<S>(world.settings.integrator).starts_from_factor)
    island.solver->factor(world, island);
}

template <class S>
void save_state(WorldData<S>& world) {
  copy_awake(world, world.block.bytes, world.before);
}

// Copies twice, because compute_again() changes the State: factoring counts redundant rows, evaluation counts turns.
template <class S>
void roll_back(WorldData<S>& world) {
  copy_awake(world, world.before, world.block.bytes);
  for (int index : world.awake) {
    if (!world.bonds.empty()) find_rows(world, world.islands[index]);
    compute_again(world, world.islands[index]);
  }
  copy_awake(world, world.before, world.block.bytes);
  for (int index : world.awake) halt_immovable_bodies(world, world.islands[index]);
}

template <class S>
void save_island(WorldData<S>& world, int index) {
  copy_range(world.block.bytes.data(), world.before.data(), world.block.common);
  copy_island(world, index, world.block.bytes, world.before);
}

template <class S>
void roll_back_island(WorldData<S>& world, int index) {
  const auto restore = [&] {
    copy_range(world.before.data(), world.block.bytes.data(), world.block.common);
    copy_island(world, index, world.before, world.block.bytes);
  };
  restore();
  compute_again(world, world.islands[index]);
  restore();  // computing again changed the State
  halt_immovable_bodies(world, world.islands[index]);
}

template <class S>
void adopt_state(WorldData<S>& world, const std::vector<std::byte>& bytes) {
  const auto some_broken = [&] {
    return std::ranges::any_of(world.joints, [](const auto& joint) { return joint.broken; });
  };
  bool moved = some_broken();  // rows; only those of broken joints ever move
  std::memcpy(world.block.bytes.data(), bytes.data(), bytes.size());
  moved |= some_broken();
  world.awake.clear();
  Bodies<S>& all = world.bodies;
  for (int i = 0; i < all.count(); ++i) all.mass[i] = S::inverted(all.inverse_mass[i]);
  for (std::size_t k = 0; k < world.islands.size(); ++k) {
    Island<S>& island = world.islands[k];
    if (!island.asleep) world.awake.push_back(static_cast<int>(k));
    if (moved) find_rows(world, island);
    compute_again(world, island);
  }
  std::memcpy(world.block.bytes.data(), bytes.data(), bytes.size());
}

#define CDOT_INSTANTIATE(S)                                                \
  template void save_state(WorldData<S>&);                                 \
  template void roll_back(WorldData<S>&);                                  \
  template void save_island(WorldData<S>&, int);                           \
  template void roll_back_island(WorldData<S>&, int);                      \
  template void adopt_state(WorldData<S>&, const std::vector<std::byte>&); \
  template void compute_again(WorldData<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
