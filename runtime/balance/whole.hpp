// The work of springs and effects whose forces act whole, not in parts (parted.hpp).
#pragma once

#include "runtime/balance/parted.hpp"

namespace cdot {

// The force of dampers among the rows of a slot: that of the law at this rate, less that at rest.
template <class S>
void find_damping(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* force) {
  typename S::Scalar none[most_rows];
  batch.law->force(batch, slot, at_rest<typename S::Scalar>, none);
  batch.law->force(batch, slot, rate, force);
  for (int r = 0; r < batch.ops->rows; ++r) force[r] -= none[r];
}

// Rows that are springs, at most so many, given J v of the rate at which they acted and `mean` of the mean velocity.
template <int most, class S>
void work_of_springs(const WorldData<S>& world, Batch<S>& batch, int slot, const typename S::Scalar* acted,
                     const typename S::Scalar* mean, const typename S::Scalar* lambda, typename S::Scalar time,
                     double h, Work& work) {
  using T = typename S::Scalar;
  const int rows = most == 1 ? 1 : batch.ops->rows, first = slot * rows;
  const bool drifts = batch.explicit_time(), of_effect = batch.law->is_of_effect();
  T drift[most_rows], rate[most_rows], force[most_rows];
  if (drifts) find_drift(world, batch, slot, time, drift);
  for (int r = 0; r < rows; ++r) rate[r] = drifts ? acted[first + r] + drift[r] : acted[first + r];
  if (of_effect) batch.law->unstored(batch, slot, rate, force);
  else find_damping(batch, slot, rate, force);
  double done = 0;
  for (int r = 0; r < rows; ++r) {
    const int i = first + r;
    const double of_row = h * double(force[r]) * double(drifts ? mean[i] + drift[r] : mean[i]);
    if (of_effect) done += of_row;
    else work.take(batch.source, of_row);
    if (drifts) work.put(batch.source, -double(lambda[i]) * double(drift[r]));
  }
  if (of_effect) work.give(batch.source, done);
}

// The work of impulses `lambda` along dC/dt, which they give, and which what moves C puts in against them.
template <class S>
[[gnu::noinline]] double work_of_drift(const WorldData<S>& world, Batch<S>& batch, int slot,
                                       const typename S::Scalar* lambda, typename S::Scalar time, Work& work) {
  typename S::Scalar drift[most_rows];
  find_drift(world, batch, slot, time, drift);
  double along = 0;
  for (int r = 0, i = slot * batch.ops->rows; r < batch.ops->rows; ++r, ++i) {
    along += double(lambda[i]) * double(drift[r]);
    work.put(batch.source, -double(lambda[i]) * double(drift[r]));
  }
  return along;
}

// Effects without energy, of which the impulses themselves do the work: a stiff servo acts implicitly, so its force is
// not that of C. Inline, because for one row the call would cost as much as the work.
template <class S>
[[gnu::always_inline]] inline void work_of_impulses(const WorldData<S>& world, const Segment<S>& segment,
                                                    const typename S::Scalar* mean, const typename S::Scalar* lambda,
                                                    typename S::Scalar time, Work& work) {
  Batch<S>& batch = *segment.batch;
  const int rows = batch.ops->rows;
  const bool drifts = batch.explicit_time();
  for (int slot = segment.begin, i = slot * rows; slot < segment.end; ++slot) {
    double done = drifts ? work_of_drift(world, batch, slot, lambda, time, work) : 0;
    for (int r = 0; r < rows; ++r, ++i) done += double(lambda[i]) * double(mean[i]);
    work.give(batch.source, done);
  }
}

// True if an energy stores all work of these forces: of a gas spring, or of springs without dampers.
template <class S>
[[gnu::always_inline]] inline bool stores_all(const Segment<S>& segment) {
  const Batch<S>& batch = *segment.batch;
  const Law<S>& law = *batch.law;
  if (batch.explicit_time()) return false;
  if (law.is_of_effect()) return law.energy && !law.stores_part;
  SpringNumbers<typename S::Scalar> springs[most_rows];
  for (int slot = segment.begin; slot < segment.end; ++slot) {
    law.spring(batch, slot, springs);
    for (int r = 0; r < batch.ops->rows; ++r)
      if (springs[r].d != 0) return false;
  }
  return true;
}

// `rates` gives J v of the mean velocities, and `acted` that at which the forces acted. C and K are those of the
// forces.
template <class S, class Rates, class Acted>
void work_of_whole_forces(const WorldData<S>& world, const Segment<S>& segment, const typename S::Scalar* lambda,
                          Rates rates, Acted acted, typename S::Scalar time, double h, Work& work) {
  if (stores_all(segment)) return;
  Batch<S>& batch = *segment.batch;
  const auto* const mean = rates(segment);
  if (batch.law->is_of_effect() && !batch.law->energy)
    return work_of_impulses(world, segment, mean, lambda, time, work);
  const auto* const at = acted(segment);
  for (int slot = segment.begin; slot < segment.end; ++slot)
    batch.ops->rows == 1 ? work_of_springs<1>(world, batch, slot, at, mean, lambda, time, h, work)
                         : work_of_springs<most_rows>(world, batch, slot, at, mean, lambda, time, h, work);
}

}  // namespace cdot
