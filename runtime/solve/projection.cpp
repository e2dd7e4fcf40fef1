// Newton on C and the projection of velocities, for one island: what Drift::projection and the integrators at
// acceleration level share.
#include "runtime/solve/projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/solve.hpp"

namespace cdot {
namespace {

constexpr int newton_rounds = 20;
// What a round may leave of the error: less, and any is down to round-off when the rounds end, 0.2^19 being 5e-14. In
// continuous time a step that needs new directions is rather too long: its error control is to find that.
constexpr double enough = 0.2, enough_in_continuous_time = 0.5;

// What is wrong with a row under a law: for an island in continuous time only rows that are held have to be at their
// end.
template <class S>
void error_of_law(const Island<S>& island, const Batch<S>& batch, int slot, typename S::Scalar* error) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  if (!island.continuous && batch.law->error) return batch.law->error(batch, slot, error);
  std::fill_n(error, rows, T(0));
  if (!island.continuous || !batch.law->guard) return;
  Guard<T> guards[most_rows];
  batch.law->guard(batch, slot, guards);
  for (int r = 0; r < rows; ++r)
    if (batch.mode[slot * rows + r] == Mode::held) error[r] = guards[r].off_by;
}

// A row that has something to correct.
template <class S>
bool has_error(const Batch<S>& batch, int i) {
  if (!batch.law || batch.mode[i] == Mode::held) return true;
  return batch.mode[i] == Mode::bounded && batch.scratch[i] != 0;
}

// Takes rows out of the system that have nothing to correct.
template <class S>
void factor_rows_with_errors(Island<S>& island) {
  island.system.choose(has_error<S>);
  island.system.factor();
}

// K lambda = -C, q += M^-1 J^T lambda.
template <class S>
void move_by_newton(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  island.system.load([](const Batch<S>& batch, int i) { return -batch.scratch[i]; });
  island.system.solve();
  apply_solution(world, island, all.increment.data());
  for (int i : island.bodies) {
    all.pose[i] = S::moved(all.pose[i], all.increment[i]);
    all.displacement[i] = S::sum(all.displacement[i], all.increment[i], T(1));
    all.increment[i] = {};
  }
}

// `fresh`: J and K are not yet those of the step. Where they leave more than `enough` of the error they are renewed,
// and where new ones do not halve it the joints contradict each other, round-off is reached, or the step went too far.
template <class S>
void newton(WorldState<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  using T = typename S::Scalar;
  T before = std::numeric_limits<T>::infinity();
  bool renewed = false;
  // Forces that are known move nothing here.
  island.system.give([](const Batch<S>&, int) { return 0.0; });
  // Without laws, and in continuous time, the solve before has left just this factor.
  const bool other_rows = island.system.lawful() && !island.continuous;
  for (int round = 0;; ++round) {
    const T worst = find_errors(world, island, time);
    island.residual = worst;
    if (!(worst > converged<T> * island.scale) || round == newton_rounds) return;
    // Bounds that were within reach when the rows were chosen, and are passed now. What has come in stays.
    const bool more = round > 0 && other_rows && island.system.choose_more(has_error<S>);
    const bool slow = !more && worst > T(island.continuous ? enough_in_continuous_time : enough) * before;
    if (slow && renewed && worst > T(0.5) * before) return;
    if (slow || (fresh && round == 0)) {
      evaluate_anew(world, island, time);
      island.system.assemble(world.bodies);
      renewed |= slow;
    }
    if (round == 0 && (fresh || other_rows)) factor_rows_with_errors(island);
    else if (more || slow) island.system.factor();
    before = worst;
    move_by_newton(world, island);
  }
}

// The largest error that a sweep met on its way.
template <class S>
typename S::Scalar errors_met(const Island<S>& island) {
  typename S::Scalar worst = 0;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    if (batch.law) continue;
    const int rows = batch.ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) worst = std::max(worst, std::abs(batch.C[i]));
  }
  return worst;
}

// In continuous time only where a row is held: one that is out of reach must be seen to pass.
template <class S>
void sweep_lawful_poses(WorldState<S>& world, const Island<S>& island, const Segment<S>& segment,
                        typename S::Scalar time) {
  Batch<S>& batch = *segment.batch;
  if (!batch.law->error) return;
  if (!island.continuous) return batch.ops->correct_bounded(batch, segment.begin, segment.end, world.bodies, time);
  for (int slot = segment.begin; slot < segment.end; ++slot) {
    const auto mode = batch.mode.begin() + slot * batch.ops->rows;
    if (std::find(mode, mode + batch.ops->rows, Mode::held) != mode + batch.ops->rows)
      batch.ops->correct_bounded(batch, slot, slot + 1, world.bodies, time);
  }
}

