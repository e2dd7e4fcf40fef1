#include "runtime/step/kick_drift.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/events/resolution.hpp"
#include "runtime/motion/motion.hpp"
#include "runtime/solve/loads.hpp"
#include "runtime/solve/projection.hpp"
#include "runtime/solve/solve.hpp"
#include "runtime/solve/solver.hpp"
#include "runtime/step/dampers.hpp"

namespace cdot {
namespace {

// Motors and friction.
template <class S>
bool acts_by_force(const Batch<S>& batch) {
  return is_bounded(batch) && !batch.law->error;
}

template <class S>
bool has_rows(const Island<S>& island, bool (*are)(const Batch<S>&)) {
  return std::any_of(island.segments.begin(), island.segments.end(),
                     [&](const Segment<S>& s) { return s.begin < s.end && are(*s.batch); });
}

// True where ends may take a share of loads.
template <class S>
bool shares_with_ends(const Island<S>& island) {
  return island.solver->exact && island.system.shares_loads() && has_rows(island, has_ends<S>);
}

// True for a freewheel, a ratchet or a motor that only pushes or only pulls.
template <class S>
bool drives_one_way(const Batch<S>& batch, int i) {
  if (!acts_by_force(batch) || batch.law->by_load) return false;
  Guard<typename S::Scalar> guard;
  batch.law->guard(batch, i, &guard);
  return (guard.lower == 0) != (guard.upper == 0);
}

template <class S>
void offer_ends(const Island<S>& island, Batch<S>& batch, int begin, int end) {
  each_row(batch, begin, end, [&](int i) {
    if (!holds_at_start(island, batch, i)) return;
    const auto guard = guard_of(batch, i);
    batch.lower[i] = guard.lower, batch.upper[i] = guard.upper;
  });
}

// Limits that are met carry the load of friction. Their own impulses are dropped afterwards.
template <class S>
void offer_load(const Island<S>& island, Batch<S>& batch, int begin, int end) {
  using T = typename S::Scalar;
  if (!batch.law->guard) return;
  Guard<T> guards[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    batch.law->guard(batch, slot, guards);
    for (int r = 0; r < batch.ops->rows; ++r) {
      if (!guards[r].one_sided() || guards[r].gap() > foreign<T> * island.scale) continue;
      batch.lower[slot * batch.ops->rows + r] = guards[r].lower;
      batch.upper[slot * batch.ops->rows + r] = guards[r].upper;
    }
  }
}

// Bounds of the force at the start, and into Batch::impulse the rate that a motor or friction misses. Of others under a
// law, only those of holds_at_start() act.
template <class S>
void offer_bounds(WorldData<S>& world, const Island<S>& island, Batch<S>& batch, int begin, int end) {
  using T = typename S::Scalar;
  each_row(batch, begin, end, [&](int i) { batch.softness[i] = batch.lower[i] = batch.upper[i] = T(0); });
  if (!acts_by_force(batch)) {
    offer_ends(island, batch, begin, end);
    if (!island.loads.empty()) offer_load(island, batch, begin, end);
    return;
  }
  batch.ops->velocity(batch, begin, end, world.bodies.velocity.data(), batch.rate.data());
  for (int i = begin; i < end; ++i) {  // a coordinate has one row
    Guard<T> guard;
    batch.load[i] = T(0);  // the solver adds it
    batch.law->guard(batch, i, &guard);
    batch.lower[i] = guard.lower;
    batch.upper[i] = guard.upper;
    batch.impulse[i] = guard.rate - batch.rate[i] - batch.bias[i];
  }
}

// Accelerations by which motors and friction reach their rates in the time t, as far as their bounds allow.
template <class S>
void reach_rates(WorldData<S>& world, Island<S>& island, typename S::Scalar t) {
  ask_for_gamma(world, island, typename S::Scalar(world.time));
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int i = begin; acts_by_force(*batch) && i < end; ++i) batch->bias[i] -= batch->impulse[i] / t;
  island.solver->renew(world, island);
  island.solver->velocities(world, island, world.bodies.velocity_rate.data(), typename S::Scalar(0));
  island.factored = false;
}

// The forces at the start, and the accelerations by which motors and friction reach their rates in the time t.
template <class S>
void find_start(WorldData<S>& world, Island<S>& island, typename S::Scalar t) {
  for (const auto& [batch, begin, end, whole] : island.segments)
    if (batch->law) offer_bounds(world, island, *batch, begin, end);
  if (has_rows(island, acts_by_force<S>) || shares_with_ends(island)) reach_rates(world, island, t);
  else accelerate(world, island, typename S::Scalar(world.time));
}

// With the ends that are met, if loads are shared then; else without.
template <class S>
void share_at_start(WorldData<S>& world, Island<S>& island, typename S::Scalar t) {
  const auto let_ends = [&](Mode mode) {
    each_row(island, [mode](Batch<S>& batch, int i) {
      if (has_ends(batch) && within_bounds(batch.mode[i])) batch.mode[i] = mode;
    });
  };
  let_ends(Mode::gripped), find_start(world, island, t);
  if (island.at_work().shared()) return;
  evaluate_anew(world, island, typename S::Scalar(world.time));
  let_ends(Mode::bounded), find_start(world, island, t);
}

// True if the clutch pushes, and its force is no bound.
template <class S>
bool grips(const System<S>& system, int row, const Batch<S>& batch, int i) {
  return batch.lambda[i] != 0 && system.fixed[row] == System<S>::free;
}

template <class S>
void note_grips(Island<S>& island) {
  System<S>& system = island.at_work();
  system.each_row([&](int row, Batch<S>& batch, int i) {
    if (drives_one_way(batch, i)) batch.mode[i] = grips(system, row, batch, i) ? Mode::gripped : Mode::bounded;
  });
}

// f(row, batch, i) for motors and friction that act both ways, by bounds that no load moves.
template <class S, class F>
void each_two_way_row(System<S>& system, F f) {
  system.each_row([&](int row, Batch<S>& batch, int i) {
    const bool plain = acts_by_force(batch) && !batch.law->by_load && batch.law->cone_rows == 0;
    if (plain && !system.broken[row] && !drives_one_way(batch, i)) f(row, batch, i);
  });
}

// Those that forces bring to their rates.
template <class S>
void note_sticking_rows(Island<S>& island) {
  System<S>& system = island.at_work();
  each_two_way_row(system, [&](int row, Batch<S>& batch, int i) {
    if (!system.fixed[row]) batch.mode[i] = Mode::gripped;
  });
}

// Notes which of them have their rates at the end, within their bounds or just at one. True if one has it that had not
// at the start: its force has jumped.
template <class S>
bool begins_to_stick(Island<S>& island) {
  System<S>& system = island.at_work();
  bool begins = false, known = false;
  each_two_way_row(system, [&](int row, Batch<S>& batch, int i) {
    if (system.fixed[row] && !known) system.find_excess(), known = true;
    const bool sticks = batch.lower[i] < batch.upper[i] && (!system.fixed[row] || system.has_rate(row));
    begins |= sticks && batch.mode[i] != Mode::gripped;
    batch.mode[i] = sticks ? Mode::gripped : Mode::bounded;
  });
  return begins;
}

// True if a motor of unlimited force misses more of its rate than round-off, and these accelerations bring it there in
// the time t, as they do not where an end holds it.
template <class S>
bool reaches_rate_by_blow(WorldData<S>& world, Island<S>& island, typename S::Scalar t) {
  using T = typename S::Scalar;
  bool any = false;
  each_guarded_slot(island, [&](Batch<S>& batch, int i) {
    if (!acts_by_force(batch)) return;
    Guard<T> guard;
    batch.law->guard(batch, i, &guard);
    if (!guard.bilateral()) return;
    Resolution<T> resolution[most_rows] = {};
    find_resolution(world, island, batch, i, t, resolution);
    const T missing = batch.impulse[i];
    batch.ops->velocity(batch, i, i + 1, world.bodies.velocity_rate.data(), batch.rate.data());
    any |=
        std::abs(missing) > T(4) * resolution[0].rate && std::abs(missing - t * batch.rate[i]) < std::abs(missing) / 2;
  });
  return any;
}

// Rows without C have none for the first half of a step: velocity rows, motors and friction. They repeat their impulses
// from the second half of the last step. A start from 0 would alternate between 0 and twice the impulse forever. The
// start is therefore half of their impulse in h.
template <class S>
void exert_at_start(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T time = T(world.time);
  if (shares_with_ends(island)) share_at_start(world, island, h / 2);
  else find_start(world, island, h / 2);
  island.flow.motors_struck = !island.loads.empty() && reaches_rate_by_blow(world, island, h / 2);
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const bool acts = !batch.law || acts_by_force(batch);
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i)
      batch.lambda[i] *= acts || holds_at_start(island, batch, i) ? h / 2 : T(0);
  }
  if (island.solver->exact) note_grips(island), note_sticking_rows(island);
  evaluate_anew(world, island, time);  // restores dC/dt, which gamma replaced
}

