// Changes the constants of an effect's law while the World runs; and the instances of a kind of effect.
#pragma once

#include <span>

#include <cdot/effects.hpp>

#include "runtime/state/add_rows.hpp"
#include "runtime/state/world_state.hpp"

namespace cdot {

// The constants of an effect that add_effect() made under this law. Throws Error if it is none of that name.
template <class S>
void set_constants(BasicWorld<S>& world, int joint, int effect, const Law<S>& law, const char* name,
                   std::span<const double> constants);

#define CDOT_INSTANTIATE_EFFECT(S, Effect)                                       \
  template int add_effect(BasicWorld<S>&, int, std::string_view, const Effect&); \
  template void set_effect(BasicWorld<S>&, int, int, const Effect&);

}  // namespace cdot
