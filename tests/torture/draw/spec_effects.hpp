// Effects of specs in a random mechanism: on bodies, and on the coordinates of its joints. The kinds, units and ranges
// of their parameters determine the numbers; no code depends on an effect's name.
#pragma once

#include "tests/torture/draw/draw.hpp"

namespace cdot::torture {

// `refused` receives the reasons why the World took one not.
template <class S>
void add_spec_effects(Random& random, const Scales& scales, Scene& scene, std::vector<std::string>& refused);

}  // namespace cdot::torture
