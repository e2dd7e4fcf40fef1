// Drift::projection: Newton on C with the J and K of the step (SHAKE), the displacement over h
// added to the velocities and these projected onto J v = -dC/dt at the new poses. Moving the poses
// alone would drain energy at first order: every step turns the velocity out of the tangent plane,
// and what the next solve cuts off is gone.
#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/spaces.hpp"
#include "runtime/stages.hpp"

namespace cdot {
namespace {

// C this small is left alone, in metres and radians: mechanisms are of the order of 1 m.
template <class T>
constexpr T converged = std::is_same_v<T, double> ? T(1e-13) : T(1e-6);
// C of this size at the start of a step came from outside (a pose that was set, joints that
// contradict each other), not from the motion of the last step: correcting it must not change
// velocities.
template <class T>
constexpr T foreign = std::is_same_v<T, double> ? T(1e-8) : T(1e-4);
constexpr int newton_rounds = 20;

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

// What of C is to be removed, into the batches' scratch; 0 for rows that have nothing to correct.
// Returns its largest entry.
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
      if (!batch.law)
        std::copy_n(batch.C.data() + slot * rows, rows, error);
      else if (batch.law->error)
        batch.law->error(batch, slot, error);
      else
        std::fill_n(error, rows, T(0));
      for (int r = 0; r < rows; ++r) worst = std::max(worst, std::abs(error[r]));
    }
  }
  return worst;
}

template <class S>
void evaluate_anew(WorldState<S>& world, Island<S>& island, typename S::Scalar time) {
  if constexpr (S::has_gyroscopes) turn_inertias(world, island);
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, time);
}

// Takes rows out of the system that have nothing to correct.
template <class S>
void factor_rows_with_errors(Island<S>& island) {
  island.system.choose(
      [](const Batch<S>& batch, int i) { return !batch.law || batch.scratch[i] != 0; });
  island.system.factor();
}

// K lambda = what was loaded, with the factor at hand; `moved` += M^-1 J^T lambda.
template <class S>
void solve_and_apply(WorldState<S>& world, Island<S>& island, typename S::Velocity* moved) {
  using T = typename S::Scalar;
  island.system.solve();
  island.system.store([](Batch<S>& batch, int i, double lambda) {
    batch.scratch[i] = T(lambda);
    batch.correction[i] += T(lambda);
  });
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->apply(*segment.batch, segment.begin, segment.end, world.bodies,
                              segment.batch->scratch.data(), moved);
}

// K lambda = -C, q += M^-1 J^T lambda.
template <class S>
void move_by_newton(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  island.system.load([](const Batch<S>& batch, int i) { return -double(batch.scratch[i]); });
  solve_and_apply(world, island, all.increment.data());
  for (int i : island.bodies) {
    all.pose[i] = S::moved(all.pose[i], all.increment[i]);
    all.displacement[i] = S::sum(all.displacement[i], all.increment[i], T(1));
    all.increment[i] = {};
  }
}

// `fresh`: J and K are not yet those of the step. Where the error does not halve they are
// renewed, and where that does not help the joints contradict each other or round-off is reached.
template <class S>
void newton(WorldState<S>& world, Island<S>& island, typename S::Scalar time, bool fresh) {
  using T = typename S::Scalar;
  T before = std::numeric_limits<T>::infinity();
  bool renewed = false;
  for (int round = 0; round < newton_rounds; ++round) {
    T worst = find_errors(world, island, time);
    island.residual = worst;
    if (!(worst > converged<T>)) return;
    const bool slow = worst > T(0.5) * before;
    if (slow && renewed) return;
    if (slow || (fresh && round == 0)) {
      evaluate_anew(world, island, time);
      island.system.assemble(world.bodies);
      renewed = slow;
    }
    // Without laws the velocity solve has left just this factor.
    if (slow || (round == 0 && (fresh || island.system.lawful()))) factor_rows_with_errors(island);
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
    for (int i = segment.begin * rows; i < segment.end * rows; ++i)
      worst = std::max(worst, std::abs(batch.C[i]));
  }
  return worst;
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
      if (!batch.law)
        batch.ops->correct(batch, segment.begin, segment.end, world.bodies, time);
      else if (batch.law->error)
        batch.ops->correct_bounded(batch, segment.begin, segment.end, world.bodies, time);
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

// Velocities onto J v = -dC/dt at the present poses: exact rows only, the others see to it in the
// next step.
template <class S>
void project_velocities(WorldState<S>& world, Island<S>& island, bool direct) {
  Bodies<S>& all = world.bodies;
  if (!direct) {
    factorize_rows(world, island);
    for (int sweep = 0; sweep < world.settings.iterations; ++sweep)
      for (const Segment<S>& segment : island.segments)
        if (!segment.batch->law)
          segment.batch->ops->iterate(*segment.batch, segment.begin, segment.end, all,
                                      segment.batch->correction.data());
    return;
  }
  System<S>& system = island.system;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, all.velocity.data(),
                                 segment.batch->scratch.data());
  system.load([](const Batch<S>& batch, int i) { return -(batch.scratch[i] + batch.bias[i]); });
  system.choose([](const Batch<S>& batch, int) { return !batch.law; });
  system.assemble(all);
  island.redundant_rows = system.factor();
  solve_and_apply(world, island, all.velocity.data());
}

// What bends a path back onto its curve is a small part of the way: 2 |displacement| <= |h v| in
// the metric of the masses. More than that (a passage through a singular pose, a step far too
// large) would be thrown in as energy.
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

// Displacements and their impulses become those of velocities.
template <class S>
void add_corrections(WorldState<S>& world, Island<S>& island, typename S::Scalar per_time) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies)
    all.velocity[i] = S::sum(all.velocity[i], all.displacement[i], per_time);
  for (const Segment<S>& segment : island.segments) {
    const int rows = segment.batch->ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i)
      segment.batch->correction[i] *= per_time;
  }
}

}  // namespace

template <class S>
void settle_poses(WorldState<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  if (!(island.residual > foreign<T>)) return;
  const T time = T(world.time);
  clear_correction(world, island);
  if (world.settings.solver == Solver::direct) {
    newton(world, island, time, true);
  } else {
    evaluate_anew(world, island, time);
    factorize_rows(world, island);
    sweep_poses(world, island, time);
  }
  island.evaluated = island.factored = false;
}

template <class S>
void correct_drift(WorldState<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  const bool direct = world.settings.solver == Solver::direct;
  const T time = T(world.time) + h;
  clear_correction(world, island);
  // What the start of the step could not correct (joints that contradict each other, too few
  // sweeps) is not motion.
  const T foreign_error = island.residual, error = find_errors(world, island, time);
  const bool from_motion = foreign_error <= T(0.1) * error;
  if (direct)
    newton(world, island, time, false);
  else
    sweep_poses(world, island, time);
  const bool keep = from_motion && bends_the_path(world, island, double(h));
  add_corrections(world, island, keep ? T(1) / h : T(0));
  evaluate_anew(world, island, time);
  project_velocities(world, island, direct);
  island.evaluated = true;
  island.factored = direct && !island.system.lawful();
}

#define CDOT_INSTANTIATE(S)                               \
  template void settle_poses(WorldState<S>&, Island<S>&); \
  template void correct_drift(WorldState<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
