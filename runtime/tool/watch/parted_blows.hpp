// Blows that steps of equal length take in two parts, of which the first depends on where in the step the end was met.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <cdot/world.hpp>

#include "runtime/tool/watch/struck_islands.hpp"

namespace cdot {

template <class S>
struct Island;

struct TurnedSlip {
  int joint = -1;   // whose friction it is; -1: none
  double time = 0;  // [s], of the step's end
};

// Blows that turn round the slip of a row whose friction grows with a load. By Euler's steps and those of the midpoint
// rule friction acts in the first part against the slip before.
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

struct YieldingMotor {
  int joint = -1;    // -1: none
  double speed = 0;  // [rad/s], [m/s], backwards
  double time = 0;   // [s], of the step's end
};

// Motors of unlimited force that go backwards. Where an end stops such a motor, its row is soft, by a share of what it
// drives (System::usual_softness): else its impulses had no size. So the first part of a blow at another end may push
// it back, which no blow can.
template <class S>
class YieldWatch {
 public:
  // After every step. Notes the first one.
  void look(BasicWorld<S>& world, double time);
  const YieldingMotor& found() const { return found_; }

 private:
  void look_at(const WorldData<S>& world, const Island<S>& island, double time);

  std::vector<typename S::Scalar> rates_;  // of a batch
  YieldingMotor found_;
};

}  // namespace cdot
