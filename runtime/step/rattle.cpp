// RATTLE: half a kick with impulses along J of the start, such that C = 0 after the drift. Then the drift. Then half a
// kick with impulses along J of the end, such that J v = -dC/dt there. Second order and symmetric, so energy errors do
// not accumulate. (H. C. Andersen, J. Comput. Phys. 52, 1983.) Limits, motors and friction act at the end of the step,
// at first order.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/direct.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

constexpr int most_in_vain = 4;  // rounds that do not reduce the error
// The goal of Newton, because a remaining C changes the velocities by C / h.
template <class T>
constexpr T round_off = T(by_precision<T>(1e-7, 1e-15));

// Velocity rows have no C for the first half of a step: it repeats their impulses from the second half of the last
// step. A start from 0 would alternate between 0 and twice the impulse forever. The start is therefore half of their
// impulse in h.
template <class S>
void exert_at_start(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    for (int i = segment.begin * batch.ops->rows; batch.law && i < segment.end * batch.ops->rows; ++i)
      batch.softness[i] = batch.lower[i] = batch.upper[i] = T(0);
  }
  const T time = T(world.time);
  accelerate(world, island, time);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i)
      batch.lambda[i] *= batch.law ? T(0) : h / 2;
  }
  evaluate_anew(world, island, time);  // restores dC/dt, which gamma replaced
}

template <class S>
bool has_velocity_rows(const Island<S>& island) {
  return std::any_of(island.segments.begin(), island.segments.end(), [](const Segment<S>& segment) {
    const auto& kinds = segment.batch->kinds;
    return !segment.batch->law && std::find(kinds.begin(), kinds.end(), RowKind::velocity) != kinds.end();
  });
}

// Prepares the start of the step. A state that is not the end of a step is projected, and its exact rows are factored.
// Returns the factor that scales the present impulses to this step: h / last step.
template <class S>
typename S::Scalar begin(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (island.evaluated) return world.last_step > 0 ? h / T(world.last_step) : T(0);
  project_start(world, island);
  evaluate_anew(world, island, typename S::Scalar(world.time));
  clear_correction(world, island);
  project_velocities(world, island);
  fill_lambda(island, T(0));
  island.evaluated = true;
  if (has_velocity_rows(island)) exert_at_start(world, island, h);
  return T(1);
}

// velocity = flow.velocity + h dv/dt of all forces and of springs on coordinates, at the velocities of the bodies.
template <class S>
void kick(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  push_free_bodies(world, island);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->force) continue;
    find_known_forces(world, batch, segment.begin, segment.end, batch.impulse.data());
    batch.ops->apply(batch, segment.begin, segment.end, all, batch.impulse.data(), all.velocity_rate.data());
  }
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    all.velocity[i] = S::sum(island.flow.velocity[k], all.velocity_rate[i], h);
  }
}

// First guess: the joints' impulses at the end of the last step.
template <class S>
void guess_impulses(WorldData<S>& world, Island<S>& island, typename S::Scalar share) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    for (int i = segment.begin * rows; i < segment.end * rows; ++i)
      batch.correction[i] = batch.impulse[i] = share * batch.lambda[i];
    batch.ops->apply(batch, segment.begin, segment.end, world.bodies, batch.impulse.data(),
                     world.bodies.velocity.data());
  }
}

// poses = start + h velocity; bodies with a turning inertia tensor rotate by their mean spin.
template <class S>
void drift(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  Bodies<S>& all = world.bodies;
  const std::vector<typename S::Pose>& start = island.flow.pose;
  for (size_t k = 0; k < start.size(); ++k) all.pose[island.bodies[k]] = start[k];
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island,
                       [&](auto& gyroscope, int i) { S::lend_mean_spin(gyroscope, all.pose[i], all.velocity[i], h); });
  for (int i : island.bodies) all.pose[i] = S::moved(all.pose[i], S::sum({}, all.velocity[i], h));
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) { S::restore_spin(gyroscope, all.velocity[i]); });
}

// True if the half step reversed velocities: 2 |change| > |v| in the metric of the masses.
template <class S>
bool turned_round(const WorldData<S>& world, const Island<S>& island) {
  double change = 0, before = 0;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto& m = world.bodies.inverse_mass[i];
    const auto& start = island.flow.velocity[k];
    const auto d = S::sum(world.bodies.velocity[i], start, typename S::Scalar(-1));
    change += S::dot(S::force(m, d), d);
    before += S::dot(S::force(m, start), start);
  }
  return 4 * change > before;
}

