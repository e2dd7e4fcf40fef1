// Newton's linear systems (shift - df/dy) x = b of collocation.hpp, for real and complex shifts.
#pragma once

#include "runtime/step/runge_kutta.hpp"

namespace cdot {

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
