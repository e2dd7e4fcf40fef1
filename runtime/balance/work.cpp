// The work of forces without a potential, put in and taken: drag, dampers, motors, friction, limits, joints that depend
// on time.
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/balance/parted.hpp"

namespace cdot {
namespace {

// The force of dampers among the rows of a slot: that of the law at this rate, less that at rest.
template <class S>
void find_damping(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* force) {
  typename S::Scalar none[most_rows];
  batch.law->force(batch, slot, at_rest<typename S::Scalar>, none);
  batch.law->force(batch, slot, rate, force);
  for (int r = 0; r < batch.ops->rows; ++r) force[r] -= none[r];
}

// Rows that are springs, given J v of the rate at which they acted and, in Batch::rate, of the mean velocity. Of an
// effect without energy the impulse itself does the work: a stiff servo acts implicitly, so its force is not that of C.
template <class S>
void work_of_springs(const WorldData<S>& world, Batch<S>& batch, int slot, const typename S::Scalar* acted,
                     const typename S::Scalar* lambda, typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  const bool drifts = batch.explicit_time(), of_effect = batch.law->is_of_effect();
  const bool by_impulse = of_effect && !batch.law->energy;
  T drift[most_rows], rate[most_rows] = {}, force[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows; ++r) rate[r] = drifts ? acted[r] + drift[r] : acted[r];
  if (!of_effect) find_damping(batch, slot, rate, force);
  else if (!by_impulse) batch.law->unstored(batch, slot, rate, force);
  double done = 0;
  for (int r = 0; r < rows; ++r) {
    const int i = slot * rows + r;
    const double impulse = by_impulse ? double(lambda[i]) : h * double(force[r]);
    const double of_row = impulse * double(drifts ? batch.rate[i] + drift[r] : batch.rate[i]);
    if (of_effect) done += of_row;
    else work.take(batch.source, of_row);
    if (drifts) work.put(batch.source, -double(lambda[i]) * double(drift[r]));
  }
  if (of_effect) work.give(batch.source, done);
}

// Whether a step exerts the impulses of rows in one kick or in two. Work that is only taken is that of both.
enum class Kick : char { only, first, second };

// A rate of 0 by a force that may be 0 is friction, which can only take.
template <class S>
void work_of_rate(const Batch<S>& batch, const Guard<typename S::Scalar>& guard, double done, Work& work) {
  if (guard.rate != 0 || guard.lower > 0 || guard.upper < 0) work.put(batch.source, done);
  else work.take(batch.source, done);
}

// Whether an impulse of a row counts.
enum class Rows : char { all, springs, others };

// Rows with bounds, at most so many: motors put in, friction takes, limits, ropes and latches take what hits them.
// Other rows that are held on both sides without a rate of their own do no work. Flow::first_kick keeps that of the
// first kick.
template <int most, class S>
void work_of_bounded(const Batch<S>& batch, int slot, const typename S::Scalar* lambda, Kick kick, Work& work) {
  const int rows = batch.ops->rows;
  double done[most];
  bool idle = true;
  for (int r = 0; r < rows; ++r) {
    const int i = slot * rows + r;
    done[r] = double(lambda[i]) * double(batch.rate[i]) + (kick == Kick::second ? work.first_kick[r] : 0);
    idle = idle && done[r] == 0;
  }
  if (kick == Kick::first) std::copy_n(done, rows, work.first_kick);
  if (kick != Kick::only) work.first_kick += rows;
  if (idle || kick == Kick::first) return;
  const bool has_ends = batch.law->error;
  const bool ends_move = has_ends && batch.driven() && !batch.drives_of(slot).empty();
  const bool in_time = batch.explicit_time() || (!has_ends && batch.law->in_time);
  Guard<typename S::Scalar> guards[most];
  if (!in_time) batch.law->guard(batch, slot, guards);
  for (int r = 0; r < rows; ++r) {
    if (ends_move) work.give(batch.source, done[r]);
    else if (in_time) work.put(batch.source, done[r]);
    else if (!has_ends) work_of_rate(batch, guards[r], done[r], work);  // a motor or dry friction
    else if (guards[r].one_sided()) work.take(batch.source, done[r]);
    else if (batch.law->distance) work.give(batch.source, done[r]);
  }
}

// True if an energy of these rows, whose law has by_mass, changes with K.
template <class S>
bool any_by_mass(const Segment<S>& segment) {
  for (int slot = segment.begin; slot < segment.end; ++slot)
    if (segment.batch->law->by_mass(*segment.batch, slot)) return true;
  return false;
}

// True if an energy stores all work of forces that act whole, as that of a gas spring.
template <class S>
bool stores_all(const Batch<S>& batch) {
  const Law<S>& law = *batch.law;
  return !batch.explicit_time() && (law.is_of_effect() ? law.energy && !law.stores_part : !law.spring);
}

// True if no row of a segment has an impulse.
template <class S>
bool idle(const Segment<S>& segment, const typename S::Scalar* lambda) {
  const int rows = segment.batch->ops->rows;
  return std::all_of(lambda + segment.begin * rows, lambda + segment.end * rows, [](auto x) { return x == 0; });
}

// Rows that may do work, given J v of mean velocities by batch.ops->velocity(..., mean). `impulses` gives those of a
// batch; `acted` finds J v at which whole springs acted, into Batch::impulse. Returns true if a spring is given by its
// frequency.
template <class S, class Array, class Acted>
bool work_of_rows(WorldData<S>& world, const Island<S>& island, const typename S::Velocity* mean, Array impulses,
                  Acted acted, Springs springs, Rows which, Kick kick, typename S::Scalar time, double h, Work& work) {
  bool by_mass = false;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int begin = segment.begin, end = segment.end, rows = batch.ops->rows;
    if (!batch.law && !batch.explicit_time()) continue;
    if (which != Rows::all && (batch.law && batch.law->spring) != (which == Rows::springs)) continue;
    if (springs == Springs::none && batch.law && (batch.law->spring || batch.law->force)) continue;
    by_mass = by_mass || (batch.law && batch.law->by_mass && any_by_mass(segment));
    if (springs == Springs::as_forces && batch.law && batch.law->force) {
      work_of_forces(world, segment, mean, time, h, work);
      continue;
    }
    const auto* const lambda = impulses(batch);
    const bool of_force = batch.law && batch.law->force;
    if (of_force ? springs == Springs::whole && stores_all(batch) : kick == Kick::only && idle(segment, lambda))
      continue;
    batch.ops->velocity(batch, begin, end, mean, batch.rate.data());
    if (!batch.law) {
      for (int i = begin * rows; i < end * rows; ++i) work.put(batch.source, double(lambda[i]) * double(batch.rate[i]));
    } else if (batch.law->spring && springs != Springs::whole) {
      for (int slot = begin; slot < end; ++slot) {
        if (batch.law->is_of_effect()) work_of_parted_effect(world, batch, slot, lambda, springs, time, h, work);
        else work_of_parted_springs(world, batch, slot, lambda, springs, time, work);
      }
    } else if (batch.law->force) {
      const auto* const rates = acted(batch, begin, end);
      for (int slot = begin; slot < end; ++slot)
        work_of_springs(world, batch, slot, rates + slot * rows, lambda, time, h, work);
    } else if (batch.law->guard) {
      for (int slot = begin; slot < end; ++slot)  // coordinates have one row
        rows == 1 ? work_of_bounded<1>(batch, slot, lambda, kick, work)
                  : work_of_bounded<most_rows>(batch, slot, lambda, kick, work);
    }
  }
  return by_mass;
}

// Sweeps leave a spring at another rate than the one that gave its impulse: J v = -bias - softness lambda.
template <class S>
void find_rates_met(Batch<S>& batch, int begin, int end) {
  for (int i = begin * batch.ops->rows; i < end * batch.ops->rows; ++i)
    if (batch.lower[i] < batch.lambda[i] && batch.lambda[i] < batch.upper[i])
      batch.impulse[i] = -batch.bias[i] - batch.softness[i] * batch.lambda[i];
}

// A duration in which no body moves by more than a small share of the mechanism's size, or of 1 rad: third derivatives
// do not count in a difference over it, nor does round-off.
template <class S>
typename S::Scalar moment_of(const Island<S>& island, const typename S::Velocity* v) {
  using T = typename S::Scalar;
  constexpr T longest = T(by_precision<T>(1e-3, 1e-6)), way = T(by_precision<T>(4e-3, 1e-6));
  const T size = island.size;
  T fastest = 0;
  for (int i : island.bodies) {
    T numbers[S::freedom];
    S::write(v[i], numbers);
    for (int k = 0; k < S::freedom; ++k)
      fastest = std::max<T>(fastest, std::abs(numbers[k]) / (k < S::lengths ? size : T(1)));
  }
  return fastest * longest > way ? way / fastest : longest;
}

// Springs given by their frequency: their stiffness changes with the pose.
template <class S>
void work_of_stiffness(WorldData<S>& world, const Island<S>& island, typename S::Scalar time,
                       const typename S::Velocity* v, double h, Work& work) {
  std::optional<Along<S>> motion;
  for (const Segment<S>& segment : island.segments) {
    const Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->by_mass) continue;
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      if (!batch.law->by_mass(batch, slot)) continue;
      if (!motion) motion = {time, moment_of(island, v), v};
      work.put(batch.source, h * power_of_stiffness(world, batch, slot, *motion, world.one_slot, world.few));
    }
  }
}

