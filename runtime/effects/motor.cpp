// Motor and dry friction: a row J v = speed with bounds on its force.
#include <cmath>

#include "runtime/effects/effect.hpp"

namespace cdot {
namespace {

// Constants: speed, largest force. Dry friction is a motor of speed 0.

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

template <class S>
constexpr Law<S> motor_law{2, false, fill_motor<S>, nullptr, nullptr, nullptr, guard_motor<S>};

}  // namespace

template <class S>
static NamedLaw<S> law_of(const Motor&) {
  return {motor_law<S>, "motor"};
}
template <class S>
static NamedLaw<S> law_of(const DryFriction&) {
  return {motor_law<S>, "dry friction"};
}

static std::array<double, 2> constants_of(const Motor& motor) {
  if (!std::isfinite(motor.speed)) throw Error("a motor's speed must be finite");
  if (!(motor.max_force >= 0)) throw Error("a motor's largest force must be >= 0");
  return {motor.speed, motor.max_force};
}

static std::array<double, 2> constants_of(const DryFriction& friction) {
  if (!(friction.max_force >= 0)) throw Error("the largest force of dry friction must be >= 0");
  return {0, friction.max_force};
}

#define CDOT_INSTANTIATE(S) CDOT_INSTANTIATE_EFFECT(S, Motor) CDOT_INSTANTIATE_EFFECT(S, DryFriction)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

#ifndef CDOT_EXTENDED  // the keys of a scene are the same in every precision
namespace {

std::optional<EffectKind::Wrong> take_motor(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.motor = Motor{n[0].value.value_or(0), n[1].value.value_or(unlimited)};
  return {};
}

std::optional<EffectKind::Wrong> take_friction(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.friction = DryFriction{*n[0].value};
  return {};
}

}  // namespace

const EffectKind motor_kind{
    "motor",
    "{ speed = 2, max = 10 }",
    "`{ speed = …, max = … }`: `max` bounds its force or torque",
    EffectKind::table,
    {{"speed", EffectNumber::as_coordinate, "speed = 2.0"}, {"max", EffectNumber::not_negative}},
    take_motor};
const EffectKind friction_kind{"friction",
                               "friction = 3",
                               "largest force or torque of dry friction",
                               EffectKind::number,
                               {{"friction", EffectNumber::not_negative}},
                               take_friction};
#endif

}  // namespace cdot