// A motor of unlimited force that ends hold presses by System::usual_softness, with ten times what brings its bodies to
// its rate. Ends begin a step without their impulses, so it begins with that alone.
template <class S>
void ease_held_motors(WorldData<S>& world, Island<S>& island) {
  using T = typename S::Scalar;
  constexpr T pressing = T(2 / System<S>::usual_softness);
  if (!island.solver->exact || !has_unlimited_motor_beside_ends(island)) return;
  find_rates(world, island);
  System<S>& system = island.at_work();
  Guard<T> guards[most_rows];
  system.each_row([&](int row, Batch<S>& batch, int i) {
    if (!is_motor(batch) || !batch.law->guard || batch.explicit_time() || system.broken[row]) return;
    batch.law->guard(batch, i / batch.ops->rows, guards);
    const auto& guard = guards[i % batch.ops->rows];
    const T most = std::abs(guard.rate - batch.rate[i]) / T(system.diagonal(row));  // the end's bias has its rate
    if (!guard.of_rate || !guard.bilateral() || !(std::abs(batch.lambda[i]) < pressing * most)) return;
    batch.lambda[i] = std::clamp(batch.lambda[i], -most, most);
  });
}

// Ends that are not met yet do not slow their bodies before. A blow in two parts would load friction in both of them,
// in the first one perhaps against the slip before the blow.
template <class S>
void wait_for_ends(const Island<S>& island, Batch<S>& batch, int begin, int end) {
  using T = typename S::Scalar;
  if (!batch.law->error || !batch.law->guard) return;
  Guard<T> guards[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    batch.law->guard(batch, slot, guards);
    for (int r = 0; r < batch.ops->rows; ++r)
      if (guards[r].one_sided() && guards[r].gap() > foreign<T> * island.scale)
        batch.lower[slot * batch.ops->rows + r] = batch.upper[slot * batch.ops->rows + r] = T(0);
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
    if (is_force(batch)) {
      const auto pulled = [h](const Batch<S>& of, int i) { return h / 2 * of.at_rest[i]; };  // in the last kick
      bound_dampers(batch, segment.begin, segment.end, h, false, pulled);
      continue;
    }
    batch.law->fill(batch, segment.begin, segment.end, h, world.settings);
    if (!island.loads.empty() && island.solver->exact) wait_for_ends(island, batch, segment.begin, segment.end);
    for (int i = begin; i < end; ++i) {
      if (!acts_at_start(island, batch, i)) continue;
      batch.lower[i] *= T(0.5);  // the other half acts at the start of the next step
      batch.upper[i] *= T(0.5);
      if (!island.solver->exact || !drives_one_way(batch, i)) continue;
      (batch.lower[i] == 0 ? batch.lower[i] : batch.upper[i]) = -batch.correction[i];
    }
  }
}

