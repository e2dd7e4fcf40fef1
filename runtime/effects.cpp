// Effects on coordinates, one law each. Only a program that calls the functions at the end links
// this file.
#include "runtime/effects.hpp"

#include <fmt/format.h>

#include <cmath>

#include "runtime/add_rows.hpp"
#include "runtime/laws.hpp"
#include "runtime/world_state.hpp"

namespace cdot {
namespace {

// --- limit: lower <= C <= upper. Constants: lower, upper. One row serves both sides, the nearer
// one at a time.

template <class T>
bool nearer_to_lower(T C, const T* limits) {
  return C - limits[0] < limits[1] - C;
}

template <class S>
void fill_limit(Batch<S>& batch, int begin, int end, typename S::Scalar h,
                const Settings& settings) {
  using T = typename S::Scalar;
  for (int i = begin; i < end; ++i) {
    const T* limits = batch.constants.data() + 2 * i;
    if (nearer_to_lower(batch.C[i], limits)) {
      batch.lower[i] = T(0);
      batch.upper[i] = T(unlimited);
      batch.bias[i] += unilateral_bias(batch.C[i] - limits[0], h, settings);
    } else {
      batch.lower[i] = -T(unlimited);
      batch.upper[i] = T(0);
      batch.bias[i] -= unilateral_bias(limits[1] - batch.C[i], h, settings);
    }
  }
}

template <class S>
void error_limit(const Batch<S>& batch, int slot, typename S::Scalar* error) {
  using T = typename S::Scalar;
  const T C = batch.C[slot], *limits = batch.constants.data() + 2 * slot;
  *error =
      nearer_to_lower(C, limits) ? std::fmin(C - limits[0], T(0)) : std::fmax(C - limits[1], T(0));
}

template <class S>
void guard_limit(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guard) {
  using T = typename S::Scalar;
  const T C = batch.C[slot], *limits = batch.constants.data() + 2 * slot;
  *guard = nearer_to_lower(C, limits) ? Guard<T>{C - limits[0], T(0), T(0), T(unlimited)}
                                      : Guard<T>{C - limits[1], T(0), -T(unlimited), T(0)};
}

// --- lock, a limit whose ends are one: C = at. Constants: at.

template <class S>
void fill_lock(Batch<S>& batch, int begin, int end, typename S::Scalar h,
               const Settings& settings) {
  using T = typename S::Scalar;
  const T share = settings.drift == Drift::baumgarte ? T(settings.baumgarte) / h : T(0);
  for (int i = begin; i < end; ++i) batch.bias[i] += share * (batch.C[i] - batch.constants[i]);
}

template <class S>
void error_lock(const Batch<S>& batch, int slot, typename S::Scalar* error) {
  *error = batch.C[slot] - batch.constants[slot];
}

template <class S>
void guard_lock(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guard) {
  using T = typename S::Scalar;
  *guard = {batch.C[slot] - batch.constants[slot], T(0), -T(unlimited), T(unlimited)};
}

// --- motor: J v = speed, as far as its force reaches. Constants: speed, largest force.
// --- dry friction is a motor of speed 0.

template <class S>
void fill_motor(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings&) {
  for (int i = begin; i < end; ++i) {
    const auto* constants = batch.constants.data() + 2 * i;
    batch.bias[i] -= constants[0];
    batch.upper[i] = h * constants[1];
    batch.lower[i] = -batch.upper[i];
  }
}

template <class S>
void guard_motor(const Batch<S>& batch, int slot, Guard<typename S::Scalar>* guard) {
  const auto* constants = batch.constants.data() + 2 * slot;
  *guard = {0, constants[0], -constants[1], constants[1]};
}

// --- spring and damper about a rest position. Constants: those of spring_constants(), rest.

template <class S>
void fill_spring(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings&) {
  for (int i = begin; i < end; ++i) {
    const auto* constants = batch.constants.data() + 4 * i;
    const auto row = spring_row(batch.C[i] - constants[3], batch.factor[i], constants, h);
    batch.bias[i] += row.bias;
    batch.softness[i] = row.softness;
  }
}

template <class S>
double energy_spring(const Batch<S>& batch, int slot) {
  const auto* constants = batch.constants.data() + 4 * slot;
  const double stretch = batch.C[slot] - constants[3];
  return 0.5 * spring_stiffness(batch.factor[slot], constants) * stretch * stretch;
}

template <class S>
void force_of_spring(const Batch<S>& batch, int slot, const typename S::Scalar* rate,
                     typename S::Scalar* force) {
  const auto* constants = batch.constants.data() + 4 * slot;
  *force = spring_force(batch.C[slot] - constants[3], *rate, batch.factor[slot], constants);
}

template <class S>
constexpr Law<S> limit_law{2,       false,   fill_limit<S>, error_limit<S>,
                           nullptr, nullptr, guard_limit<S>};
template <class S>
constexpr Law<S> lock_law{1, false, fill_lock<S>, error_lock<S>, nullptr, nullptr, guard_lock<S>};
template <class S>
constexpr Law<S> motor_law{2, false, fill_motor<S>, nullptr, nullptr, nullptr, guard_motor<S>};
template <class S>
constexpr Law<S> spring_law{4,       false, fill_spring<S>, nullptr, energy_spring<S>, force_of_spring<S>,
                            nullptr};

}  // namespace

template <class S>
void add_limit(BasicWorld<S>& world, int joint, std::string_view coordinate, const Limit& limit) {
  const double constants[] = {limit.lower.value_or(-unlimited), limit.upper.value_or(unlimited)};
  if (!(constants[0] <= constants[1]))
    throw Error(fmt::format("a limit's lower end {} must not lie above its upper end {}",
                            constants[0], constants[1]));
  if (!limit.lower && !limit.upper) throw Error("a limit needs a lower or an upper end");
  if (constants[0] == constants[1])
    return add_coordinate_row(world.state(), joint, coordinate, &lock_law<S>, constants);
  add_coordinate_row(world.state(), joint, coordinate, &limit_law<S>, constants);
}

template <class S>
void add_motor(BasicWorld<S>& world, int joint, std::string_view coordinate, const Motor& motor) {
  if (!std::isfinite(motor.speed)) throw Error("a motor's speed must be finite");
  if (!(motor.max_force >= 0)) throw Error("a motor's largest force must be >= 0");
  const double constants[] = {motor.speed, motor.max_force};
  add_coordinate_row(world.state(), joint, coordinate, &motor_law<S>, constants);
}

template <class S>
void add_spring(BasicWorld<S>& world, int joint, std::string_view coordinate,
                const CoordinateSpring& spring) {
  double constants[4];
  spring_constants(spring.softness, constants);
  if (!std::isfinite(spring.rest)) throw Error("a spring's rest position must be finite");
  constants[3] = spring.rest;
  add_coordinate_row(world.state(), joint, coordinate, &spring_law<S>, constants);
}

template <class S>
void add_friction(BasicWorld<S>& world, int joint, std::string_view coordinate,
                  const DryFriction& friction) {
  if (!(friction.max_force >= 0)) throw Error("the largest force of dry friction must be >= 0");
  const double constants[] = {0, friction.max_force};
  add_coordinate_row(world.state(), joint, coordinate, &motor_law<S>, constants);
}

#define CDOT_INSTANTIATE(S)                                                                 \
  template void add_limit(BasicWorld<S>&, int, std::string_view, const Limit&);             \
  template void add_motor(BasicWorld<S>&, int, std::string_view, const Motor&);             \
  template void add_spring(BasicWorld<S>&, int, std::string_view, const CoordinateSpring&); \
  template void add_friction(BasicWorld<S>&, int, std::string_view, const DryFriction&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
