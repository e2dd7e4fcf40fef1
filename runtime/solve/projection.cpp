// Projects one island onto C = 0 and J v = -dC/dt: the drift correction of first-order steps (Drift::projection), and
// the functions that other integrators share with it.
#include "runtime/solve/projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/longest_move.hpp"
#include "runtime/solve/misfits.hpp"
#include "runtime/solve/solver.hpp"

namespace cdot {
namespace {

// True for an end that began to hold where it is passed. It holds its bodies there, and the next start moves them.
template <class S>
bool is_passed(const Island<S>& island, const Batch<S>& batch, const Guard<typename S::Scalar>& guard) {
  using T = typename S::Scalar;
  return batch.law->distance && guard.one_sided() && -guard.gap() > foreign<T> * island.scale;
}

// The error of a row under a law. At acceleration level only held rows must be at their end.
template <class S>
void error_of_law(const Island<S>& island, const Batch<S>& batch, int slot, typename S::Scalar* error) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  if (!island.acceleration_level && batch.law->error) return batch.law->error(batch, slot, error);
  std::fill_n(error, rows, T(0));
  if (!island.acceleration_level || !batch.law->guard) return;
  Guard<T> guards[most_rows];
  batch.law->guard(batch, slot, guards);
  for (int r = 0; r < rows; ++r)
    if (holds(batch.mode[slot * rows + r]) && !is_passed(island, batch, guards[r])) error[r] = guards[r].off_by;
}

// Adds `share` of the prescribed rates of held rows to the bias.
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

}  // namespace

template <class S>
void clear_correction(WorldData<S>& world, Island<S>& island) {
  for (int i : island.bodies) world.bodies.displacement[i] = {};
  for (const Segment<S>& segment : island.segments) {
    auto& correction = segment.batch->correction;
    const int rows = segment.batch->ops->rows;
    std::fill(correction.begin() + segment.begin * rows, correction.begin() + segment.end * rows,
              typename S::Scalar(0));
  }
}

template <class S>
typename S::Scalar find_errors(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  T worst = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int rows = batch.ops->rows;
    batch.ops->position(batch, segment.begin, segment.end, world.bodies, time);
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      T* error = batch.error.data() + slot * rows;
      if (!batch.law) std::copy_n(batch.C.data() + slot * rows, rows, error);
      else error_of_law(island, batch, slot, error);
      for (int r = 0; r < rows; ++r) worst = std::max(worst, std::abs(error[r]));
    }
  }
  return worst;
}

template <class S>
void evaluate_anew(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  if constexpr (S::has_gyroscopes) {
    if (island.acceleration_level) set_inertias(world, island);
    else turn_inertias(world, island);
  }
  island.evaluated_at = time;
  for (const Segment<S>& segment : island.segments)
    segment.batch->ops->evaluate(*segment.batch, segment.begin, segment.end, world.bodies, time);
}

