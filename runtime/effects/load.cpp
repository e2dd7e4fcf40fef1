// A constant force or torque along a coordinate: J^T F. It is conservative, with energy -F C.
#include <cmath>

#include "runtime/effects/effect.hpp"

namespace cdot {
namespace {

// Constants: F. Equal bounds fix the impulse of the row at h F.
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

}  // namespace

template <class S>
static NamedLaw<S> law_of(const Load&) {
  return {load_law<S>, "load"};
}

static std::array<double, 1> constants_of(const Load& load) {
  if (!std::isfinite(load.force)) throw Error("a load must be finite");
  return {load.force};
}

#define CDOT_INSTANTIATE(S) CDOT_INSTANTIATE_EFFECT(S, Load)
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

#ifndef CDOT_EXTENDED  // the keys of a scene are the same in every precision
namespace {

std::optional<EffectKind::Wrong> take_load(std::span<const EffectKind::Given> n, CoordinateEffects& effects) {
  effects.load = Load{*n[0].value};
  return {};
}

}  // namespace

const EffectKind load_kind{"load",
                           "load = 5",
                           "constant force or torque in the direction of the growing coordinate",
                           EffectKind::number,
                           {{"load", EffectNumber::any}},
                           take_load};
#endif

}  // namespace cdot