// f() sees the mean velocities.
template <class S, class F>
void drift_and(WorldData<S>& world, Island<S>& island, typename S::Scalar h, F f) {
  Bodies<S>& all = world.bodies;
  const std::vector<typename S::Pose>& start = island.flow.pose;
  for (size_t k = 0; k < start.size(); ++k) all.pose[island.bodies[k]] = start[k];
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island,
                       [&](auto& gyroscope, int i) { S::lend_mean_spin(gyroscope, all.pose[i], all.velocity[i], h); });
  for (int i : island.bodies) all.pose[i] = S::moved(all.pose[i], S::sum({}, all.velocity[i], h));
  f();
  if constexpr (S::has_gyroscopes)
    for_each_gyroscope(world, island, [&](auto& gyroscope, int i) { S::restore_spin(gyroscope, all.velocity[i]); });
}

}  // namespace

template <class S>
bool repeats_impulses(const Island<S>& island) {
  return has_rows(island, has_velocity_rows<S>) || has_rows(island, acts_by_force<S>) || shares_with_ends(island);
}

template <class S>
typename S::Scalar begin_kick_drift(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  using T = typename S::Scalar;
  const T share = world.last_step > 0 ? h / T(world.last_step) : T(0);
  island.flow.motors_struck = false;
  // Errors that sweeps left in the impulses would grow with them, until they throw the bodies off.
  if (island.evaluated) {
    ease_held_motors(world, island);
    return island.solver->exact ? share : std::min(T(1), share);
  }
  project_start(world, island, typename S::Scalar(world.time));
  evaluate_anew(world, island, typename S::Scalar(world.time));
  clear_correction(world, island);
  project_velocities_at_start(world, island);
  fill_lambda(island, T(0));
  island.evaluated = true;
  if (repeats_impulses(island)) exert_at_start(world, island, h);
  return T(1);
}