template <class S>
void restore_drift(WorldData<S>& world, const Island<S>& island, const Segment<S>& segment) {
  Batch<S>& batch = *segment.batch;
  const int begin = segment.begin * batch.ops->rows, end = segment.end * batch.ops->rows;
  if (batch.explicit_time()) batch.ops->evaluate(batch, segment.begin, segment.end, world.bodies, island.evaluated_at);
  else std::fill(batch.bias.begin() + begin, batch.bias.begin() + end, typename S::Scalar(0));
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
void add_corrections(WorldData<S>& world, Island<S>& island, typename S::Scalar per_time) {
  Bodies<S>& all = world.bodies;
  for (int i : island.bodies) all.velocity[i] = S::sum(all.velocity[i], all.displacement[i], per_time);
  scale_corrections(island, per_time);
}

template <class S>
bool correction_is_small(const WorldData<S>& world, const Island<S>& island, double h) {
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
void fail_if_moved_far(const WorldData<S>& world, Island<S>& island, double error, double h) {
  const LongestMove move = longest_move<S>(island, world.bodies.displacement);
  if (!too_far(island, move, error) || correction_is_small(world, island, h)) return;
  island.trouble = StepProblem::moved_far;
  island.misfit = error, island.moved = move.way, island.moved_body = move.body;
}

template <class S>
void project_velocities(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  if (island.acceleration_level) add_wanted_rates(island, T(-1));
  island.solver->projection(world, island);
  if (island.acceleration_level) add_wanted_rates(island, T(1));
}

template <class S>
void project_velocities_at_start(WorldData<S>& world, Island<S>& island) {
  if (island.kinked < 0) return project_velocities(world, island);
  const auto source = static_cast<Source>(island.kinked);
  island.kinked = -1;
  const double before = kinetic_energy(world, island);
  project_velocities(world, island);
  book_change(world, source, kinetic_energy(world, island) - before);
}

namespace {

// The source of the end that is passed furthest, if by more than `near`, as find_errors() found it; -1 if there is
// none.
template <class S>
int passed_source(const Island<S>& island, typename S::Scalar near) {
  int source = -1;
  each_row(island, [&](const Batch<S>& batch, int i) {
    if (batch.law && batch.law->guard && std::abs(batch.error[i]) > near)
      near = std::abs(batch.error[i]), source = static_cast<int>(batch.source);
  });
  return source;
}

// Kinetic, since inertia tensors turn with the poses, and potential.
template <class S>
double energy_now(WorldData<S>& world) {
  const Energy energy = energy_of(world, world.one_slot);
  return energy.kinetic + energy.potential;
}

// Of the rows of joints, ropes too, as find_errors() left them.
template <class S>
typename S::Scalar error_of_joints(Island<S>& island) {
  typename S::Scalar worst = 0;
  each_row(island, [&](const Batch<S>& batch, int i) {
    if (!batch.law || batch.law->reported) worst = std::max(worst, std::abs(batch.error[i]));
  });
  return worst;
}

}  // namespace

template <class S>
void project_start(WorldData<S>& world, Island<S>& island, typename S::Scalar time) {
  using T = typename S::Scalar;
  constexpr T way_left = T(0.1);  // the rest of a way that Newton does not find
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  if (!(island.residual > foreign<T> * island.scale)) return;
  clear_correction(world, island);
  Bodies<S>& all = world.bodies;
  const bool exact = island.solver->exact;
  for (size_t k = 0; exact && k < island.bodies.size(); ++k) island.flow.pose[k] = all.pose[island.bodies[k]];
  const bool goes_on = std::isfinite(island.residual);
  const T error = find_errors(world, island, time), near = foreign<T> * island.scale;
  const bool fitted = error_of_joints(island) <= near, stays = stays_misfit(world, island, error, time - T(world.time));
  // An end that moves bodies at once does the work that this takes.
  const int mover = fitted && error > near ? passed_source(island, near) : -1;
  const double before = mover < 0 ? 0 : energy_now(world);
  island.solver->positions(world, island, time, true);
  // An end that began to hold where no pose of the joints reaches it would tear them apart.
  const bool unreached = island.residual > std::max(near, way_left * error);
  if (exact && goes_on && fitted && !stays && (unreached || error_of_joints(island) > near))
    island.trouble = StepProblem::joints_apart;
  if (exact) fail_if_moved_far(world, island, double(error), 0);
  // Joints that contradict each other may have no pose near by, and Newton leads away from all.
  if (exact && island.residual > error) {
    for (size_t k = 0; k < island.bodies.size(); ++k) all.pose[island.bodies[k]] = island.flow.pose[k];
    if constexpr (S::has_gyroscopes) set_inertias(world, island);
    clear_correction(world, island);
    island.residual = find_errors(world, island, time);
    note_errors(island);
  }
  if (mover >= 0) book_change(world, static_cast<Source>(mover), energy_now(world) - before);
  scale_corrections(island, T(0));  // the motion does not need them, so they are no load for its friction
  island.evaluated = island.factored = false;
}

namespace {

// A correction that is to roll may find no pose near a loss of rank: there it slips.
template <class S>
void correct_poses(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar foreign_error) {
  auto& pose = world.bodies.pose;
  const bool may_slip = island.solver->exact && !island.stiffened && rolls(island);
  for (size_t k = 0; may_slip && k < island.bodies.size(); ++k) island.flow.pose[k] = pose[island.bodies[k]];
  island.solver->positions(world, island, time, false);
  if (!may_slip || !left_the_joints(world, island, foreign_error)) return;
  for (size_t k = 0; k < island.bodies.size(); ++k) pose[island.bodies[k]] = island.flow.pose[k];
  clear_correction(world, island);
  island.residual = foreign_error;
  island.flow.projects_stages = true;
  island.solver->positions(world, island, time, true);
  island.flow.projects_stages = false;
}

}  // namespace

// Newton on C with the step's J and K (SHAKE). Then displacement / h is added to the velocities, and these are
// projected onto J v = -dC/dt at the new poses. A projection of the poses alone loses energy at first order: every step
// turns the velocity out of the tangent plane, and the next solve removes that part.
template <class S>
void project_step(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (world.settings.drift != Drift::projection || island.segments.empty()) return;
  const T time = T(world.time) + h;
  clear_correction(world, island);
  // An error left from the start of the step (contradicting joints, too few sweeps) is not due to the motion.
  const T foreign_error = island.residual, error = find_errors(world, island, time);
  const bool from_motion = foreign_error <= T(0.1) * error;
  correct_poses(world, island, time, foreign_error);
  if (island.solver->exact) fail_if_moved_far(world, island, double(std::max(error, foreign_error)), double(h));
  // Any other displacement would add energy to the velocities.
  const bool keep = from_motion && correction_is_small(world, island, double(h));
  const bool was_apart = foreign_error > foreign<T> && std::isfinite(foreign_error);
  if (!was_apart) fail_if_open(world, island, foreign_error);
  else if (!keep && island.residual > T(2) * std::max(error, foreign_error)) island.trouble = StepProblem::joints_apart;
  add_corrections(world, island, keep ? T(1) / h : T(0));
  evaluate_anew(world, island, time);
  project_velocities(world, island);
  island.evaluated = true;
  island.factored &= !island.at_work().lawful();
}

#define CDOT_INSTANTIATE(S)                                                         \
  template void clear_correction(WorldData<S>&, Island<S>&);                        \
  template S::Scalar find_errors(WorldData<S>&, Island<S>&, S::Scalar);             \
  template void fill_lambda(const Island<S>&, S::Scalar);                           \
  template void scale_corrections(const Island<S>&, S::Scalar);                     \
  template void add_corrections(WorldData<S>&, Island<S>&, S::Scalar);              \
  template void restore_drift(WorldData<S>&, const Island<S>&, const Segment<S>&);  \
  template void evaluate_anew(WorldData<S>&, Island<S>&, S::Scalar);                \
  template void fail_if_moved_far(const WorldData<S>&, Island<S>&, double, double); \
  template bool correction_is_small(const WorldData<S>&, const Island<S>&, double); \
  template void project_velocities(WorldData<S>&, Island<S>&);                      \
  template void project_velocities_at_start(WorldData<S>&, Island<S>&);             \
  template void project_start(WorldData<S>&, Island<S>&, S::Scalar);                \
  template void project_step(WorldData<S>&, Island<S>&, S::Scalar);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
