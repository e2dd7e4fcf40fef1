// Motor, limit, spring, friction and load of <cdot/effects.hpp> as the laws of specs/coordinate.
#include <cmath>
#include <fmt/format.h>

#include <cdot/coordinate/registry.hpp>
#include <cdot/detail/bounded_law.hpp>
#include <cdot/detail/linear_law.hpp>

#include "runtime/effects/effect.hpp"
#include "runtime/rows/laws.hpp"

namespace cdot {
namespace {

template <class Effect>
using Numbers = typename Effect::template Parameters<double>;

template <class S, class Effect, class Row>
NamedLaw<S> named_bounds(const char* name) {
  return {bounded_law<S, Effect, Row, ParametersAt::row>, name};
}

}  // namespace

template <class S>
static NamedLaw<S> law_of(const Motor&) {
  return named_bounds<S, coordinate::motor, coordinate::motor::drive>("motor");
}
template <class S>
static NamedLaw<S> law_of(const DryFriction&) {
  return named_bounds<S, coordinate::friction, coordinate::friction::grip>("friction");
}
template <class S>
static NamedLaw<S> law_of(const Limit&) {
  return named_bounds<S, coordinate::limit, coordinate::limit::ends>("limit");
}
template <class S>
static NamedLaw<S> law_of(const CoordinateSpring&) {
  return {linear_law<S, coordinate::spring>, "spring"};
}
template <class S>
static NamedLaw<S> law_of(const Load&) {
  return {linear_law<S, coordinate::load>, "load"};
}

static Numbers<coordinate::motor> constants_of(const Motor& motor) {
  if (!std::isfinite(motor.speed)) throw Error("a motor's speed must be finite");
  if (!(motor.max_force >= 0)) throw Error("a motor's largest force must be >= 0");
  return {.speed = motor.speed, .max = motor.max_force};
}

static Numbers<coordinate::friction> constants_of(const DryFriction& friction) {
  if (!(friction.max_force >= 0)) throw Error("the largest force of dry friction must be >= 0");
  return {.max = friction.max_force};
}

static Numbers<coordinate::limit> constants_of(const Limit& limit) {
  const double lower = limit.lower.value_or(-unlimited), upper = limit.upper.value_or(unlimited);
  if (!(lower <= upper))
    throw Error(fmt::format("a limit's lower end {} must not lie above its upper end {}", lower, upper));
  if (!limit.lower && !limit.upper) throw Error("a limit needs a lower or an upper end");
  return {.lower = lower, .upper = upper};
}

static Numbers<coordinate::spring> constants_of(const CoordinateSpring& spring) {
  const Softness& softness = spring.softness;
  double checked[spring_constants_count];
  spring_constants(softness, checked);
  if (!spring.rest || !std::isfinite(*spring.rest)) throw Error("a spring's rest position must be finite");
  const bool by_frequency = softness.by_frequency;
  return {.stiffness = by_frequency ? 0 : softness.stiffness,
          .damping = by_frequency ? 0 : softness.damping,
          .frequency = by_frequency ? softness.frequency : 0,
          .damping_ratio = by_frequency ? softness.damping_ratio : 0,
          .rest = *spring.rest};
}

static Numbers<coordinate::load> constants_of(const Load& load) {
  if (!std::isfinite(load.force)) throw Error("a load must be finite");
  return {.push = load.force};
}

template <class S>
static CoordinateSpring at_pose(BasicWorld<S>& world, int joint, std::string_view coordinate,
                                const CoordinateSpring& spring) {
  check_joint(world.data(), joint);
  return {spring.softness, spring.rest ? *spring.rest : world.coordinate(joint, coordinate)};
}

#define CDOT_INSTANTIATE(S)                    \
  CDOT_INSTANTIATE_EFFECT(S, Motor)            \
  CDOT_INSTANTIATE_EFFECT(S, Limit)            \
  CDOT_INSTANTIATE_EFFECT(S, CoordinateSpring) \
  CDOT_INSTANTIATE_EFFECT(S, DryFriction)      \
  CDOT_INSTANTIATE_EFFECT(S, Load)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
