// add_effect() and set_effect() of every effect with a struct of its own, from two functions for it:
//
//   template <class S> static NamedLaw<S> law_of(const Effect&);
//   static Parameters<double> constants_of(const Effect&);  // of the spec of that law; throws Error if they are wrong
//
#pragma once

#include <span>

#include <cdot/effects.hpp>

#include "runtime/balance/balance.hpp"
#include "runtime/state/add_rows.hpp"
#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
struct NamedLaw {
  const Law<S>& law;
  const char* name;  // in messages, and of its work
};

// The numbers of a Parameters<double>, in the order of the law's constants.
template <class Parameters>
std::span<const double> numbers_of(const Parameters& parameters) {
  return {reinterpret_cast<const double*>(&parameters), sizeof parameters / sizeof(double)};
}

// The rows of the effect; null if all bodies of the joint are immovable. Throws Error if the joint has no effect of
// that number, or if the effect has another law.
template <class S>
Batch<S>* batch_of_effect(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named);

template <class S>
void set_constants(BasicWorld<S>& world, int joint, int effect, const NamedLaw<S>& named,
                   std::span<const double> constants);

// From the next step on.
template <class S>
void add_bond(BasicWorld<S>& world, const Bond& bond);

// The effect, completed from the present pose of the joint.
template <class S, class Effect>
const Effect& at_pose(BasicWorld<S>&, int, std::string_view, const Effect& effect) {
  return effect;
}

template <class S, class Effect>
int add_effect(BasicWorld<S>& world, int joint, std::string_view coordinate, const Effect& effect) {
  const auto constants = constants_of(at_pose(world, joint, coordinate, effect));
  const NamedLaw<S> named = law_of<S>(effect);
  note_change(world.data());
  return add_coordinate_row(world.data(), joint, coordinate, &named.law, numbers_of(constants), named.name);
}

template <class S, class Effect>
void set_effect(BasicWorld<S>& world, int joint, int number, const Effect& effect) {
  set_constants(world, joint, number, law_of<S>(effect), numbers_of(constants_of(effect)));
}

#define CDOT_INSTANTIATE_EFFECT(S, Effect)                                       \
  template int add_effect(BasicWorld<S>&, int, std::string_view, const Effect&); \
  template void set_effect(BasicWorld<S>&, int, int, const Effect&);

}  // namespace cdot
