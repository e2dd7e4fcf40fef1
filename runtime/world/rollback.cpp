#include "runtime/world/rollback.hpp"

#include <algorithm>
#include <cstring>

#include <cdot/spaces.hpp>

#include "runtime/solve/solver.hpp"
#include "runtime/state/snapshot_list.hpp"
#include "runtime/step/integrators.hpp"

namespace cdot {
namespace {

// One list for both directions, to and from what is kept. A call of memcpy costs more than a few numbers.
template <bool keep, class Number>
inline Number* copy(Number* here, Number* kept, int count) {
  Number* __restrict to = keep ? kept : here, * __restrict from = keep ? here : kept;
  if (static_cast<size_t>(count) * sizeof(Number) > 48)
    std::memcpy(to, from, static_cast<size_t>(count) * sizeof(Number));
  else
    for (int k = 0; k < count; ++k) to[k] = from[k];
  return kept + count;
}

template <bool keep, class S>
void copy_bodies(WorldState<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  Kept<S>& kept = island.kept;
  auto* pose = kept.pose.data();
  auto* velocity = kept.velocity.data();
  for (const auto& [first, count] : kept.runs) {
    pose = copy<keep>(all.pose.data() + first, pose, count);
    velocity = copy<keep>(all.velocity.data() + first, velocity, count);
  }
  for (size_t k = 0; k < kept.effective_mass.size(); ++k)
    copy<keep>(&all.effective_mass[static_cast<size_t>(island.bodies[k])], &kept.effective_mass[k], 1);
}

// Tensors in world axes follow from the poses; momenta have a history.
template <bool keep, class S>
void copy_gyroscopes(WorldState<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for (size_t k = 0; k < island.kept.gyroscopes.size(); ++k) {
    auto& gyroscope = world.gyroscopes[static_cast<size_t>(island.gyroscopes[k])];
    auto& kept = island.kept.gyroscopes[k];
    const auto i = static_cast<size_t>(gyroscope.body);
    if (!keep) S::set_inertia(gyroscope, all.pose[i], all.inverse_mass[i], all.velocity[i]);
    if (!keep && island.kept.effective_mass.empty()) all.effective_mass[i] = all.inverse_mass[i];
    copy<keep>(&gyroscope.momentum, &kept.momentum, 1);
    copy<keep>(&gyroscope.spin, &kept.spin, 1);
    copy<keep>(&all.acceleration[i], &kept.acceleration, 1);
  }
}

template <bool keep, class S>
void copy_rows(Island<S>& island) {
  auto* kept = island.kept.rows.data();
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows, counters = batch.ops->counters, count = segment.end - segment.begin;
    kept = copy<keep>(batch.lambda.data() + segment.begin * rows, kept, count * rows);
    kept = copy<keep>(batch.correction.data() + segment.begin * rows, kept, count * rows);
    if (counters > 0) kept = copy<keep>(batch.counters.data() + segment.begin * counters, kept, count * counters);
  }
}

// What the end of the step before left for this one: J at these poses, and the factor of a method that begins with it.
template <class S>
void compute_again(WorldState<S>& world, Island<S>& island) {
  island.factored = false;
  if (!island.evaluated) return;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies,
                                 typename S::Scalar(world.kept_time));
  if (stepper_of<S>(world.settings.integrator).starts_from_factor) island.solver->factor(world, island);
}

template <bool keep, class S>
void copy_island(WorldState<S>& world, Island<S>& island) {
  Kept<S>& kept = island.kept;
  copy_bodies<keep>(world, island);
  if constexpr (S::has_gyroscopes) copy_gyroscopes<keep>(world, island);
  copy_rows<keep>(island);
  copy<keep>(&island.residual, &kept.residual, 1);
  copy<keep>(&island.redundant_rows, &kept.redundant_rows, 1);
  copy<keep>(&island.evaluated, &kept.evaluated, 1);
  if (!keep) compute_again(world, island);
  auto& dependent = StateList::dependent(island.system);
  copy<keep>(dependent.data(), kept.dependent.data(), static_cast<int>(kept.dependent.size()));
}

}  // namespace

template <class S>
void prepare_to_keep(Island<S>& island) {
  Kept<S>& kept = island.kept;
  for (int body : island.bodies) {
    if (kept.runs.empty() || kept.runs.back().first + kept.runs.back().second != body) kept.runs.push_back({body, 0});
    ++kept.runs.back().second;
  }
  kept.pose.resize(island.bodies.size());
  kept.velocity.resize(island.bodies.size());
  if (island.stiffened) kept.effective_mass.resize(island.bodies.size());
  kept.gyroscopes.resize(island.gyroscopes.size());
  size_t numbers = 0;
  for (const Segment<S>& segment : island.segments)
    numbers += static_cast<size_t>((segment.end - segment.begin) *
                                   (2 * segment.batch->ops->rows + segment.batch->ops->counters));
  kept.rows.resize(numbers);
  kept.dependent.resize(StateList::dependent(island.system).size());
}

template <class S>
void keep_state(WorldState<S>& world) {
  world.kept_time = world.time;
  world.kept_last_step = world.last_step;
  world.kept_counts = world.counts;
  world.broken_in_step.clear();
  for (int index : world.awake) copy_island<true>(world, world.islands[index]);
}

template <class S>
void put_state_back(WorldState<S>& world) {
  for (const auto& hook : world.after_substep) hook.undo(world);
  for (int index : world.awake) {
    Island<S>& island = world.islands[index];
    copy_island<false>(world, island);
    island.system.slacken();
    island.trouble = StepProblem::none;
    island.flow.forget();
  }
  // What pushes an immovable body adds 0 to it, unless it is infinite.
  Bodies<S>& all = world.bodies;
  for (int i = 0; i < all.count(); ++i)
    if (all.immovable(i)) all.velocity[i] = all.velocity_rate[i] = all.displacement[i] = all.increment[i] = {};
  world.time = world.kept_time;
  world.last_step = world.kept_last_step;
  world.counts = world.kept_counts;
}

#define CDOT_INSTANTIATE(S)                  \
  template void prepare_to_keep(Island<S>&); \
  template void keep_state(WorldState<S>&);  \
  template void put_state_back(WorldState<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
