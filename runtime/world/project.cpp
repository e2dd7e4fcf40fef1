// Projects the initial state: full Newton on C, then the velocities, each by the least change in the metric of the
// masses. (solve/projection.cpp corrects the drift of one step with that step's J.)
#include <algorithm>
#include <cmath>

#include <cdot/world.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"

namespace cdot {
namespace {

constexpr int newton_rounds = 50;

template <class S>
void solve_and_exert(WorldData<S>& world, Island<S>& island, typename S::Velocity* to) {
  island.system.assemble(world.bodies);
  island.system.factor();
  island.system.solve();
  island.system.store([](Batch<S>& batch, int i, auto lambda) { batch.impulse[i] = typename S::Scalar(lambda); });
  exert(world, island, island.system, &BatchWorkspace<S>::impulse, to);
}

template <class S>
void evaluate(WorldData<S>& world, Island<S>& island) {
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies,
                                 typename S::Scalar(world.time));
}

// Batch::error = the law's error, or C of exact rows; 0 for rows that are no constraints.
template <class S>
void measure_errors(Island<S>& island) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      auto* error = batch.error.data() + slot * rows;
      if (batch.law && batch.law->error) batch.law->error(batch, slot, error);
      else
        for (int r = 0; r < rows; ++r) error[r] = batch.law ? 0 : batch.C[slot * rows + r];
    }
  }
}

template <class S>
void move_poses(WorldData<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.increment[i] = {};
  solve_and_exert(world, island, all.increment.data());
  for (int i : island.bodies) {
    all.pose[i] = S::moved(all.pose[i], all.increment[i]);
    all.increment[i] = {};
  }
  // Keeps the scene's velocities while the poses move.
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) {
      S::set_inertia(gyroscope, all.pose[i], all.inverse_mass[i], all.velocity[i]);
      all.effective_mass[i] = all.inverse_mass[i];
    });
}

template <class S>
void project_poses(WorldData<S>& world, Island<S>& island) {
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < newton_rounds; ++round) {
    evaluate(world, island);
    measure_errors(island);
    double worst = 0;
    load_errors(island.system, typename S::Scalar(-1));
    island.system.each_row(
        [&](int, const Batch<S>& batch, int i) { worst = std::max(worst, std::abs(double(batch.error[i]))); });
    // Round-off is reached when the error no longer shrinks.
    if (worst == 0 || (worst < 1e-6 && worst >= before)) return;
    before = worst;
    island.system.choose([](const Batch<S>& batch, int i) { return !batch.law || batch.error[i] != 0; });
    move_poses(world, island);
  }
}

template <class S>
void project_velocities(WorldData<S>& world, Island<S>& island, double tolerance) {
  Bodies<S>& all = world.bodies;
  evaluate(world, island);
  load_rates(island, island.system, all.velocity.data());
  island.system.choose([&](const Batch<S>& batch, int i) {
    if (!batch.law) return true;
    if (!batch.law->reported) return false;
    return batch.kinds[i % batch.ops->rows] != RowKind::inequality ||
           (batch.C[i] <= tolerance && batch.rate[i] + batch.bias[i] < 0);
  });
  solve_and_exert(world, island, all.velocity.data());
}

}  // namespace

template <class S>
bool BasicWorld<S>::project(double tolerance) {
  prepare();
  for (auto& island : data_->islands) {
    if (island.segments.empty()) continue;
    if (!island.system.built()) island.system.build(island.segments, data_->bodies);
    project_poses(*data_, island);
    project_velocities(*data_, island, tolerance);
    island.evaluated = island.factored = false;
    island.flow.forget();
  }
  return inconsistencies(tolerance).empty();
}

#define CDOT_INSTANTIATE(S) template bool BasicWorld<S>::project(double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
