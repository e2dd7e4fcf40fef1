// The work of forces without a potential, put in and taken: drag, dampers, motors, friction, limits, joints that depend
// on time.
#include <algorithm>
#include <cmath>

#include <cdot/spaces.hpp>

#include "runtime/balance/balance.hpp"

namespace cdot {
namespace {

struct Work {
  double* by_source;             // put in, less taken
  double* first_kick = nullptr;  // Flow::first_kick
  double put_in = 0, taken = 0;
  void put(size_t source, double work) { put_in += work, by_source[source] += work; }
  // Work of a force that can only take. A part with the other sign is the method's own error.
  void take(size_t source, double work) {
    if (!(work >= 0)) taken -= work, by_source[source] += work;
  }
  // Work of a force that can do either.
  void give(size_t source, double work) {
    if (work > 0) put(source, work);
    else take(source, work);
  }
  void put(Source source, double work) { put(static_cast<size_t>(source), work); }
  void take(Source source, double work) { take(static_cast<size_t>(source), work); }
};

// dC/dt of one slot whose bias holds something else by now. C and J keep their values.
template <class S>
void find_drift(const WorldData<S>& world, Batch<S>& batch, int slot, typename S::Scalar time,
                typename S::Scalar* drift) {
  const int rows = batch.ops->rows;
  auto* const bias = batch.bias.data() + slot * rows;
  std::copy_n(bias, rows, drift);
  batch.ops->evaluate(batch, slot, slot + 1, world.bodies, time);
  std::swap_ranges(bias, bias + rows, drift);
}

// The force of dampers among the rows of a slot: that of the law at this rate, less that at rest.
template <class S>
void find_damping(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* force) {
  typename S::Scalar at_rest[most_rows] = {}, none[most_rows];
  batch.law->force(batch, slot, at_rest, none);
  batch.law->force(batch, slot, rate, force);
  for (int r = 0; r < batch.ops->rows; ++r) force[r] -= none[r];
}

// The parts of a spring in the impulses of its rows. RATTLE exerts springs as forces, which are in no impulse: those at
// rest, over h. Its impulses of springs are those of dampers.
enum class Springs : char { none, whole, dampers, without_dampers, as_forces };

// Rows of springs whose impulse is that of dampers alone, or of springs without dampers. Batch::rate has J v of the
// mean velocity. Of springs as forces C must be that of the kick.
template <class S, class Lambda>
void work_of_parted_springs(const WorldData<S>& world, Batch<S>& batch, int slot, Lambda lambda, Springs springs,
                            typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  constexpr T at_rest[most_rows] = {};
  T drift[most_rows] = {}, force[most_rows];
  if (batch.explicit_time()) find_drift(world, batch, slot, time, drift);
  if (springs == Springs::as_forces) batch.law->force(batch, slot, at_rest, force);
  for (int r = 0; r < batch.ops->rows; ++r) {
    const int i = slot * batch.ops->rows + r;
    const double impulse = springs == Springs::as_forces ? h * double(force[r]) : double(lambda(i));
    if (springs == Springs::dampers) work.take(batch.source, impulse * double(batch.rate[i] + drift[r]));
    work.put(batch.source, -impulse * double(drift[r]));
  }
}

// Effects whose impulse is that of what rates change, or the force at rest over h. C must be that of the kick.
template <class S, class Lambda>
void work_of_parted_effect(const WorldData<S>& world, Batch<S>& batch, int slot, Lambda lambda, bool of_rates,
                           typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  constexpr T at_rest[most_rows] = {};
  const int rows = batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time();
  T drift[most_rows], unstored[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  if (!of_rates) batch.law->unstored(batch, slot, at_rest, unstored);
  double done = 0;
  for (int r = 0; r < rows; ++r) {
    const T rate = drifts ? batch.rate[first + r] + drift[r] : batch.rate[first + r];
    done += (of_rates ? double(lambda(first + r)) : h * double(unstored[r])) * double(rate);
  }
  work.give(batch.source, done);
  if (!drifts) return;
  T whole[most_rows];
  if (!of_rates) batch.law->force(batch, slot, at_rest, whole);
  for (int r = 0; r < rows; ++r)
    work.put(batch.source, -(of_rates ? double(lambda(first + r)) : h * double(whole[r])) * double(drift[r]));
}

// Rows that are springs, given J v of the rate at which they acted and, in Batch::rate, of the mean velocity. Of an
// effect without energy the impulse itself does the work: a stiff servo acts implicitly, so its force is not that of C.
template <class S, class Lambda>
void work_of_springs(const WorldData<S>& world, Batch<S>& batch, int slot, const typename S::Scalar* acted,
                     Lambda lambda, typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  T drift[most_rows] = {}, rate[most_rows], force[most_rows];
  if (batch.explicit_time()) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows; ++r) rate[r] = acted[r] + drift[r];
  const bool of_effect = batch.law->is_of_effect(), by_impulse = of_effect && !batch.law->energy;
  if (of_effect) batch.law->unstored(batch, slot, rate, force);
  else find_damping(batch, slot, rate, force);
  double done = 0;
  for (int r = 0; r < rows; ++r) {
    const int i = slot * rows + r;
    const double impulse = by_impulse ? double(lambda(i)) : h * double(force[r]);
    const double of_row = impulse * double(batch.rate[i] + drift[r]);
    if (of_effect) done += of_row;
    else work.take(batch.source, of_row);
    work.put(batch.source, -double(lambda(i)) * double(drift[r]));
  }
  work.give(batch.source, done);
}

// Whether a step exerts the impulses of rows in one kick or in two. Work that is only taken is that of both.
enum class Kick : char { only, first, second };

// A rate of 0 by a force that may be 0 is friction, which can only take.
template <class S>
void work_of_rate(const Batch<S>& batch, const Guard<typename S::Scalar>& guard, double done, Work& work) {
  const bool drives = guard.rate != 0 || guard.lower > 0 || guard.upper < 0;
  if (drives || batch.law->in_time || batch.explicit_time()) work.put(batch.source, done);
  else work.take(batch.source, done);
}

// Rows with bounds: motors put in, friction takes, limits, ropes and latches take what hits them. Other rows that are
// held on both sides without a rate of their own do no work. Flow::first_kick keeps that of the first kick.
template <class S, class Lambda>
void work_of_bounded(Batch<S>& batch, int slot, Lambda lambda, Kick kick, Work& work) {
  const int rows = batch.ops->rows;
  double done[most_rows];
  bool idle = true;
  for (int r = 0; r < rows; ++r) {
    const int i = slot * rows + r;
    done[r] = double(lambda(i)) * double(batch.rate[i]) + (kick == Kick::second ? work.first_kick[r] : 0);
    idle = idle && done[r] == 0;
  }
  if (kick == Kick::first) std::copy_n(done, rows, work.first_kick);
  if (kick != Kick::only) work.first_kick += rows;
  if (idle || kick == Kick::first) return;
  Guard<typename S::Scalar> guards[most_rows];
  batch.law->guard(batch, slot, guards);
  for (int r = 0; r < rows; ++r) {
    if (!batch.law->error) work_of_rate(batch, guards[r], done[r], work);  // a motor or dry friction
    else if (batch.driven() && !batch.drives_of(slot).empty()) work.give(batch.source, done[r]);
    else if (batch.explicit_time()) work.put(batch.source, done[r]);
    else if (guards[r].one_sided()) work.take(batch.source, done[r]);
    else if (batch.law->distance) work.give(batch.source, done[r]);
  }
}

// All rows that may do work, given J v of mean velocities by batch.ops->velocity(..., mean). `acted` finds J v at which
// whole springs acted, into Batch::impulse. alone: rows that are no springs have no impulse.
template <class S, class Lambda, class Acted>
void work_of_rows(WorldData<S>& world, const Island<S>& island, const typename S::Velocity* mean, Lambda lambda,
                  Acted acted, Springs springs, bool alone, Kick kick, typename S::Scalar time, double h, Work& work) {
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    const int begin = segment.begin, end = segment.end, rows = batch.ops->rows;
    if (!batch.law && !batch.explicit_time()) continue;
    if (alone && !(batch.law && batch.law->spring)) continue;
    if (springs == Springs::none && batch.law && (batch.law->spring || batch.law->force)) continue;
    batch.ops->velocity(batch, begin, end, mean, batch.rate.data());
    const auto of_row = [&](int i) { return lambda(batch, i); };
    if (!batch.law) {
      for (int i = begin * rows; i < end * rows; ++i) work.put(batch.source, double(of_row(i)) * double(batch.rate[i]));
    } else if (batch.law->spring && springs != Springs::whole) {
      const auto work_of_part = [&](int slot, Springs part, auto impulse) {
        const bool of_rates = part == Springs::dampers;
        if (batch.law->is_of_effect()) work_of_parted_effect(world, batch, slot, impulse, of_rates, time, h, work);
        else work_of_parted_springs(world, batch, slot, impulse, part, time, h, work);
      };
      const auto of_dampers = [&](int i) { return batch.lambda[i]; };
      for (int slot = begin; slot < end; ++slot) {
        if (springs == Springs::as_forces) work_of_part(slot, Springs::dampers, of_dampers);
        work_of_part(slot, springs, of_row);
      }
    } else if (batch.law->force) {
      const auto* const rates = acted(batch, begin, end);
      for (int slot = begin; slot < end; ++slot)
        work_of_springs(world, batch, slot, rates + slot * rows, of_row, time, h, work);
    } else if (batch.law->guard) {
      for (int slot = begin; slot < end; ++slot) work_of_bounded(batch, slot, of_row, kick, work);
    }
  }
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
  const auto has_springs = [](const Segment<S>& segment) { return segment.batch->law && segment.batch->law->by_mass; };
  if (std::ranges::none_of(island.segments, has_springs)) return;
  const Along<S> motion{time, moment_of(island, v), v};
  for (const Segment<S>& segment : island.segments) {
    if (!has_springs(segment)) continue;
    const Batch<S>& batch = *segment.batch;
    for (int slot = segment.begin; slot < segment.end; ++slot)
      if (batch.law->by_mass(batch, slot))
        work.put(batch.source, h * power_of_stiffness(world, batch, slot, motion, world.one_slot, world.few));
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
typename S::Scalar impulse_of(Impulses impulses, const Batch<S>& batch, int i) {
  const bool spring = batch.law && batch.law->spring;
  const bool no_springs = impulses == Impulses::rattle_end || impulses == Impulses::relaxed;
  if (impulses == Impulses::dampers ? !spring : no_springs && spring) return 0;
  const bool corrected = impulses == Impulses::rattle_start || impulses == Impulses::middle ||
                         impulses == Impulses::drift || impulses == Impulses::relaxed;
  return corrected ? batch.correction[i] : batch.lambda[i];
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

}  // namespace

template <class S>
void begin_kick(WorldData<S>& world, const Island<S>& island) {
  if (!works_now(world, island)) return;
  for (int i : island.bodies) world.start_of_kick[i] = world.bodies.velocity[i];
}

template <class S>
void book_kick(WorldData<S>& world, Island<S>& island, Impulses impulses, typename S::Scalar h) {
  using T = typename S::Scalar;
  if (!(impulses == Impulses::drift ? island.driven : works_now(world, island))) return;
  if (impulses == Impulses::dampers && !has_springs(island)) return;
  const auto& v = world.bodies.velocity;
  auto &start = world.start_of_kick, &mean = world.mean_of_kick;
  for (size_t k = 0; k < island.bodies.size(); ++k) {
    const int i = island.bodies[k];
    const auto& from = impulses == Impulses::rattle_end ? island.flow.velocity[k] : start[i];
    mean[i] = impulses == Impulses::middle ? v[i] : S::damped(S::sum(from, v[i], T(1)), T(0.5), T(0.5));
    if (impulses == Impulses::rattle_start) start[i] = island.flow.velocity[k];
  }
  const bool at_end = impulses == Impulses::euler || impulses == Impulses::soft;
  const auto* const acted = at_end ? v.data() : start.data();
  Work work{world.accounts.by_source.data(), island.flow.first_kick.data()};
  const bool of_rows = impulses == Impulses::drift || impulses == Impulses::dampers || impulses == Impulses::end ||
                       impulses == Impulses::relaxed;
  if (!of_rows) work_on_bodies(world, island, start.data(), mean.data(), impulses != Impulses::middle, at_end, h, work);
  work_of_rows(
      world, island, mean.data(), [&](const Batch<S>& batch, int i) { return impulse_of(impulses, batch, i); },
      [&](Batch<S>& batch, int begin, int end) {
        batch.ops->velocity(batch, begin, end, acted, batch.impulse.data());
        if (at_end && sweeps(world.settings.solver)) find_rates_met(batch, begin, end);
        return batch.impulse.data();
      },
      springs_of(impulses), impulses == Impulses::dampers, kick_of(impulses), island.evaluated_at, double(h), work);
  if (impulses == Impulses::rattle_start || impulses == Impulses::rattle_end)
    work_of_stiffness(world, island, island.evaluated_at, start.data(), double(h), work);
  if (!of_rows && world.driven) work_of_drives(island, double(h), work);
  add(world, work);
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
      world, island, v, [](const Batch<S>& batch, int i) { return batch.lambda[i]; },
      [&](Batch<S>& batch, int begin, int end) {
        batch.ops->effective_mass(batch, begin, end, world.bodies);
        return batch.rate.data();
      },
      Springs::whole, false, Kick::only, time, 1, work);
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
