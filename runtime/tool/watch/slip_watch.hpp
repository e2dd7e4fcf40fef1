// Blows that turn round the slip of a row whose friction grows with a load, where a method takes steps of equal length.
// Euler's steps and those of the midpoint rule take a blow in two parts, and friction acts in the first of them against
// the slip before. How large that part is depends on where in the step the end was met.
#pragma once

#include <array>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/watch/struck_islands.hpp"

namespace cdot {

struct TurnedSlip {
  int joint = -1;   // whose friction it is; -1: none
  double time = 0;  // [s], of the step's end
};

class SlipWatch {
 public:
  // After every step. Notes the first one.
  template <class S>
  void look(BasicWorld<S>& world, double time);
  const TurnedSlip& found() const { return found_; }

 private:
  using Impulses = std::array<double, 4>;  // of a row in the last four steps
  static bool turns_round(const Impulses& impulses, std::size_t newest);

  StruckIslands struck_;
  std::vector<int> since_;         // steps since the last blow, by island
  std::vector<Impulses> of_rows_;  // by island and loaded row
  std::size_t newest_ = 0;
  TurnedSlip found_;
};

}  // namespace cdot