// Where a sweep meets larger errors than the one before, the directions of the step's J mislead:
// they are renewed.
template <class S>
void sweep_poses(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  T first = std::numeric_limits<T>::infinity();
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->correct(batch, segment.begin, segment.end, world.bodies, time);
      else sweep_lawful_poses(world, island, segment, time);
    }
    const T met = errors_met(island);
    if (sweep == 0) first = met;
    if (met > T(2) * first) {
      evaluate_anew(world, island, time);
      factorize_rows(world, island);
      first = met;
    }
  }
  island.residual = find_errors(world, island, time);
}

// Rows that are not held keep the impulse that they have.
template <class S>
void bound_for_velocities(const Island<S>& island) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) {
      const bool held = batch.mode[i] == Mode::held;
      batch.softness[i] = 0;
      batch.lower[i] = held ? -std::numeric_limits<T>::infinity() : batch.lambda[i];
      batch.upper[i] = held ? std::numeric_limits<T>::infinity() : batch.lambda[i];
    }
  }
}

// Adds to the bias `share` of the rates that laws want of rows that are held.
template <class S>
void add_wanted_rates(const Island<S>& island, typename S::Scalar share) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->guard) continue;
    Guard<T> guards[most_rows];
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      batch.law->guard(batch, slot, guards);
      for (int r = 0; r < batch.ops->rows; ++r) batch.bias[slot * batch.ops->rows + r] += share * guards[r].rate;
    }
  }
}

template <class S>
void solve_velocities(WorldState<S>& world, Island<S>& island) {
  System<S>& system = island.system;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, world.bodies.velocity.data(),
                                 segment.batch->scratch.data());
  system.load([](const Batch<S>& batch, int i) { return -(batch.scratch[i] + batch.bias[i]); });
  system.choose([](const Batch<S>& batch, int i) { return !batch.law || batch.mode[i] == Mode::held; });
  system.assemble(world.bodies);
  island.redundant_rows = system.factor();
  system.solve();
  apply_solution(world, island, world.bodies.velocity.data());
}

template <class S>
void sweep_velocities(WorldState<S>& world, Island<S>& island) {
  factorize_rows(world, island);
  if (island.continuous) bound_for_velocities(island);
  for (int sweep = 0; sweep < world.settings.iterations; ++sweep) {
    for (const Segment<S>& segment : island.segments) {
      Batch<S>& batch = *segment.batch;
      if (!batch.law) batch.ops->iterate(batch, segment.begin, segment.end, world.bodies, batch.correction.data());
      else if (island.continuous) batch.ops->iterate_bounded(batch, segment.begin, segment.end, world.bodies);
    }
  }
}

}  // namespace

template <class S>
void clear_correction(WorldState<S>& world, Island<S>& island) {
  for (int i : island.bodies) world.bodies.displacement[i] = {};
  for (const Segment<S>& segment : island.segments) {
    auto& correction = segment.batch->correction;
    const int rows = segment.batch->ops->rows;
    std::fill(correction.begin() + segment.begin * rows, correction.begin() + segment.end * rows,
              typename S::Scalar(0));
  }
}

template <class S>
typename S::Scalar find_errors(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  T worst = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    batch.ops->position(batch, segment.begin, segment.end, world.bodies, time);
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      T* error = batch.scratch.data() + slot * rows;
      if (!batch.law) std::copy_n(batch.C.data() + slot * rows, rows, error);
      else error_of_law(island, batch, slot, error);
      for (int r = 0; r < rows; ++r) worst = std::max(worst, std::abs(error[r]));
    }
  }
  return worst;
}

template <class S>
void solve_errors(Island<S>& island, typename S::Scalar share) {
  island.system.load([&](const Batch<S>& batch, int i) { return share * batch.scratch[i]; });
  if (island.system.lawful()) factor_rows_with_errors(island);
  island.system.solve();
}

// What brings a state of continuous time back onto its joints is the method's error, not an impulse of theirs.
template <class S>
void apply_solution(WorldState<S>& world, Island<S>& island, typename S::Velocity* to) {
  using T = typename S::Scalar;
  island.system.store([&](Batch<S>& batch, int i, auto lambda) {
    batch.scratch[i] = T(lambda);
    if (!island.continuous) batch.correction[i] += T(lambda);
  });
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies, segment.batch->scratch.data(),
                              to);
  island.system.pull(world.bodies, to);
}