// Energies whose parameters follow functions of time, over h from the present C.
template <class S>
void work_of_drives(const Island<S>& island, double h, Work& work) {
  for (const auto& [batch, begin, end, whole] : island.segments) {
    if (!batch->driven() || !batch->law || !batch->law->power) continue;
    for (int slot = begin; slot < end; ++slot) work.put(batch->source, h * batch->law->power(*batch, slot));
  }
}

// Drag and, in space, torques: forces at the velocities `acted`, over h, work along `mean`.
template <class S>
void work_on_bodies(const WorldData<S>& world, const Island<S>& island, const typename S::Velocity* acted,
                    const typename S::Velocity* mean, bool drags, bool implicit_drag, typename S::Scalar h,
                    Work& work) {
  using T = typename S::Scalar;
  const Bodies<S>& all = world.bodies;
  for (const Drag<S>& drag : island.drags) {
    if (!drags) break;
    const T linear = implicit_drag ? drag.linear / (T(1) + h * drag.linear) : drag.linear;
    const T angular = implicit_drag ? drag.angular / (T(1) + h * drag.angular) : drag.angular;
    const auto force = S::force(all.inverse_mass[drag.body], S::damped(acted[drag.body], linear, angular));
    work.take(Source::damping, -double(h) * S::dot(force, mean[drag.body]));
  }
  if constexpr (S::has_gyroscopes)
    for (int i : island.bodies) work.put(Source::torque, double(h) * S::dot(S::damped(all.force[i], 0, 1), mean[i]));
}

