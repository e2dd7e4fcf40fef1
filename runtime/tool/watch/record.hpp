// The usual sensors of a scene, without an expression for each.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// A group of quantities, for the help of a command line.
struct Recordable {
  const char *name, *meaning;
};
std::span<const Recordable> recordables();

// Adds sensors for these groups, or for "all", after those of the scene. Their names are the words of an expression:
// "pin.angle", "force(pin).x".
void record(Scene& scene, const std::vector<std::string>& groups);

}  // namespace cdot
