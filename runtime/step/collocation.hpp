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

// --- Newton's linear systems (shift - df/dy) x = b, for real and complex shifts ---

// A = shift - J_v - J_q / shift
template <class T, class Number>
bool factor_shifted(const CollocationWorkspace<T>& work, Number shift, Lu<Number>& lu) {
  const size_t m = lu.size();
  const Number by = inverse_of(shift);
  for (size_t r = 0; r < m; ++r)
    for (size_t c = 0; c < m; ++c) {
      const double of_velocity = work.by_velocity[r * m + c], of_pose = work.by_pose[r * m + c];
      lu.at(r, c) = (r == c ? shift : Number{}) - (of_velocity * Number{1} + of_pose * by);
    }
  return lu.factor();
}

// The place of a velocity component among the numbers of the bodies.
template <class S>
constexpr size_t index_of_velocity(size_t component) {
  return component / S::freedom * numbers_per_body<S> + S::pose_numbers + component % S::freedom;
}

// B^+ r of each body: the columns of B are orthogonal.
template <class S, class Number>
void turn_back(const std::vector<double>& turns, const std::vector<Number>& side, std::vector<Number>& to) {
  const double* turn = turns.data();
  for (size_t k = 0; k < to.size(); ++k, turn += S::pose_numbers) {
    const Number* r = side.data() + k / S::freedom * numbers_per_body<S>;
    Number sum{};
    double square = 0;
    for (int p = 0; p < S::pose_numbers; ++p) sum = sum + turn[p] * r[p], square += turn[p] * turn[p];
    to[k] = (1 / square) * sum;
  }
}

// side = (shift - df/dy)^-1 side
template <class S, class Number>
void solve_shifted(const CollocationWorkspace<typename S::Scalar>& work, Lu<Number>& lu, Number shift,
                   std::vector<Number>& side, std::vector<Number>& turned) {
  const size_t m = lu.size();
  const Number by = inverse_of(shift);
  turn_back<S>(work.turns, side, turned);
  const auto velocity_of = [&](size_t k) -> Number& { return side[index_of_velocity<S>(k)]; };
  for (size_t r = 0; r < m; ++r) {
    Number sum{};
    for (size_t c = 0; c < m; ++c) sum = sum + work.by_pose[r * m + c] * turned[c];
    velocity_of(r) = velocity_of(r) + by * sum;
  }
  for (size_t k = 0; k < m; ++k) turned[k] = velocity_of(k);
  lu.solve(turned.data());
  const double* turn = work.turns.data();
  for (size_t k = 0; k < m; ++k, turn += S::pose_numbers) {
    velocity_of(k) = turned[k];
    Number* r = side.data() + k / S::freedom * numbers_per_body<S>;
    for (int p = 0; p < S::pose_numbers; ++p) r[p] = r[p] + turn[p] * turned[k];
  }
  for (size_t k = 0; k < side.size(); k += numbers_per_body<S>)
    for (size_t p = k; p < k + S::pose_numbers; ++p) side[p] = by * side[p];
}

}  // namespace cdot
