// Random mechanisms as scenes: trees, loops, redundant loops, all joints, any masses, any method; from a seed alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

// What is not left to chance.
struct Wish {
  std::string joint = {};  // this one is among them
  std::optional<Dimension> dimension = {};
  std::optional<Solver> solver = {};
  std::optional<Integrator> integrator = {};
  std::optional<bool> single = {};
  int steps = 200;
};

struct Mechanism {
  Scene scene;
  std::vector<std::string> refused;  // by the World while it grew: joints that were left out, and why
  int left_out = 0;                  // joints taken away because the poses could not be brought onto all of them
};

Mechanism generate(std::uint64_t seed, const Wish& wish = {});

}  // namespace cdot::torture