template <class S>
void add(WorldData<S>& world, const Work& work) {
  world.accounts.put_in += work.put_in;
  world.accounts.taken += work.taken;
}

template <class S>
const typename S::Scalar* impulses_of(Impulses impulses, const Batch<S>& batch) {
  const bool corrected = impulses == Impulses::rattle_start || impulses == Impulses::middle ||
                         impulses == Impulses::drift || impulses == Impulses::relaxed;
  return (corrected ? batch.correction : batch.lambda).data();
}

template <class S>
bool has_springs(const Island<S>& island) {
  return std::ranges::any_of(island.segments, [](const Segment<S>& s) { return s.batch->law && s.batch->law->spring; });
}

constexpr Kick kick_of(Impulses impulses) {
  if (impulses == Impulses::soft || impulses == Impulses::middle) return Kick::first;
  return impulses == Impulses::relaxed || impulses == Impulses::end ? Kick::second : Kick::only;
}

constexpr Springs springs_of(Impulses impulses) {
  if (impulses == Impulses::drift) return Springs::none;
  if (impulses == Impulses::euler || impulses == Impulses::soft) return Springs::whole;
  if (impulses == Impulses::rattle_start || impulses == Impulses::rattle_end) return Springs::as_forces;
  return impulses == Impulses::middle ? Springs::without_dampers : Springs::dampers;
}

constexpr Rows rows_of(Impulses impulses) {
  return impulses == Impulses::dampers ? Rows::springs : impulses == Impulses::relaxed ? Rows::others : Rows::all;
}

