// A problem as MuJoCo's XML.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/peers/tree.hpp"

namespace cdot::peers {

// A motor whose speed counts in the sense of the tree, or a servo for the angle since the start.
struct Drive {
  double forth = 1;
  Motor motor;
  std::optional<Servo> servo{};
};

// Of a body; "world" for the world.
std::string name_of(int body);
// Adds what drives its joints, in the order of its actuators.
std::string model_text(const Problem& problem, const Tree& tree, bool free_first, std::vector<Drive>& drives);

}  // namespace cdot::peers