template <class S>
void evaluate_anew(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  if constexpr (S::has_gyroscopes) {
    if (island.continuous) set_inertias(world, island);
    else turn_inertias(world, island);
  }
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, time);
}

template <class S>
void fill_lambda(const Island<S>& island, typename S::Scalar value) {
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    auto& lambda = segment.batch->lambda;
    std::fill(lambda.begin() + segment.begin * rows, lambda.begin() + segment.end * rows, value);
  }
}

template <class S>
void scale_corrections(const Island<S>& island, typename S::Scalar by) {
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i) segment.batch->correction[i] *= by;
  }
}

template <class S>
void add_corrections(WorldState<S>& world, Island<S>& island, typename S::Scalar per_time) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.velocity[i] = S::sum(all.velocity[i], all.displacement[i], per_time);
  scale_corrections(island, per_time);
}

template <class S>
void hold_poses(WorldState<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  if (world.settings.solver == Solver::direct) return newton(world, island, time, fresh);
  if (fresh) {
    evaluate_anew(world, island, time);
    factorize_rows(world, island);
  }
  sweep_poses(world, island, time);
}

// What numbers of the size of the poses leave of C, at most about.
template <class S>
typename S::Scalar round_off(const WorldState<S>& world, const Island<S>& island) {
  using T = typename S::Scalar;
  T farthest = 0, numbers[S::pose_numbers];
  for (int i : island.bodies) {
    S::write(world.bodies.pose[i], numbers);
    for (T number : numbers) farthest = std::max(farthest, std::abs(number));
  }
  return T(64) * std::numeric_limits<T>::epsilon() * farthest;
}

template <class S>
bool left_the_joints(const WorldState<S>& world, const Island<S>& island, typename S::Scalar at_start) {
  using T = typename S::Scalar;
  const bool holds = world.settings.drift == Drift::projection && world.settings.solver == Solver::direct;
  if (!holds || island.segments.empty() || island.residual <= T(2) * at_start) return false;
  const T told = foreign<T> * std::max(island.size, island.scale);
  return !(island.residual <= T(2) * std::max(told, round_off(world, island)));
}

template <class S>
void tell_joints_apart(const WorldState<S>& world, Island<S>& island, typename S::Scalar at_start) {
  if (!left_the_joints(world, island, at_start)) return;
  typename System<S>::Real shared = 0;
  for (int r = 0; r < island.system.rows(); ++r) shared = std::max(shared, std::abs(island.system.unmet(r)));
  if (!(island.residual <= 2 * shared)) island.trouble = StepProblem::joints_apart;
}

template <class S>
bool bends_the_path(const WorldState<S>& world, const Island<S>& island, double h) {
  const Bodies<S>& all = world.bodies;
  double moved = 0, way = 0;
  for (int i : island.bodies) {
    const auto& m = all.inverse_mass[i];
    moved += S::dot(S::force(m, all.displacement[i]), all.displacement[i]);
    way += S::dot(S::force(m, all.velocity[i]), all.velocity[i]);
  }
  return 4 * moved <= h * h * way;
}

template <class S>
void hold_velocities(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (island.continuous) add_wanted_rates(island, T(-1));
  if (world.settings.solver == Solver::direct) solve_velocities(world, island);
  else sweep_velocities(world, island);
  if (island.continuous) add_wanted_rates(island, T(1));
}

#define CDOT_INSTANTIATE(S)                                                         \
  template void clear_correction(WorldState<S>&, Island<S>&);                       \
  template S::Scalar find_errors(WorldState<S>&, Island<S>&, S::Scalar);            \
  template void solve_errors(Island<S>&, S::Scalar);                                \
  template void apply_solution(WorldState<S>&, Island<S>&, S::Velocity*);           \
  template void fill_lambda(const Island<S>&, S::Scalar);                           \
  template void scale_corrections(const Island<S>&, S::Scalar);                     \
  template void add_corrections(WorldState<S>&, Island<S>&, S::Scalar);             \
  template void evaluate_anew(WorldState<S>&, Island<S>&, S::Scalar);               \
  template void hold_poses(WorldState<S>&, Island<S>&, S::Scalar, bool);            \
  template bool left_the_joints(const WorldState<S>&, const Island<S>&, S::Scalar); \
  template void tell_joints_apart(const WorldState<S>&, Island<S>&, S::Scalar);     \
  template bool bends_the_path(const WorldState<S>&, const Island<S>&, double);     \
  template void hold_velocities(WorldState<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
