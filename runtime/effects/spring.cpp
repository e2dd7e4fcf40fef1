// A spring with damping on a coordinate; a damper is a spring of stiffness 0.
#include <cmath>

#include "runtime/effects/effect.hpp"
#include "runtime/rows/laws.hpp"

namespace cdot {
namespace {

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
void numbers_of_spring(const Batch<S>& batch, int slot, SpringNumbers<typename S::Scalar>* numbers) {
  *numbers = spring_numbers(batch.factor[slot], batch.constants.data() + 4 * slot);
}

template <class S>
constexpr Law<S> spring_law{
    4, false, fill_spring<S>, nullptr, energy_spring<S>, force_of_spring<S>, nullptr, numbers_of_spring<S>};

}  // namespace

template <class S>
static NamedLaw<S> law_of(const CoordinateSpring&) {
  return {spring_law<S>, "spring"};
}

static std::array<double, 4> constants_of(const CoordinateSpring& spring) {
  std::array<double, 4> constants;
  spring_constants(spring.softness, constants.data());
  if (!spring.rest || !std::isfinite(*spring.rest)) throw Error("a spring's rest position must be finite");
  constants[3] = *spring.rest;
  return constants;
}

template <class S>
static CoordinateSpring at_pose(BasicWorld<S>& world, int joint, std::string_view coordinate,
                                const CoordinateSpring& spring) {
  check_joint(world.data(), joint);
  return {spring.softness, spring.rest ? *spring.rest : world.coordinate(joint, coordinate)};
}

#define CDOT_INSTANTIATE(S) CDOT_INSTANTIATE_EFFECT(S, CoordinateSpring)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

#ifndef CDOT_EXTENDED  // the keys of a scene are the same in every precision
namespace {

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

}  // namespace

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
#endif

}  // namespace cdot
