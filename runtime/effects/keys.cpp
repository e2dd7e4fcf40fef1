// The keys of effects on coordinates that a scene writes in a form of their own: angle.motor = { speed = 2, max = 10 }.
#include <fmt/format.h>

#include <cdot/effects.hpp>

namespace cdot {
namespace {

std::optional<EffectKind::Wrong> take_limit(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  if (!n[0].written && !n[1].written) return EffectKind::Wrong{"a limit without `lower` or `upper`", ""};
  const Limit limit{n[0].value, n[1].value};
  if (limit.lower || limit.upper) effects.limit = limit;
  if (!limit.lower || !limit.upper || *limit.lower <= *limit.upper) return {};
  return EffectKind::Wrong{
      fmt::format("the lower limit {:.6g} is above the upper limit {:.6g}", *limit.lower, *limit.upper), ""};
}

std::optional<EffectKind::Wrong> take_motor(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.motor = Motor{n[0].value.value_or(0), n[1].value.value_or(unlimited)};
  return {};
}

std::optional<EffectKind::Wrong> take_friction(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.friction = DryFriction{*n[0].value};
  return {};
}

std::optional<EffectKind::Wrong> take_spring(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  const bool frequency = n[0].written, stiffness = n[2].written;
  const bool mixed = frequency ? stiffness || n[3].written : n[1].written;
  if (frequency == stiffness || mixed)
    return EffectKind::Wrong{"{} needs either a frequency or a stiffness",
                             "{ frequency = 2, damping_ratio = 0.5 } or { stiffness = 100, damping = 1 }"};
  const auto number = [&](std::size_t k) { return n[k].value.value_or(0); };
  effects.springs.push_back(
      {{frequency, number(0), number(1), number(2), number(3)}, n.size() > 4 ? n[4].value : std::nullopt});
  return {};
}

std::optional<EffectKind::Wrong> take_damper(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.springs.push_back({{.by_frequency = false, .damping = *n[0].value}, 0});
  return {};
}

std::optional<EffectKind::Wrong> take_load(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.load = Load{*n[0].value};
  return {};
}

}  // namespace

const EffectKind limit_kind{"limit",
                            "[lower, upper], { lower = 0 } or { upper = 1 }",
                            "`[lower, upper]`, `{ lower = … }` or `{ upper = … }`; `[x, x]` locks the coordinate at x",
                            EffectKind::pair,
                            {{"lower", EffectNumber::as_coordinate}, {"upper", EffectNumber::as_coordinate}},
                            take_limit};
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
const EffectKind spring_kind{"spring",
                             "{ frequency = 2, damping_ratio = 0.5 }",
                             "`{ frequency, damping_ratio, rest }` or `{ stiffness, damping, rest }`; `rest` is by "
                             "default the value at the start",
                             EffectKind::table,
                             {{"frequency", EffectNumber::positive},
                              {"damping_ratio", EffectNumber::not_negative},
                              {"stiffness", EffectNumber::not_negative},
                              {"damping", EffectNumber::not_negative},
                              {"rest", EffectNumber::as_coordinate}},
                             take_spring};
const EffectKind damper_kind{"damper",
                             "damper = 0.5",
                             "force or torque per speed",
                             EffectKind::number,
                             {{"damper", EffectNumber::not_negative}},
                             take_damper};
const EffectKind load_kind{"load",
                           "load = 5",
                           "constant force or torque in the direction of the growing coordinate",
                           EffectKind::number,
                           {{"load", EffectNumber::any}},
                           take_load};

}  // namespace cdot
