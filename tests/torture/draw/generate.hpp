// A seed -> a random mechanism as a scene: trees, loops, redundant loops, all joints, any masses, any method.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::torture {

// Choices that are not random.
struct Wish {
  std::string joint = {};  // the mechanism contains this joint
  std::optional<Dimension> dimension = {};
  std::optional<Solver> solver = {};
  std::optional<Integrator> integrator = {};
  std::optional<Drift> drift = {};
  std::optional<bool> single = {};
  bool effects = false;  // of specs too
  bool islands = false;  // few joints, and many such effects between the islands
  bool own = false;      // effects whose specs are written at random
  bool late = false;     // ends that begin to hold at a time, where they may be passed
  bool in_time = false;  // numbers of joints and effects follow functions of time
  bool tables = false;   // forces that follow tables
  int steps = 200;
};

struct Mechanism {
  Scene scene;
  std::vector<std::string> refused;  // reasons for joints that the World refused during growth
  int left_out = 0;                  // joints removed because the projection failed with them
};

Mechanism generate(std::uint64_t seed, const Wish& wish = {});

}  // namespace cdot::torture