// Repeats K lambda = -C / h with the factor of the start and Broyden's updates, velocity += M^-1 J^T lambda, and the
// drift. False if the error does not shrink because the step is too long. False also if the solution reverses the
// bodies' velocities. That happens where a joint's direction reverses, as that of a rope whose length passes through 0.
template <class S>
bool drift_onto_joints(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T time = T(world.time) + h;
  System<S>& system = island.at_work();
  island.flow.search.begin([&](size_t row) { return system.diagonal(static_cast<int>(row)); });
  T least = std::numeric_limits<T>::infinity();
  bool astray = false;
  for (int vain = 0;;) {
    drift(world, island, h);
    island.residual = find_errors(world, island, time);
    if (!(island.residual > round_off<T> * island.scale)) return !astray || !turned_round(world, island);
    if (island.residual < T(0.7) * least) least = island.residual, vain = 0;
    else if (island.residual <= converged<T> * island.scale)  // round-off may end the rounds early
      return !astray || !turned_round(world, island);
    else if (++vain > most_in_vain) return island.residual <= T(10) * converged<T> * island.scale;
    astray |= vain > 0;
    load_errors(system, T(-1) / h);
    if (system.lawful()) factor_rows_with_errors(system);
    system.solve();
    if (!island.flow.search.next(system.lambda.data())) return false;
    exert_correction(world, island, system, world.bodies.velocity.data());
  }
}

// Motors, limits and friction are solved with the exact rows. Springs have acted as forces.
template <class S>
void bound_rows(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law) continue;
    const int begin = segment.begin * batch.ops->rows, end = segment.end * batch.ops->rows;
    if (batch.law->force) {  // its fill() would add C to the bias, and the next kick reads the bias as dC/dt
      for (int i = begin; i < end; ++i) batch.softness[i] = batch.lower[i] = batch.upper[i] = T(0);
      continue;
    }
    batch.law->fill(batch, segment.begin, segment.end, h, world.settings);
    for (int i = begin; i < end; ++i) {
      batch.lower[i] *= T(0.5);  // the other half acts at the start of the next step
      batch.upper[i] *= T(0.5);
    }
  }
}

// The velocities at the end: J v = -dC/dt, the impulses in lambda.
template <class S>
void solve_end(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  factorize_rows(world, island);
  bound_rows(world, island, h);
  island.factored = false;
  island.solver->velocities(world, island, world.bodies.velocity.data(), typename S::Scalar(1));
}

// Half a kick at the start, with the first guess of the joints' impulses.
template <class S>
void start_half(WorldData<S>& world, Island<S>& island, typename S::Scalar h, typename S::Scalar share) {
  for (size_t k = 0; k < island.bodies.size(); ++k) world.bodies.velocity[island.bodies[k]] = island.flow.velocity[k];
  clear_correction(world, island);
  kick(world, island, h / 2);
  guess_impulses(world, island, share);
}

// For sweeps, and if the drift did not reach C = 0: projects the poses and renews J on the way. Unless the displacement
// is large, displacement / h is added to the velocities and its impulses are kept. Sweeps always add them, because the
// next step corrects the remaining error.
template <class S>
void drift_with_renewed_directions(WorldData<S>& world, Island<S>& island, typename S::Scalar h,
                                   typename S::Scalar at_start) {
  using T = typename S::Scalar;
  drift(world, island, h);
  scale_corrections(island, h);
  island.solver->positions(world, island, T(world.time) + h, false);
  fail_if_open(world, island, at_start);
  const bool keep = !island.solver->exact || correction_is_small(world, island, double(h));
  add_corrections(world, island, keep ? T(1) / h : T(0));
}

}  // namespace

template <class S>
void step_rattle(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  Bodies<S>& all = world.bodies;
  Flow<S>& flow = island.flow;
  const T share = begin(world, island, h), at_start = island.residual;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    flow.pose[k] = all.pose[island.bodies[k]];
    flow.velocity[k] = all.velocity[island.bodies[k]];
  }
  start_half(world, island, h, share);
  const bool by_sweeps = !island.solver->exact;
  if (by_sweeps || !drift_onto_joints(world, island, h)) {
    if (!by_sweeps) start_half(world, island, h, share);
    drift_with_renewed_directions(world, island, h, at_start);
  }
  evaluate_anew(world, island, T(world.time) + h);
  // Forces of the second kick are those at the end's velocity, to second order: 2 v_half - v_start.
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    auto &v = all.velocity[island.bodies[k]], &start = flow.velocity[k];
    const auto half = v;
    v = S::sum(S::sum({}, half, T(2)), start, T(-1));
    start = half;
  }
  kick(world, island, h / 2);
  solve_end(world, island, h);
  island.evaluated = true;
}

template <class S>
void prepare_rattle(Island<S>& island) {
  island.flow.pose.resize(island.bodies.size());
  island.flow.velocity.resize(island.bodies.size());
  island.flow.search.reserve(static_cast<size_t>(island.system.rows()));
}

#define CDOT_INSTANTIATE(S)                                        \
  template void step_rattle(WorldData<S>&, Island<S>&, S::Scalar); \
  template void prepare_rattle(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
