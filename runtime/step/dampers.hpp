// Damped springs in steps of kicks and drifts. The kicks have the springs' forces; dampers act at both ends of the
// step, implicitly at the second, so that a step of any length is stable.
#pragma once

#include <algorithm>
#include <limits>

#include "runtime/state/world_data.hpp"

namespace cdot {

// Springs and constant forces on coordinates: their force follows from C and its rate.
template <class S>
bool is_force(const Batch<S>& batch) {
  return batch.law && batch.law->force;
}
// Limits, motors and friction: they act at the ends of the step.
template <class S>
bool is_bounded(const Batch<S>& batch) {
  return batch.law && !batch.law->force;
}

// Rows of ropes.
template <class S>
bool pulls_only(const Batch<S>& batch, int i) {
  return batch.kinds[static_cast<size_t>(i % batch.ops->rows)] == RowKind::inequality;
}

// f(i, spring, K) for all rows of a batch that are springs. C and K must be present.
template <class S, class F>
void each_spring(const Batch<S>& batch, int begin, int end, F f) {
  if (!batch.law || !batch.law->spring) return;
  const int rows = batch.ops->rows;
  SpringNumbers<typename S::Scalar> springs[most_rows];
  for (int slot = begin; slot < end; ++slot) {
    batch.law->spring(batch, slot, springs);
    for (int r = 0; r < rows; ++r)
      f(slot * rows + r, springs[r], batch.factor[slot * batch.triangle() + r * (r + 1) / 2 + r]);
  }
}

// K of the rows under a law, which the numbers of springs need.
template <class S>
void weigh_springs(const WorldData<S>& world, const Island<S>& island);

// The force of springs at rest and of constant forces, times h, into Batch::impulse.
template <class S>
void find_spring_impulses(Batch<S>& batch, int begin, int end, typename S::Scalar h);

// The impulses of dampers at the start of a step of h, into `lambda` and the velocities. C, J and K must be present.
template <class S>
void push_dampers(WorldData<S>& world, Island<S>& island, typename S::Scalar h);

// Makes the rows of springs those of the dampers at the end of a step of h, for the solver. calm: springs too stiff for
// the step are damped as well. pulled(batch, i): the impulse of the row before, which a rope must not exceed by
// pushing.
template <class S, class F>
void bound_dampers(Batch<S>& batch, int begin, int end, typename S::Scalar h, bool calm, F pulled);

// As impulse per rate. With z = h d K and u = h^2 k K:
//   start = h d min(1/2, 1/z),   end = h d - start + h^2 k max(0, 1 - 1/u)
// Below z = 2 this is the trapezoidal rule. Above, it stops the motion, which the rule would reverse. The
// last term, of `calm`, ends oscillations too fast for the step, u > 1.
template <class T>
struct Dampers {
  T start, end;
};
template <class T>
Dampers<T> dampers(const SpringNumbers<T>& spring, T K, T h, bool calm) {
  const T mass = inverse(K), start = std::min(T(0.5) * h * spring.d, mass);
  return {start, h * spring.d - start + (calm ? std::max(T(0), h * h * spring.k - mass) : T(0))};
}

template <class S, class F>
void bound_dampers(Batch<S>& batch, int begin, int end, typename S::Scalar h, bool calm, F pulled) {
  using T = typename S::Scalar;
  const int rows = batch.ops->rows;
  for (int i = begin * rows; i < end * rows; ++i) {
    batch.softness[i] = 0;
    batch.lower[i] = batch.upper[i] = pulls_only(batch, i) ? std::max(T(0), -pulled(batch, i)) : T(0);
  }
  each_spring(batch, begin, end, [&](int i, const SpringNumbers<T>& spring, T K) {
    const T damper = dampers(spring, K, h, calm).end;
    if (!(damper > T(0))) return;
    batch.softness[i] = inverse(damper);
    batch.lower[i] = pulls_only(batch, i) ? -pulled(batch, i) : -std::numeric_limits<T>::infinity();
    batch.upper[i] = std::numeric_limits<T>::infinity();
  });
}

}  // namespace cdot
