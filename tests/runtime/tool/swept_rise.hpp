// The energy that appears in a scene without a source in steps of Euler's by sweeps.
#pragma once

#include <cmath>

#include "runtime/tool/scene/scene.hpp"

namespace cdot::test {

// The shortest and the longest step of a run, in units of SweptWay::unit.
struct Jitter {
  double shortest, longest;
  // The length of step k: between both, in no order.
  double length(int k) const {
    return std::sqrt(shortest * longest) * std::pow(longest / shortest, 0.5 * std::sin(12.9898 * k * k));
  }
};

struct SweptWay {
  int sweeps, substeps;
  Jitter jitter;
  Drift drift = Drift::soft;
  Integrator integrator = Integrator::euler;
  double unit = 1. / 60, duration = 3;  // [s]
};

struct SweptRise {
  // On its joints and within its ends: closing the gaps of a start may lift bodies, and takes energy.
  bool starts = false;
  bool fails = false;          // a step, and says so
  double risen = 0, time = 0;  // BalanceWatch::risen, as a share, and when [s]
  // Of risen. Symplectic Euler itself is off by h/2 F v at both ends, of all forces on bodies, by the turning of
  // tensors, and by the round-off of poses.
  double bound = 0;
  bool holds() const { return risen < bound; }
};

// The scene by these sweeps; its step and duration stay.
Scene with_sweeps(Scene scene, const SweptWay& way);

SweptRise swept_rise(const Scene& scene, const SweptWay& way);

}  // namespace cdot::test
