// Acceleration level: M dv/dt = f + J^T lambda with J dv/dt = gamma; lambda are forces. Solvers get dv/dt in place of
// velocities and -gamma as bias.
#include <cdot/spaces.hpp>

#include "runtime/motion/motion.hpp"
#include "runtime/solve/cones.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
template <class S>
void find_known_forces(WorldData<S>& world, Batch<S>& batch, int begin, int end, typename S::Scalar* force) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  batch.ops->effective_mass(batch, begin, end, world.bodies);
  batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
  for (int slot = begin; slot < end; ++slot) {
    T rate[most_rows];
    for (int r = 0, i = slot * rows; r < rows; ++r, ++i) {
      batch.acted[i] = batch.rate[i];
      rate[r] = batch.rate[i] + batch.bias[i];
    }
    batch.law->force(batch, slot, rate, force + slot * rows);
  }
}

// The bounds of specs may change: the forces of rows at a bound follow it, and held rows the prescribed rate. A motor
// of unlimited force that ends stop has none.
template <class S>
void follow_bounds(Batch<S>& batch, int begin, int end) {
  Guard<typename S::Scalar> guard[most_rows];
  for (int i = begin; i < end; ++i) {  // a coordinate has one row
    batch.load[i] = 0;                 // the solver finds it
    batch.law->guard(batch, i, guard);
    batch.bias[i] -= guard->acceleration;
    if (guard->bilateral()) continue;
    if (batch.mode[i] == Mode::pushed) batch.lower[i] = batch.upper[i] = guard->upper;
    if (batch.mode[i] == Mode::pulled) batch.lower[i] = batch.upper[i] = guard->lower;
  }
}

template <class S>
void ask_for_gamma(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  ++world.counts->evaluations;
  free_accelerations(world, island);
  aim_cones(world, island);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int begin = segment.begin * batch.ops->rows, end = segment.end * batch.ops->rows;
    if (batch.law && batch.law->force) {
      find_known_forces(world, batch, segment.begin, segment.end, batch.lower.data());
      for (int i = begin; i < end; ++i) batch.upper[i] = batch.lower[i], batch.softness[i] = 0;
    }
    batch.ops->gamma(batch, segment.begin, segment.end, world.bodies, time, batch.bias.data());
    for (int i = begin; i < end; ++i) batch.bias[i] = -batch.bias[i];
    if (batch.law && batch.law->guard && (batch.law->moving || batch.driven()))
      follow_bounds(batch, segment.begin, segment.end);
  }
  bound_aimed_cones(island);
}

template <class S>
void accelerate(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  ask_for_gamma(world, island, time);
  island.solver->accelerations(world, island);
}

#define CDOT_INSTANTIATE(S)                                                        \
  template void find_known_forces(WorldData<S>&, Batch<S>&, int, int, S::Scalar*); \
  template void ask_for_gamma(WorldData<S>&, Island<S>&, S::Scalar);               \
  template void accelerate(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
