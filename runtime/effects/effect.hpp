// add_effect() and set_effect() of every effect, from two functions in the file of its kind:
//
//   template <class S> static NamedLaw<S> law_of(const Effect&);
//   static std::array<double, n> constants_of(const Effect&);  // of that law, or more; throws Error if they are wrong
//
#pragma once

#include <array>
#include <span>

#include <cdot/effects.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct NamedLaw {
  const Law<S>& law;
  const char* name;  // in messages
};

// The rows of the effect; null if all bodies of the joint are immovable. Throws Error if the joint has no effect of
// that number, or if the effect has another law.
template <class S>
Batch<S>* batch_of_effect(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named);

template <class S>
void set_constants(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named,
                   std::span<const double> constants);

// The effect, completed from the present pose of the joint.
template <class S, class Effect>
const Effect& at_pose(BasicWorld<S>&, int, std::string_view, const Effect& effect) {
  return effect;
}

template <class S, class Effect>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const Effect& effect) {
  const auto constants = constants_of(at_pose(world, joint, coordinate, effect));
  const Law<S>& law = law_of<S>(effect).law;
  note_change(world.data());
  return add_coordinate_row(world.data(), joint, coordinate, &law,
                            std::span(constants).first(static_cast<size_t>(law.constants)));
}

template <class S, class Effect>
void set_effect(BasicWorld<S>& world, int joint, int number, const Effect& effect) {
  set_constants(world, joint, number, law_of<S>(effect), constants_of(effect));
}

#define CDOT_INSTANTIATE_EFFECT(S, Effect)                                       \
  template int add_effect(BasicWorld<S>&, int, std::string_view, const Effect&); \
  template void set_effect(BasicWorld<S>&, int, int, const Effect&);

}  // namespace cdot
