// Joints that break, as numbers.
#pragma once

#include <cdot/world.hpp>

#include "derive/compile/scene/mechanism.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot::compile {

// The number of a joint of the World among those that may break; -1: it is none of these.
template <class S>
int number_among_breakable(BasicWorld<S>& world, int joint);

// After joints and effects.
template <class S>
void read_bonds(const Scene& scene, BasicWorld<S>& world, Mechanism& mechanism);

}  // namespace cdot::compile
