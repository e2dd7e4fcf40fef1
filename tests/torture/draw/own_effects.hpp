// Effects that no catalogue has: their specs are written at random, of all kinds of statements, and derived at once.
#pragma once

#include <string>

#include "tests/torture/draw/spec_effects.hpp"

namespace cdot::torture {

// So many specs there are of each kind, by number.
constexpr int own_specs = 400;

// Three of them: on the bodies of that space, on lengths and on angles. Pointers to types before are no longer valid.
EffectTypes own_effects(Random& random, Dimension dimension);

// So many further specs there are of each kind, of ends that begin to hold at a time, wherever the bodies are then.
constexpr int late_specs = 5;
EffectTypes late_ends(Random& random, Dimension dimension);
bool has_late_ends(const Scene& scene);

// The files of a scene's types: name and text of each.
std::vector<std::pair<std::string, std::string>> own_specs_of(const Scene& scene);

}  // namespace cdot::torture