// `impulses`, or a type that holds it: the halves of RATTLE are booked in each step, by code of their own.
template <class S, class Kind>
void book(WorldData<S>& world, Island<S>& island, Kind impulses, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (!(impulses == Impulses::drift ? island.driven : works_now(world, island))) return;
  if (impulses == Impulses::dampers && !has_springs(island)) return;
  const auto& v = world.bodies.velocity;
  auto &start = world.start_of_kick, &mean = world.mean_of_kick;
  const bool at_velocities = impulses == Impulses::middle || impulses == Impulses::drift;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto& from = impulses == Impulses::rattle_end ? island.flow.velocity[k] : start[i];
    mean[i] = at_velocities ? v[i] : S::damped(S::sum(from, v[i], T(1)), T(0.5), T(0.5));
    if (impulses == Impulses::rattle_start) start[i] = island.flow.velocity[k];
  }
  const bool at_end = impulses == Impulses::euler || impulses == Impulses::soft;
  const auto* const acted = at_end ? v.data() : start.data();
  Work work{world.accounts.by_source.data(), island.flow.first_kick.data()};
  const bool of_rows = impulses == Impulses::drift || impulses == Impulses::dampers || impulses == Impulses::end ||
                       impulses == Impulses::relaxed;
  if (!of_rows && (S::has_gyroscopes || !island.drags.empty()))
    work_on_bodies(world, island, start.data(), mean.data(), impulses != Impulses::middle, at_end, h, work);
  const bool by_mass = work_of_rows(
      world, island, mean.data(), [&](const Batch<S>& batch) { return impulses_of(impulses, batch); },
      [&](Batch<S>& batch, int begin, int end) {
        batch.ops->velocity(batch, begin, end, acted, batch.impulse.data());
        if (at_end && sweeps(world.settings.solver)) find_rates_met(batch, begin, end);
        return batch.impulse.data();
      },
      springs_of(impulses), rows_of(impulses), kick_of(impulses), island.evaluated_at, double(h), work);
  if (by_mass && (impulses == Impulses::rattle_start || impulses == Impulses::rattle_end))
    work_of_stiffness(world, island, island.evaluated_at, start.data(), double(h), work);
  if (!of_rows && world.driven) work_of_drives(island, double(h), work);
  add(world, work);
}

}  // namespace

template <class S>
void begin_kick(WorldData<S>& world, const Island<S>& island) {
  if (!works_now(world, island)) return;
  for (int i : island.bodies) world.start_of_kick[i] = world.bodies.velocity[i];
}

template <class S>
void book_kick(WorldData<S>& world, Island<S>& island, Impulses impulses, typename S::Scalar h) {
  using Start = std::integral_constant<Impulses, Impulses::rattle_start>;
  using End = std::integral_constant<Impulses, Impulses::rattle_end>;
  if (impulses == Start::value) book(world, island, Start{}, h);
  else if (impulses == End::value) book(world, island, End{}, h);
  else book(world, island, impulses, h);
}

template <class S>
void find_power(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar* power) {
  using T = typename S::Scalar;
  std::fill_n(power, 2 + world.work_by_source.size(), T(0));
  if (!works_now(world, island)) return;
  std::fill(world.work_by_source.begin(), world.work_by_source.end(), 0);
  Work work{world.work_by_source.data()};
  const auto* const v = world.bodies.velocity.data();
  work_on_bodies(world, island, v, v, true, false, T(1), work);
  work_of_rows(
      world, island, v, [](const Batch<S>& batch) { return batch.lambda.data(); },
      [&](Batch<S>& batch, int begin, int end) {
        batch.ops->effective_mass(batch, begin, end, world.bodies);
        return batch.rate.data();
      },
      Springs::whole, Rows::all, Kick::only, time, 1, work);
  work_of_stiffness(world, island, time, v, 1, work);
  if (world.driven) work_of_drives(island, 1, work);
  power[0] = T(work.put_in), power[1] = T(work.taken);
  std::copy(world.work_by_source.begin(), world.work_by_source.end(), power + 2);
}

// The same over a step of Euler's method: K is still that of its start.
template <class S>
void book_stiffness(WorldData<S>& world, Island<S>& island) {
  if (!island.rows_work) return;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->energy) continue;
    double before = 0, after = 0;
    for (int slot = segment.begin; slot < segment.end; ++slot) before += batch.law->energy(batch, slot);
    batch.ops->effective_mass(batch, segment.begin, segment.end, world.bodies);
    for (int slot = segment.begin; slot < segment.end; ++slot) after += batch.law->energy(batch, slot);
    world.accounts.put_in += after - before;
    world.accounts.by_source[batch.source] += after - before;
  }
}

#define CDOT_INSTANTIATE(S)                                                   \
  template void begin_kick(WorldData<S>&, const Island<S>&);                  \
  template void book_kick(WorldData<S>&, Island<S>&, Impulses, S::Scalar);    \
  template void find_power(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar*); \
  template void book_stiffness(WorldData<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
