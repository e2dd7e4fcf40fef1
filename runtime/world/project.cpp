// Projects the initial state: full Newton on C, then the velocities, each by the least change in the metric of the
// masses. (solve/projection.cpp corrects the drift of one step with that step's J.)
#include <algorithm>
#include <cmath>

#include <cdot/world.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/longest_move.hpp"

namespace cdot {
namespace {

constexpr int newton_rounds = 50, most_refinements = 4;
// Of rows that count as redundant, in the projection of an island; each costs a solve. Beyond, nothing moves.
constexpr int most_drops = 64;
// The share of J v + dC/dt that a projection of velocities may leave.
template <class T>
constexpr double rough = by_precision<T>(1e-5, 1e-12);

// Adds M^-1 J^T lambda with K lambda = b to `to`. If that moves bodies too far for the largest `error`, the rows that
// ask for it count as redundant, at most `drops` of them, and the result says so; `moves` is scratch.
template <class S>
void solve_and_exert(WorldData<S>& world, Island<S>& island, double error, int& drops, ProjectResult& result,
                     typename S::Velocity* to) {
  auto& moves = world.bodies.increment;
  island.system.assemble(world.bodies);
  island.system.factor();
  for (;;) {
    island.system.solve();
    island.system.store([](Batch<S>& batch, int i, auto lambda) { batch.impulse[i] = typename S::Scalar(lambda); });
    for (int i : island.bodies) moves[i] = {};
    exert(world, island, island.system, &BatchWorkspace<S>::impulse, moves.data());
    const LongestMove move = longest_move<S>(island, moves);
    if (!too_far(island, move, error)) break;
    if (!result.refused) result.body = move.body, result.moved = move.way, result.misfit = error;
    result.refused = true;
    if (drops-- > 0 && island.system.drop_dominant_row()) continue;
    for (int i : island.bodies) moves[i] = {};  // nothing moves
    break;
  }
  for (int i : island.bodies) {
    to[i] = S::sum(to[i], moves[i], typename S::Scalar(1));
    moves[i] = {};
  }
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

// The scene's velocities stay while the poses move.
template <class S>
void keep_velocities(WorldData<S>& world, Island<S>& island) {
  Bodies<S>& all = world.bodies;
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) {
      S::set_inertia(gyroscope, all.pose[i], all.inverse_mass[i], all.velocity[i]);
      all.effective_mass[i] = all.inverse_mass[i];
    });
}

template <class S>
LongestMove move_poses(WorldData<S>& world, Island<S>& island, double error, int& drops, ProjectResult& result) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.displacement[i] = {};
  solve_and_exert(world, island, error, drops, result, all.displacement.data());
  for (int i : island.bodies) all.pose[i] = S::moved(all.pose[i], all.displacement[i]);
  keep_velocities(world, island);
  return longest_move<S>(island, all.displacement);
}

// The largest error of the selected rows, as value(batch, i). Remembers its row while nothing is refused.
template <class S, class F>
double largest_error(Island<S>& island, ProjectResult& result, F value) {
  double worst = 0;
  island.system.each_row([&](int row, const Batch<S>& batch, int i) {
    const double error = std::abs(double(value(batch, i)));
    if (island.system.fixed[row] || island.system.broken[row] || !(error > worst)) return;
    worst = error;
    if (!result.refused) result.joint = batch.joint[i / batch.ops->rows], result.row = i % batch.ops->rows;
  });
  return worst;
}

// Many short ways must not add up to a long one either: that leaves the poses as they were.
template <class S>
void project_poses(WorldData<S>& world, Island<S>& island, ProjectResult& result) {
  std::vector<typename S::Pose> start;
  for (int i : island.bodies) start.push_back(world.bodies.pose[i]);
  LongestMove sum;
  double before = std::numeric_limits<double>::infinity(), first = 0;
  int drops = most_drops;
  for (int round = 0; round < newton_rounds; ++round) {
    evaluate(world, island);
    measure_errors(island);
    load_errors(island.system, typename S::Scalar(-1));
    island.system.choose([](const Batch<S>& batch, int i) { return !batch.law || batch.error[i] != 0; });
    const double worst = largest_error(island, result, [](const Batch<S>& batch, int i) { return batch.error[i]; });
    // Round-off is reached when the error no longer shrinks. Contradicting joints keep an error.
    if (worst == 0 || ((worst < 1e-6 || result.refused) && worst >= before)) return;
    before = worst;
    if (round == 0) first = worst;
    const LongestMove move = move_poses(world, island, worst, drops, result);
    sum = {sum.way + move.way, move.body};
    if (!too_far(island, sum, first)) continue;
    if (!result.refused) result.body = sum.body, result.moved = sum.way, result.misfit = first;
    result.refused = true;
    for (size_t k = 0; k < start.size(); ++k) world.bodies.pose[island.bodies[k]] = start[k];
    keep_velocities(world, island);
    return;
  }
}

template <class S>
void project_velocities(WorldData<S>& world, Island<S>& island, double tolerance, ProjectResult& result) {
  Bodies<S>& all = world.bodies;
  evaluate(world, island);
  load_rates(island, island.system, all.velocity.data());
  island.system.choose([&](const Batch<S>& batch, int i) {
    if (!batch.law) return true;
    if (!batch.law->reported) return false;
    return batch.kinds[i % batch.ops->rows] != RowKind::inequality ||
           (batch.C[i] <= tolerance && batch.rate[i] + batch.bias[i] < 0);
  });
  const auto rate = [](const Batch<S>& batch, int i) { return batch.rate[i] + batch.bias[i]; };
  // A solve leaves round-off of impulses that cancel, on bodies much lighter than others. More solves take that off.
  double first = 0, before = std::numeric_limits<double>::infinity();
  int drops = most_drops;
  for (int round = 0; round <= most_refinements && !result.refused; ++round) {
    if (round > 0) load_rates(island, island.system, all.velocity.data());
    const double worst = largest_error(island, result, rate);
    if (round == 0) first = worst;
    else if (!(worst > rough<typename S::Scalar> * first && worst < 0.5 * before)) return;
    before = worst;
    solve_and_exert(world, island, worst, drops, result, all.velocity.data());
  }
}

}  // namespace

template <class S>
ProjectResult BasicWorld<S>::project(double tolerance) {
  prepare();
  note_change(*data_);
  ProjectResult result;
  for (auto& island : data_->islands) {
    if (island.segments.empty()) continue;
    if (!island.system.built()) island.system.build(island.segments, data_->bodies);
    project_poses(*data_, island, result);
    project_velocities(*data_, island, tolerance, result);
    island.evaluated = island.factored = false;
    island.flow.forget();
  }
  result.met = inconsistencies(tolerance).empty() && passed_ends(tolerance).empty();
  return result;
}

#define CDOT_INSTANTIATE(S) template ProjectResult BasicWorld<S>::project(double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
