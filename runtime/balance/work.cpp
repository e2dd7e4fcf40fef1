// The work of forces without a potential, put in and taken: drag, dampers, motors, friction, limits, joints that depend
// on time.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/balance/parted.hpp"
#include "runtime/balance/whole.hpp"

namespace cdot {
namespace {

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
  const int rows = most == 1 ? 1 : batch.ops->rows;
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
  if (!in_time || !has_ends) batch.law->guard(batch, slot, guards);
  for (int r = 0; r < rows; ++r) {
    // A rate in time may be 0 for a moment: then this is no friction.
    if (ends_move || (in_time && !has_ends && guards[r].rate == 0)) work.give(batch.source, done[r]);
    else if (in_time) work.put(batch.source, done[r]);
    else if (!has_ends) work_of_rate(batch, guards[r], done[r], work);  // a motor or dry friction
    else if (guards[r].one_sided()) work.take(batch.source, done[r]);
    else if (batch.law->distance) work.give(batch.source, done[r]);
  }
}

// True if no row of a segment has an impulse.
template <class S>
[[gnu::always_inline]] inline bool idle(const Segment<S>& segment, const typename S::Scalar* lambda) {
  const int rows = segment.batch->ops->rows;
  return std::all_of(lambda + segment.begin * rows, lambda + segment.end * rows, [](auto x) { return x == 0; });
}

// Rows that no force law gives: exact ones in time, and those with bounds.
template <class S, class Rates>
void work_of_held_rows(const Segment<S>& segment, const typename S::Scalar* lambda, Rates rates, Kick kick,
                       Work& work) {
  if (kick == Kick::only && idle(segment, lambda)) return;
  Batch<S>& batch = *segment.batch;
  const auto* const rate = rates(segment);
  const int rows = batch.ops->rows;
  if (!batch.law) {
    for (int i = segment.begin * rows; i < segment.end * rows; ++i)
      work.put(batch.source, double(lambda[i]) * double(rate[i]));
  } else if (batch.law->guard) {
    for (int slot = segment.begin; slot < segment.end; ++slot)  // coordinates have one row
      rows == 1 ? work_of_bounded<1>(batch, slot, lambda, kick, work)
                : work_of_bounded<most_rows>(batch, slot, lambda, kick, work);
  }
}

// f(segment) of those whose rows may do work.
template <class S, class F>
void each_working(const Island<S>& island, F f) {
  for (const size_t k : island.working) f(island.segments[k]);
}

// How the impulses of a kick count.
struct Counted {
  Springs springs;
  Rows rows;
  Kick kick;
};

// Rows that may do work. `impulses` gives those of a batch, `rates` J v of the mean velocities, and `acted` that at
// which whole springs acted.
template <class S, class Array, class Rates, class Acted>
void work_of_rows(WorldData<S>& world, const Island<S>& island, Array impulses, Rates rates, Acted acted,
                  const Counted& counted, typename S::Scalar time, double h, Work& work) {
  each_working(island,
               [&, springs = counted.springs, which = counted.rows, kick = counted.kick](const Segment<S>& segment) {
                 Batch<S>& batch = *segment.batch;
                 const bool of_force = batch.law && batch.law->force, of_spring = batch.law && batch.law->spring;
                 if (which != Rows::all && of_spring != (which == Rows::springs)) return;
                 if (springs == Springs::none && of_force) return;
                 if (!of_force) {
                   work_of_held_rows(segment, impulses(batch), rates, kick, work);
                 } else if (springs == Springs::as_forces) {
                   work_of_forces(world, segment, rates, time, h, work);
                 } else if (springs == Springs::whole || !of_spring) {
                   work_of_whole_forces(world, segment, impulses(batch), rates, acted, time, h, work);
                 } else {
                   rates(segment);
                   for (int slot = segment.begin; slot < segment.end; ++slot) {
                     if (batch.law->is_of_effect())
                       work_of_parted_effect(world, batch, slot, impulses(batch), springs, time, h, work);
                     else work_of_parted_springs(world, batch, slot, impulses(batch), springs, time, work);
                   }
                 }
               });
}

// J v of a segment, into `to`.
template <class S, class Array>
const typename S::Scalar* rates_along(const Segment<S>& segment, const typename S::Velocity* v, Array& to) {
  segment.batch->ops->velocity(*segment.batch, segment.begin, segment.end, v, to.data());
  return to.data();
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

// True if energies of these rows may change with K, as those of springs given by their frequency do.
template <class S>
bool may_stiffen(const Segment<S>& segment) {
  return segment.batch->law && segment.batch->law->by_mass;
}
// f(slot) of those that do.
template <class S, class F>
void each_by_mass(const Segment<S>& segment, F f) {
  const Batch<S>& batch = *segment.batch;
  for (int slot = segment.begin; slot < segment.end; ++slot)
    if (batch.law->by_mass(batch, slot)) f(slot);
}

// Their stiffness changes with the pose.
template <class S>
void work_of_stiffness(WorldData<S>& world, const Island<S>& island, const Segment<S>& segment, typename S::Scalar time,
                       const typename S::Velocity* v, double h, Work& work) {
  const Batch<S>& batch = *segment.batch;
  each_by_mass(segment, [&](int slot) {
    const Along<S> motion{time, moment_of(island, v), v};
    work.put(batch.source, h * power_of_stiffness(world, batch, slot, motion, world.one_slot, world.few));
  });
}

// Energies whose parameters follow functions of time, over h from the present C.
template <class S>
void work_of_drives(const Segment<S>& segment, double h, Work& work) {
  const Batch<S>& batch = *segment.batch;
  if (!batch.driven() || !batch.law || !batch.law->power) return;
  for (int slot = segment.begin; slot < segment.end; ++slot) work.put(batch.source, h * batch.law->power(batch, slot));
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

// True if nothing works in the first half of RATTLE, as where discs fly off what they roll on: no row has an impulse,
// and no force acts without an energy.
template <class S, class Kind>
bool rests(const WorldData<S>& world, const Island<S>& island, Kind impulses) {
  if (!island.drags.empty() || island.by_mass || world.driven) return false;
  return std::ranges::all_of(island.working, [&](const size_t k) {
    const Segment<S>& segment = island.segments[k];
    const Batch<S>& batch = *segment.batch;
    if (batch.explicit_time() || acts_unstored(batch)) return false;
    return idle(segment, batch.law && batch.law->force ? batch.lambda.data() : impulses_of(impulses, batch));
  });
}

// `impulses`, or a type that holds it: the halves of RATTLE are booked in each step, by code of their own.
template <class S, class Kind>
void book(WorldData<S>& world, Island<S>& island, Kind impulses, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (!(impulses == Impulses::drift ? island.driven : works_now(world, island))) return;
  if (impulses == Impulses::dampers && !has_springs(island)) return;
  if constexpr (!S::has_gyroscopes)
    if (impulses == Impulses::rattle_start && rests(world, island, impulses)) return;
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
  work_of_rows(
      world, island, [&](const Batch<S>& batch) { return impulses_of(impulses, batch); },
      [&](const Segment<S>& segment) { return rates_along(segment, mean.data(), segment.batch->rate); },
      [&](const Segment<S>& segment) {
        const auto* const rates = rates_along(segment, acted, segment.batch->impulse);
        if (at_end && sweeps(world.settings.solver)) find_rates_met(*segment.batch, segment.begin, segment.end);
        return rates;
      },
      {springs_of(impulses), rows_of(impulses), kick_of(impulses)}, island.evaluated_at, double(h), work);
  if (island.by_mass && (impulses == Impulses::rattle_start || impulses == Impulses::rattle_end))
    each_working(island, [&](const Segment<S>& segment) {
      if (may_stiffen(segment))
        work_of_stiffness(world, island, segment, island.evaluated_at, start.data(), double(h), work);
    });
  if (!of_rows && world.driven)
    each_working(island, [&](const Segment<S>& segment) { work_of_drives(segment, double(h), work); });
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

// Known forces have just acted at the present velocities, and something works.
template <class S>
void find_power(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar* power) {
  using T = typename S::Scalar;
  Work work{world.work_by_source.data()};  // not read: what each part adds to the sums is its own
  const auto* const v = world.bodies.velocity.data();
  work_on_bodies(world, island, v, v, true, false, T(1), work);
  const auto acted = [](const Segment<S>& segment) { return segment.batch->acted.data(); };
  const auto rates = [&](const Segment<S>& segment) { return rates_along(segment, v, segment.batch->rate); };
  power[sums_of_work] = T(-work.taken), power[sums_of_work + 1] = T(work.put_in);
  T* of_rows = power + work_of_bodies;
  each_working(island, [&](const Segment<S>& segment) {
    const Batch<S>& batch = *segment.batch;
    const double before = work.put_in - work.taken;
    if (batch.law && batch.law->force)
      work_of_whole_forces(world, segment, batch.lambda.data(), acted, acted, time, 1, work);
    else work_of_held_rows(segment, batch.lambda.data(), rates, Kick::only, work);
    if (island.by_mass && may_stiffen(segment)) work_of_stiffness(world, island, segment, time, v, 1, work);
    if (world.driven) work_of_drives(segment, 1, work);
    *of_rows++ = T(work.put_in - work.taken - before);
  });
  power[0] = T(work.put_in), power[1] = T(work.taken);
}

// K is still that of the step's start.
template <class S>
void book_stiffness(WorldData<S>& world, Island<S>& island) {
  if (!island.by_mass) return;
  each_working(island, [&](const Segment<S>& segment) {
    if (!may_stiffen(segment)) return;
    Batch<S>& batch = *segment.batch;
    each_by_mass(segment, [&](int slot) {
      const double before = batch.law->energy(batch, slot);
      batch.ops->effective_mass(batch, slot, slot + 1, world.bodies);
      const double change = batch.law->energy(batch, slot) - before;
      world.accounts.put_in += change;
      world.accounts.by_source[batch.source] += change;
    });
  });
}

#define CDOT_INSTANTIATE(S)                                                   \
  template void begin_kick(WorldData<S>&, const Island<S>&);                  \
  template void book_kick(WorldData<S>&, Island<S>&, Impulses, S::Scalar);    \
  template void find_power(WorldData<S>&, Island<S>&, S::Scalar, S::Scalar*); \
  template void book_stiffness(WorldData<S>&, Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
