// The work of springs and effects whose impulses part: into those of dampers, or of what rates change, and those of the
// forces at rest.
#pragma once

#include <algorithm>

#include "runtime/balance/balance.hpp"

namespace cdot {

struct Work {
  double* by_source;             // put in, less taken
  double* first_kick = nullptr;  // Flow::first_kick, from the next row on
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

template <class T>
constexpr T at_rest[most_rows] = {};

// Of a force at rest an energy may store a part: then the other part is kept after it.
template <class S>
bool stores_some(const Batch<S>& batch) {
  return batch.law->is_of_effect() && batch.law->energy;
}
template <class S>
int numbers_at_rest(const Batch<S>& batch) {
  return (stores_some(batch) ? 2 : 1) * batch.ops->rows;
}
template <class S>
void find_unstored_at_rest(const Batch<S>& batch, int slot, double* to) {
  typename S::Scalar unstored[most_rows];
  batch.law->unstored(batch, slot, at_rest<typename S::Scalar>, unstored);
  for (int r = 0; r < batch.ops->rows; ++r) to[r] = double(unstored[r]);
}
template <class S>
void find_at_rest(const Batch<S>& batch, int slot, double* to) {
  typename S::Scalar whole[most_rows];
  batch.law->force(batch, slot, at_rest<typename S::Scalar>, whole);
  for (int r = 0; r < batch.ops->rows; ++r) to[r] = double(whole[r]);
  if (stores_some(batch)) find_unstored_at_rest(batch, slot, to + batch.ops->rows);
}

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

// The parts of a spring in the impulses of its rows. RATTLE exerts springs as forces, which are in no impulse: those at
// rest, over h, which its kick left in Flow::first_kick. Its impulses of springs are those of dampers.
enum class Springs : char { none, whole, dampers, without_dampers, as_forces };

// Rows of springs whose impulse is that of dampers alone, of springs without dampers, or both as forces. `lambda` is
// that of the part in impulses. Batch::rate has J v of the mean velocity. C must be that of the kick.
template <class S, class Lambda>
void work_of_parted_springs(const WorldData<S>& world, Batch<S>& batch, int slot, Lambda lambda, Springs springs,
                            typename S::Scalar time, double h, Work& work) {
  const int rows = batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time();
  typename S::Scalar drift[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows && springs != Springs::without_dampers; ++r) {
    const double impulse = lambda(first + r);
    work.take(batch.source, impulse * double(drifts ? batch.rate[first + r] + drift[r] : batch.rate[first + r]));
    if (drifts) work.put(batch.source, -impulse * double(drift[r]));
  }
  for (int r = 0; r < rows && drifts && springs != Springs::dampers; ++r) {
    const double impulse = springs == Springs::as_forces ? h * work.first_kick[r] : double(lambda(first + r));
    work.put(batch.source, -impulse * double(drift[r]));
  }
}

// Effects whose impulse is that of what rates change, or the force at rest over h, or both.
template <class S, class Lambda>
void work_of_parted_effect(const WorldData<S>& world, Batch<S>& batch, int slot, Lambda lambda, Springs springs,
                           typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time();
  T drift[most_rows], rate[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows; ++r) rate[r] = drifts ? batch.rate[first + r] + drift[r] : batch.rate[first + r];
  const auto give = [&](auto impulse, auto whole) {
    double done = 0;
    for (int r = 0; r < rows; ++r) done += impulse(r) * double(rate[r]);
    work.give(batch.source, done);
    for (int r = 0; r < rows && drifts; ++r) work.put(batch.source, -whole(r) * double(drift[r]));
  };
  const auto of_rates = [&](int r) { return double(lambda(first + r)); };
  if (springs != Springs::without_dampers) give(of_rates, of_rates);
  if (springs == Springs::dampers) return;
  double now[2 * most_rows];
  if (springs != Springs::as_forces) find_at_rest(batch, slot, now);
  const double* const resting = springs == Springs::as_forces ? work.first_kick : now;
  const double* const unstored = stores_some(batch) ? resting + rows : resting;
  give([&](int r) { return h * unstored[r]; }, [&](int r) { return h * resting[r]; });
}

}  // namespace cdot
