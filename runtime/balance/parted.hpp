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

// The parts of a spring in the impulses of its rows. RATTLE exerts springs as forces (work_of_forces()).
enum class Springs : char { none, whole, dampers, without_dampers, as_forces };

// Rows of springs whose impulse `lambda` is that of dampers alone, or of springs without dampers. Batch::rate has J v
// of the mean velocity. C must be that of the kick.
template <class S>
void work_of_parted_springs(const WorldData<S>& world, Batch<S>& batch, int slot, const typename S::Scalar* lambda,
                            Springs springs, typename S::Scalar time, Work& work) {
  const int rows = batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time();
  typename S::Scalar drift[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows; ++r) {
    const double impulse = lambda[first + r];
    if (springs == Springs::dampers)
      work.take(batch.source, impulse * double(drifts ? batch.rate[first + r] + drift[r] : batch.rate[first + r]));
    if (drifts) work.put(batch.source, -impulse * double(drift[r]));
  }
}

// Effects whose impulse `lambda` is that of what rates change, or the force at rest over h.
template <class S>
void work_of_parted_effect(const WorldData<S>& world, Batch<S>& batch, int slot, const typename S::Scalar* lambda,
                           Springs springs, typename S::Scalar time, double h, Work& work) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time();
  T drift[most_rows] = {}, whole[most_rows], unstored[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  const auto give = [&](auto impulse, auto all) {
    double done = 0;
    for (int r = 0; r < rows; ++r) done += impulse(r) * double(batch.rate[first + r] + drift[r]);
    work.give(batch.source, done);
    for (int r = 0; r < rows && drifts; ++r) work.put(batch.source, -all(r) * double(drift[r]));
  };
  const auto of_rates = [&](int r) { return double(lambda[first + r]); };
  if (springs == Springs::dampers) return give(of_rates, of_rates);
  batch.law->force(batch, slot, at_rest<T>, whole);
  batch.law->unstored(batch, slot, at_rest<T>, unstored);
  give([&](int r) { return h * double(unstored[r]); }, [&](int r) { return h * double(whole[r]); });
}

// Adds dC/dt to Batch::rate, and puts in the work of what moves C against the impulses.
template <class S>
void add_drifts(const WorldData<S>& world, const Segment<S>& segment, typename S::Scalar time, double h, Work& work) {
  Batch<S>& batch = *segment.batch;
  typename S::Scalar drift[most_rows];
  for (int slot = segment.begin, i = slot * batch.ops->rows; slot < segment.end; ++slot) {
    find_drift(world, batch, slot, time, drift);
    for (int r = 0; r < batch.ops->rows; ++r, ++i) {
      const double of_rates = batch.law->spring ? double(batch.lambda[i]) : 0;
      work.put(batch.source, -(of_rates + h * double(batch.at_rest[i])) * double(drift[r]));
      batch.rate[i] += drift[r];
    }
  }
}

// True if no energy stores all that these forces do at rest.
template <class S>
bool acts_unstored(const Batch<S>& batch) {
  const Law<S>* law = batch.law;
  return law && law->force && (law->stores_part || (law->is_of_effect() && !law->energy));
}

// Rows that RATTLE exerts as forces: Batch::at_rest over h, and in Batch::lambda the impulses of what rates change.
// Most need no rates: an energy stores the whole force at rest, and nothing damps.
template <class S, class Rates>
void work_of_forces(const WorldData<S>& world, const Segment<S>& segment, Rates rates, typename S::Scalar time,
                    double h, Work& work) {
  Batch<S>& batch = *segment.batch;
  const Law<S>& law = *batch.law;
  const int rows = batch.ops->rows, begin = segment.begin * rows, end = segment.end * rows;
  const bool of_effect = law.is_of_effect(), unstored = acts_unstored(batch);
  const bool drifts = batch.explicit_time();
  const auto* const lambda = batch.lambda.data();
  if (!drifts && !unstored && std::all_of(lambda + begin, lambda + end, [](auto x) { return x == 0; })) return;
  const auto* const rate = rates(segment);
  if (drifts) add_drifts(world, segment, time, h, work);
  if (!law.spring) return;
  if (!of_effect) {
    for (int i = begin; i < end; ++i) work.take(batch.source, double(lambda[i]) * double(rate[i]));
    return;
  }
  const auto* const resting = (law.stores_part ? batch.unstored_at_rest : batch.at_rest).data();
  for (int first = begin; first < end; first += rows) {
    double by_rates = 0, at_rest = 0;
    for (int i = first; i < first + rows; ++i) {
      by_rates += double(lambda[i]) * double(rate[i]);
      at_rest += double(resting[i]) * double(rate[i]);
    }
    work.give(batch.source, by_rates);
    if (unstored) work.give(batch.source, h * at_rest);
  }
}

}  // namespace cdot
