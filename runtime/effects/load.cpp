// A constant force or torque along a coordinate: J^T F. Its energy is -F C, so that nothing is lost by it.
#include <array>
#include <cmath>

#include <cdot/effects.hpp>

#include "runtime/effects/set_constants.hpp"

namespace cdot {
namespace {

// Constants: F. Bounds that are one leave the row no other impulse than h F.
template <class S>
void fill_load(Batch<S>& batch, int begin, int end, typename S::Scalar h, const Settings&) {
  for (int i = begin; i < end; ++i) batch.lower[i] = batch.upper[i] = h * batch.constants[i];
}

template <class S>
double energy_load(const Batch<S>& batch, int slot) {
  return -double(batch.constants[slot]) * double(batch.C[slot]);
}

template <class S>
void force_of_load(const Batch<S>& batch, int slot, const typename S::Scalar*, typename S::Scalar* force) {
  *force = batch.constants[slot];
}

template <class S>
constexpr Law<S> load_law{1, false, fill_load<S>, nullptr, energy_load<S>, force_of_load<S>, nullptr};

std::array<double, 1> constants_of(const Load& load) {
  if (!std::isfinite(load.force)) throw Error("a load must be finite");
  return {load.force};
}

}  // namespace

template <class S>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const Load& load) {
  return add_coordinate_row(world.state(), joint, coordinate, &load_law<S>, constants_of(load));
}

template <class S>
void set_effect(BasicWorld<S>& world, int joint, int effect, const Load& load) {
  set_constants(world, joint, effect, load_law<S>, "load", constants_of(load));
}

#define CDOT_INSTANTIATE(S) CDOT_INSTANTIATE_EFFECT(S, Load)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

#ifndef CDOT_EXTENDED  // how a scene writes them is one for all precisions
namespace {

std::optional<EffectKind::Wrong> take_load(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.load = Load{*n[0].value};
  return {};
}

}  // namespace

const EffectKind load_kind{"load",
                           "load = 5",
                           "constant force or torque, in the direction in which the coordinate grows",
                           EffectKind::number,
                           {{"load", EffectNumber::any}},
                           take_load};
#endif

}  // namespace cdot
