// One run of a scene in one way: the trajectory at given times, what it cost, and how far it is from another.
#pragma once

#include <functional>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/ways.hpp"

namespace cdot {

using Stop = std::function<bool()>;  // asked at every sample: shall the run end here?

struct Trajectory {
  std::vector<Frame> frames;                 // at the sample times, until it was stopped or not finite any more
  double C = 0, Cdot = 0;                    // the largest at the samples, or after any step(h) [m, rad], [m/s, rad/s]
  double least_energy = 0, most_energy = 0;  // then [J]
  double cpu = 0;                            // spent in step() [s]
  double looking = 0;                        // and between steps, to find what is above [s]
  StepCounts counts;                         // of rk4 and dop853; of composed RATTLE its steps as evaluations
  bool finite = true, stopped = false;
};

// f(space) for the space and precision in which the way computes.
template <class F>
auto in_space_of(const Scene& scene, const Way& way, F f) {
  if (way.extended) return in_space_of<long double>(scene, f);
  return way.single ? in_space_of<float>(scene, f) : in_space_of<double>(scene, f);
}

// A start beside the scene's: every number of every body off by up to as much, then back onto the joints.
struct Nudge {
  double position = 0, angle = 0, speed = 0, spin = 0;  // [m], [rad], [m/s], [rad/s]
  unsigned seed = 0;
};

// `times` ascend and are greater than 0. `watched`: joints and energy are looked at after every step(h), not only at
// the times.
Trajectory trajectory_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
                         const Stop& stop = {}, const Nudge& nudge = {}, bool watched = false);

// CPU time that step() takes for the whole run [s], nothing looked at on the way. Short runs are repeated until
// their time can be measured.
double cpu_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
              const Stop& stop = {});

// The largest differences over the bodies at one time, [m] and [rad]; in space the angle of the turn between.
struct Apart {
  double position = 0, angle = 0;
  double larger() const { return position > angle ? position : angle; }
};
Apart apart(const Frame& a, const Frame& b, Dimension dimension);

}  // namespace cdot