template <class S>
void note_start(const WorldData<S>& world, Island<S>& island) {
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    island.flow.pose[k] = world.bodies.pose[island.bodies[k]];
    island.flow.velocity[k] = world.bodies.velocity[island.bodies[k]];
  }
}

template <class S>
void drift(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  drift_and(world, island, h, [] {});
}

template <class S>
void drift_with_rates(WorldData<S>& world, Island<S>& island, typename S::Scalar h) {
  drift_and(world, island, h, [&] {
    for (const auto& [batch, begin, end, whole] : island.segments)
      batch->ops->velocity(*batch, begin, end, world.bodies.velocity.data(), batch->rate.data());
  });
}

template <class S>
void solve_end(WorldData<S>& world, Island<S>& island, typename S::Scalar h, EndLoads loads) {
  factorize_rows(world, island);
  bound_rows(world, island, h);
  island.factored = false;
  island.corrections_in_loads = loads == EndLoads::of_end ? 0 : 1;
  island.loads_in_kick = typename S::Scalar(loads == EndLoads::half ? 0.5 : 1);
  island.solver->velocities(world, island, world.bodies.velocity.data(), typename S::Scalar(1));
  island.corrections_in_loads = 0, island.loads_in_kick = 1;
  forget_dampers(world, island);
}

template <class S>
void calm_sticking_rows(Island<S>& island) {
  using T = typename S::Scalar;
  constexpr T theta = T(0.125), slight = T(1e-3), jump = T(3);  // slight: of the range of the force
  bound_by_loads(island);
  for (const LoadedRow<S>& row : island.loads) {
    Batch<S>& batch = *row.batch;
    if (batch.law->cone_rows > 0) continue;
    const int i = row.place();
    T &end = batch.lambda[i], &start = batch.correction[i];
    const T few = slight * (batch.upper[i] - batch.lower[i]);
    const bool sticks = std::min(end - batch.lower[i], batch.upper[i] - end) > few;
    if (!sticks || std::abs(end - start) > std::max(few, jump * std::min(std::abs(end), std::abs(start)))) continue;
    const T given = theta * (end - start);
    end -= given, start += given;
  }
  unload(island);
}

template <class S>
bool settle_clutches(Island<S>& island) {
  using T = typename S::Scalar;
  bool anew = false;
  System<S>& system = island.at_work();
  system.each_row([&](int row, Batch<S>& batch, int i) {
    T &end = batch.lambda[i], &start = batch.correction[i];
    if (!drives_one_way(batch, i) || system.broken[row]) return;
    const bool holds = grips(system, row, batch, i);
    const T whole = start + end;
    anew |= end != 0 && (start == 0 || (holds && batch.mode[i] != Mode::gripped));
    if (holds || whole == 0) end = whole / 2;
    start = whole - end;
  });
  note_grips(island);
  return begins_to_stick(island) || anew;
}

#define CDOT_INSTANTIATE(S)                                                  \
  template bool settle_clutches(Island<S>&);                                 \
  template bool repeats_impulses(const Island<S>&);                          \
  template S::Scalar begin_kick_drift(WorldData<S>&, Island<S>&, S::Scalar); \
  template void note_start(const WorldData<S>&, Island<S>&);                 \
  template void drift(WorldData<S>&, Island<S>&, S::Scalar);                 \
  template void drift_with_rates(WorldData<S>&, Island<S>&, S::Scalar);      \
  template void solve_end(WorldData<S>&, Island<S>&, S::Scalar, EndLoads);   \
  template void calm_sticking_rows(Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
