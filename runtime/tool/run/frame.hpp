// The state of a scene at one time, and between the ends of a step.
#pragma once

#include <span>
#include <vector>

#include <cdot/rotation.hpp>
#include <cdot/world.hpp>

#include "runtime/tool/watch/sensors.hpp"

namespace cdot {

struct BodyState {
  double x, y, angle, vx, vy, w;  // angle and w: only in the plane
  double z = 0, vz = 0;           // these and the rest: only in space
  double e0 = 1, e1 = 0, e2 = 0, e3 = 0, wx = 0, wy = 0, wz = 0;
};

// Of a body in space; the position is left out.
spatial::Pose<double> orientation_of(const BodyState& body);

// The numbers of a state in a file, by the names of their columns.
struct StateColumn {
  const char* name;
  double BodyState::*number;
};
std::span<const StateColumn> state_columns(Dimension dimension);

struct Frame {
  double time = 0;
  std::vector<BodyState> bodies;
  double energy = 0;              // [J]
  WorstError worst;               // the largest |C| of a joint [m], [rad]
  PassedEnd passed{};             // of an effect, the farthest
  std::vector<double> sensors{};  // of the scene, by number
};

template <class S>
std::vector<BodyState> states_of(const BasicWorld<S>& world, int bodies);
template <class S>
Frame frame_of(const BasicWorld<S>& world, double time, int bodies);
// The same where the energy is known.
template <class S>
Frame frame_of(const BasicWorld<S>& world, double time, int bodies, double energy);
bool finite(const Frame& frame);
// Reads the sensors of the scene into `frame`, the state of the World at the end of a step from `start`; at the start
// of a run they are equal.
template <class S>
void read_sensors(const Scene& scene, BasicWorld<S>& world, const Frame& start, Frame& frame);

// Between two steps: positions by the cubic through both ends' positions and velocities, the rest linear. The error is
// of fourth order in the step.
Frame between(const Frame& before, const Frame& after, double time);

// 0, dt, 2 dt, … up to `until`. Throws Error for more than 1e8 of them.
std::vector<double> every(double dt, double until);
// `count` multiples of until / count, from number `first` on.
std::vector<double> equal_times(double until, int count, int first = 1);

}  // namespace cdot
