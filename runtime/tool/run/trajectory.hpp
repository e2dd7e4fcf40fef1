// A scene and a way -> the trajectory at given times, its cost, and its distance from another.
#pragma once

#include <functional>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/ways.hpp"

namespace cdot {

using Stop = std::function<bool()>;  // called at every sample: true ends the run

struct Trajectory {
  std::vector<Frame> frames;                 // at the samples, until it stopped or was not finite
  double C = 0, Cdot = 0;                    // the largest of those checked [m, rad], [m/s, rad/s]
  double least_energy = 0, most_energy = 0;  // of those checked [J]
  double cpu = 0;                            // spent in step() [s]
  double looking = 0;                        // CPU time of these checks [s]
  StepCounts counts;                         // of a composed method, evaluations are its steps
  bool finite = true, stopped = false;
};

// f(space) for the scene's dimension and the way's precision.
template <class F>
auto in_space_of(const Scene& scene, const Way& way, F f) {
  if (way.extended) return in_space_of<long double>(scene, f);
  return way.single ? in_space_of<float>(scene, f) : in_space_of<double>(scene, f);
}

// A perturbed start: every number of every body changes by at most this, then the start is projected onto C = 0.
struct Perturbation {
  double position = 0, angle = 0, speed = 0, spin = 0;  // [m], [rad], [m/s], [rad/s]
  unsigned seed = 0;
};

// `times` ascend from above 0. `watched`: C, Cdot and energy are checked after every step(h), not only at the times.
Trajectory trajectory_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
                         const Stop& stop = {}, const Perturbation& perturbation = {}, bool watched = false);

// CPU time of step() over the whole run [s], without checks. Short runs are repeated until the clock can measure them.
double cpu_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
              const Stop& stop = {});

// The differences of one body, or the largest over all bodies at one time, [m] and [rad]. In space the angle is that of
// the relative rotation.
struct Apart {
  double position = 0, angle = 0;
  double larger() const { return position > angle ? position : angle; }
};
Apart apart(const BodyState& a, const BodyState& b, Dimension dimension);
Apart apart(const Frame& a, const Frame& b, Dimension dimension);

}  // namespace cdot
