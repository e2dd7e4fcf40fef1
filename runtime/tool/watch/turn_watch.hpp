// Motions that turn within one step of equal length where K nearly loses rank. Two branches of the motion cross in such
// a pose, and numbers that are rounded leave a gap between them. An exact motion turns into the other branch, within
// the root of that gap; a longer step goes straight on. Where steps fall decides, and no estimate of their error tells.
#pragma once

#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct SharpTurn {
  WeakestRow row;    // by which K nearly loses rank
  int body = -1;     // that turns most; -1: none
  double share = 0;  // of its change, of the largest velocity of its mechanism
  double time = 0;   // [s], of the step's end
};

template <class S>
class TurnWatch {
 public:
  // Before the first step, and after every step of h, which ends at `time`.
  void look(BasicWorld<S>& world, double h, double time);
  // The sharpest so far.
  const SharpTurn& found() const { return found_; }

 private:
  // Of an island.
  struct Course {
    double most = 0;      // the largest velocity so far
    double usual = -1;    // the change per time in the last step away from a loss of rank; below 0: none yet
    int redundant = 0;    // rows, after that step
    bool near = false;    // the last step ended near one
    WeakestRow row;       // by which it did
    long long steps = 0;  // since the last event
  };

  std::vector<typename S::Velocity> before_;  // by body
  std::vector<Course> courses_;               // by island
  long long events_ = 0;
  SharpTurn found_;
};

}  // namespace cdot
