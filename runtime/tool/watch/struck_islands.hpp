// Islands with an end that begins to press, for watches of blows.
#pragma once

#include <cstddef>
#include <vector>

#include <cdot/world.hpp>

namespace cdot {

class StruckIslands {
 public:
  // After every step.
  template <class S>
  void look(const WorldData<S>& world);
  // In the last step.
  bool operator[](int island) const { return struck_[static_cast<std::size_t>(island)]; }

 private:
  std::vector<std::vector<char>> pressed_;  // ends that pressed in the last step, by batch and home
  std::vector<char> struck_;
};

}  // namespace cdot
