// The stages of an implicit Runge-Kutta method (runge_kutta_tables.hpp): z_i = h sum_j a_ij f(y + z_j) for the
// increments z of an island's numbers, by Newton with df/dy at the start of the step. (E. Hairer, G. Wanner, "Solving
// Ordinary Differential Equations II", 1996, IV.8.)
//
// Poses follow from velocities: dq/dt = B(q) v, with B constant within a step of Newton's matrix. For the shift s of an
// eigenvalue, (s - df/dy) (dq, dv) = (r, r') is then, with J_q by displacements and J_v by velocities,
//   (s - J_v - J_q / s) dv = r' + J_q B^+ r / s,   dq = (r + B dv) / s,
// half as large. df/dy comes from differences of accelerations, anew at every step: a step depends on nothing but its
// start.
//
// The forces of springs and dampers are unknowns of their own, f = a(y, F) with F = law(y): with y alone, Newton would
// converge only where a stiff spring turns by less than sqrt(m / k) / h in a step. From the forces F of a round follow
//   f = a(y, F) + da/dF (law(y) - F),   then F = law(y) + dlaw/dy dy.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

// True if Newton's dense matrix is bounded for this island. Otherwise its steps fail.
template <class S>
bool fits_collocation(const Island<S>& island);

template <class S>
void prepare_collocation(Island<S>& island);

// Call when the start of the next steps is kept. `goes_on`: it is the end of the last step, whose polynomial gives the
// first guess.
template <class S>
void begin_collocation(Island<S>& island, bool goes_on);

// Finds the k of the stages of a step of h and its error. Leaves its end in the bodies, not yet projected. False if
// Newton does not converge.
template <class S>
bool collocate(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
               typename S::Scalar h);

// A better estimate of an error that seems too large: from the slope at the start less the first estimate, which leaves
// out what is stiff.
template <class S>
void refine_error(WorldData<S>& world, Island<S>& island, const RungeKuttaOf<S>& method, typename S::Scalar time,
                  typename S::Scalar h);

// df/dy, da/dF and dlaw/dy at Flow::start (differences.cpp). Leaves the bodies there.
template <class S>
void differentiate(WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// f(batch, i, k) for every row with a known force, its k-th.
template <class S, class F>
void each_known_force(const Island<S>& island, F f) {
  size_t k = 0;
  for (const Segment<S>& segment : island.segments) {
    Batch<S>& batch = *segment.batch;
    if (!batch.law || !batch.law->force) continue;
    for (int i = segment.begin * batch.ops->rows; i < segment.end * batch.ops->rows; ++i) f(batch, i, k++);
  }
}

}  // namespace cdot
