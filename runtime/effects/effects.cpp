// Effects on coordinates, one law each. Only a program that calls the functions at the end links
// this file.
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <span>

#include <cdot/effects.hpp>

#include "runtime/rows/laws.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/world_state.hpp"
#include "runtime/world/islands.hpp"

namespace cdot {
namespace {

// --- limit: lower <= C <= upper. Constants: lower, upper. One row serves both sides, the nearer
// one at a time.

template <class T>
bool nearer_to_lower(T C, const T* limits) {
  return C - limits[0] < limits[1] - C;
}

template <class S>
void fill_limit(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings& settings) {
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
  *error = nearer_to_lower(C, limits) ? std::fmin(C - limits[0], T(0)) : std::fmax(C - limits[1], T(0));
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
void fill_lock(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings& settings) {
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
void force_of_spring(const Batch<S>& batch, int slot, const typename S::Scalar* rate, typename S::Scalar* force) {
  const auto* constants = batch.constants.data() + 4 * slot;
  *force = spring_force(batch.C[slot] - constants[3], *rate, batch.factor[slot], constants);
}

template <class S>
constexpr Law<S> limit_law{2, false, fill_limit<S>, error_limit<S>, nullptr, nullptr, guard_limit<S>};
template <class S>
constexpr Law<S> lock_law{1, false, fill_lock<S>, error_lock<S>, nullptr, nullptr, guard_lock<S>};
template <class S>
constexpr Law<S> motor_law{2, false, fill_motor<S>, nullptr, nullptr, nullptr, guard_motor<S>};
template <class S>
constexpr Law<S> spring_law{4, false, fill_spring<S>, nullptr, energy_spring<S>, force_of_spring<S>, nullptr};

// The numbers of an effect, as its law keeps them; throw Error where they make no sense.

std::array<double, 2> constants_of(const Limit& limit) {
  const double lower = limit.lower.value_or(-unlimited), upper = limit.upper.value_or(unlimited);
  if (!(lower <= upper))
    throw Error(fmt::format("a limit's lower end {} must not lie above its upper end {}", lower, upper));
  if (!limit.lower && !limit.upper) throw Error("a limit needs a lower or an upper end");
  return {lower, upper};
}

std::array<double, 2> constants_of(const Motor& motor) {
  if (!std::isfinite(motor.speed)) throw Error("a motor's speed must be finite");
  if (!(motor.max_force >= 0)) throw Error("a motor's largest force must be >= 0");
  return {motor.speed, motor.max_force};
}

std::array<double, 4> constants_of(const CoordinateSpring& spring) {
  std::array<double, 4> constants;
  spring_constants(spring.softness, constants.data());
  if (!std::isfinite(spring.rest)) throw Error("a spring's rest position must be finite");
  constants[3] = spring.rest;
  return constants;
}

std::array<double, 2> constants_of(const DryFriction& friction) {
  if (!(friction.max_force >= 0)) throw Error("the largest force of dry friction must be >= 0");
  return {0, friction.max_force};
}

// The constants of an effect that add_...() made under this law.
template <class S>
void set_constants(BasicWorld<S>& world, int joint, int effect, const Law<S>& law, const char* name,
                   std::span<const double> constants) {
  WorldState<S>& state = world.state();
  check_joint(state, joint);
  const JointRecord& record = state.joints[joint];
  if (record.places.empty()) return;
  const auto place = static_cast<size_t>(effect);
  if (effect < 1 || place >= record.places.size())
    throw Error(fmt::format("joint number {} has no effect number {}", joint, effect));
  Batch<S>& batch = *state.batches[record.places[place].batch];
  if (batch.law != &law) throw Error(fmt::format("effect number {} of joint number {} is no {}", effect, joint, name));
  for (size_t k = 0; k < constants.size(); ++k)
    batch.constants[record.places[place].slot * constants.size() + k] = typename S::Scalar(constants[k]);
  const int body = movable_body(state, record);
  if (law.error)  // of where the bodies shall be
    wake(state, body);
  else wake_pushed(state, body);
}

}  // namespace

template <class S>
int add_limit(BasicWorld<S>& world, int joint, std::string_view coordinate, const Limit& limit) {
  const auto constants = constants_of(limit);
  if (constants[0] == constants[1])
    return add_coordinate_row(world.state(), joint, coordinate, &lock_law<S>, std::span(constants).first(1));
  return add_coordinate_row(world.state(), joint, coordinate, &limit_law<S>, constants);
}

template <class S>
int add_motor(BasicWorld<S>& world, int joint, std::string_view coordinate, const Motor& motor) {
  return add_coordinate_row(world.state(), joint, coordinate, &motor_law<S>, constants_of(motor));
}

template <class S>
int add_spring(BasicWorld<S>& world, int joint, std::string_view coordinate, const CoordinateSpring& spring) {
  return add_coordinate_row(world.state(), joint, coordinate, &spring_law<S>, constants_of(spring));
}

template <class S>
int add_friction(BasicWorld<S>& world, int joint, std::string_view coordinate, const DryFriction& friction) {
  return add_coordinate_row(world.state(), joint, coordinate, &motor_law<S>, constants_of(friction));
}

template <class S>
void set_limit(BasicWorld<S>& world, int joint, int effect, const Limit& limit) {
  const auto constants = constants_of(limit);
  if (constants[0] == constants[1])
    set_constants(world, joint, effect, lock_law<S>, "lock (a limit that was added with equal ends)",
                  std::span(constants).first(1));
  else set_constants(world, joint, effect, limit_law<S>, "limit with two ends", constants);
}

template <class S>
void set_motor(BasicWorld<S>& world, int joint, int effect, const Motor& motor) {
  set_constants(world, joint, effect, motor_law<S>, "motor", constants_of(motor));
}

template <class S>
void set_spring(BasicWorld<S>& world, int joint, int effect, const CoordinateSpring& spring) {
  set_constants(world, joint, effect, spring_law<S>, "spring", constants_of(spring));
}

template <class S>
void set_friction(BasicWorld<S>& world, int joint, int effect, const DryFriction& friction) {
  set_constants(world, joint, effect, motor_law<S>, "dry friction", constants_of(friction));
}

#define CDOT_INSTANTIATE(S)                                                                \
  template int add_limit(BasicWorld<S>&, int, std::string_view, const Limit&);             \
  template int add_motor(BasicWorld<S>&, int, std::string_view, const Motor&);             \
  template int add_spring(BasicWorld<S>&, int, std::string_view, const CoordinateSpring&); \
  template int add_friction(BasicWorld<S>&, int, std::string_view, const DryFriction&);    \
  template void set_limit(BasicWorld<S>&, int, int, const Limit&);                         \
  template void set_motor(BasicWorld<S>&, int, int, const Motor&);                         \
  template void set_spring(BasicWorld<S>&, int, int, const CoordinateSpring&);             \
  template void set_friction(BasicWorld<S>&, int, int, const DryFriction&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
