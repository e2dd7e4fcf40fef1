// step(): steps all awake islands, rolls back a failed step, repeats it in parts.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>
#include <cdot/world.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/pieces.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/integrators.hpp"
#include "runtime/world/islands.hpp"
#include "runtime/world/rollback.hpp"

namespace cdot {
namespace {

// One step of all awake islands. Stops at the first one that fails.
template <class S>
StepResult advance(WorldData<S>& world, double h) {
  StepResult result;
  const auto dt = typename S::Scalar(h);
  for (int index : world.awake) {
    Island<S>& island = world.islands[index];
    island.flow.locates = false;
    stepper_of<S>(world.settings.integrator).step(world, island, dt);
    if (island.trouble == StepProblem::none && !finite(world, island)) island.trouble = StepProblem::not_finite;
    // NaN instead of the number may have made the trouble.
    if (world.driven) result.joint = joint_out_of_range(island);
    if (result.joint >= 0) island.trouble = StepProblem::out_of_range;
    if (island.trouble == StepProblem::none) continue;
    result.problem = island.trouble;
    result.island = index;
    return result;
  }
  for (const auto& look : world.after_substep) look(world, dt);
  world.time += h;
  world.last_step = h;
  return result;
}

// One part of a step, itself in parts that end where numbers in time jump.
template <class S>
StepResult advance_by_pieces(WorldData<S>& world, double h) {
  const double end = world.time + h;
  for (double left = h;;) {
    const double length = begin_pieces(world, world.time, h) - world.time;
    if (!(length < left - one_time<typename S::Scalar>(end, h))) return advance(world, left);
    if (const StepResult result = advance(world, length); !result) return result;
    left = end - world.time;
  }
}

// Steps over h in `parts` parts.
template <class S>
StepResult attempt(WorldData<S>& world, double h, int parts) {
  const bool by_pieces = world.driven && !stepper_of<S>(world.settings.integrator).finds_pieces;
  begin_accounts(world);
  for (int k = 0; k < parts; ++k)
    if (const StepResult result = by_pieces ? advance_by_pieces(world, h / parts) : advance(world, h / parts); !result)
      return result;
  return {};
}

// --- failed steps ---

// The largest component of a body's velocity.
template <class S>
double speed_of(const WorldData<S>& world, int body) {
  typename S::Scalar numbers[S::freedom];
  S::write(world.bodies.velocity[body], numbers);
  double speed = 0;
  for (auto number : numbers) speed = std::max(speed, std::abs(double(number)));
  return speed;
}

template <class T>
bool finite(const std::vector<T>& numbers, int begin, int end) {
  return std::all_of(numbers.begin() + begin, numbers.begin() + end, [](T number) { return std::isfinite(number); });
}

// False where an effect has no energy, as a gas spring shorter than 0.
template <class S>
bool has_energy(const Batch<S>& batch, int slot) {
  return !batch.law || !batch.law->energy || std::isfinite(batch.law->energy(batch, slot));
}

// Finds the joint to blame at the start of the step. A kernel that is not finite comes first, then the largest C, then
// the largest force.
template <class S>
void blame_joint(WorldData<S>& world, Island<S>& island, StepResult& result) {
  double worst = -1;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    batch.ops->evaluate(batch, segment.begin, segment.end, world.bodies, typename S::Scalar(world.time));
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      const int rows = batch.ops->rows, width = batch.ops->jacobian_size;
      const bool sound = finite(batch.jacobian, slot * width, (slot + 1) * width) && has_energy(batch, slot);
      for (int i = slot * rows; i < (slot + 1) * rows; ++i) {
        const double off = batch.law ? 0 : std::abs(double(batch.C[i]));
        const double pull = std::abs(double(batch.lambda[i])) + std::abs(double(batch.correction[i]));
        const double guilt = !sound || !std::isfinite(off) ? std::numeric_limits<double>::infinity()
                             : off > 1e-6                  ? 1e100 * (1 + off)
                                                           : pull;
        if (guilt <= worst) continue;
        worst = guilt;
        result.joint = batch.joint[slot], result.row = i - slot * rows;
      }
    }
  }
}

template <class S>
void blame(WorldData<S>& world, StepResult& result) {
  if (result.problem == StepProblem::out_of_range) return;
  Island<S>& island = world.islands[result.island];
  if (result.problem == StepProblem::moved_far) {
    result.misfit = island.misfit, result.moved = island.moved, result.body = island.moved_body;
    return blame_joint(world, island, result);
  }
  for (int body : island.bodies)
    if (result.body < 0 || speed_of(world, body) > speed_of(world, result.body)) result.body = body;
  blame_joint(world, island, result);
}

// Replaces the solver for the next attempts.
template <class S>
void solve_by(WorldData<S>& world, const RowSolver<S>& solver) {
  for (int index : world.awake) {
    Island<S>& island = world.islands[index];
    island.solver = &solver;
    island.evaluated = island.factored = false;
    island.flow.forget();
  }
}

// True if the step succeeds in parts.
template <class S>
bool succeeds_in_parts(WorldData<S>& world, double h, int fewest, StepResult& result) {
  constexpr int most = 16;
  for (int parts = fewest; parts <= most; parts *= 2) {
    result = attempt(world, h, parts * world.settings.substeps);
    if (result) {
      result.parts = parts;
      ++world.counts->retried;
      return true;
    }
    roll_back(world);
  }
  return false;
}

template <class S>
StepResult try_again(WorldData<S>& world, double h) {
  StepResult result;
  const RowSolver<S>& solver = solver_of<S>(world.settings.solver);
  if (succeeds_in_parts(world, h, 2, result) || solver.exact) return result;
  solve_by(world, direct_solver<S>());
  result.direct = succeeds_in_parts(world, h, 1, result);
  if (result.direct) ++world.counts->direct;
  solve_by(world, solver);
  return result;
}

}  // namespace

template <class S>
StepResult BasicWorld<S>::step(double h) {
  WorldData<S>& world = *data_;
  if (!(h > 0) || !std::isfinite(h)) return {.problem = StepProblem::bad_step, .time = world.time, .length = h};
  prepare_topology(world);
  save_state(world);
  const double start = world.time;
  StepResult result = attempt(world, h, world.settings.substeps);
  if (!result) {
    roll_back(world);
    if (world.on_failure == OnFailure::retry && !world.at_once) result = try_again(world, h);
    if (!result && !world.at_once) {
      blame(world, result);
      roll_back(world);  // blame() evaluated rows
    }
  }
  result.time = start, result.length = h;
  if (result) put_to_sleep(world, h);
  return result;
}

#define CDOT_INSTANTIATE(S) template StepResult BasicWorld<S>::step(double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
