// A World -> frames, and frames between two steps.
#include "runtime/tool/run/frame.hpp"

#include <cmath>
#include <fmt/format.h>

namespace cdot {
namespace {

// The cubic with values p, q and slopes u, v at the ends of a step h, at its share s.
double cubic(double p, double u, double q, double v, double h, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * p + (s3 - 2 * s2 + s) * h * u + (3 * s2 - 2 * s3) * q + (s3 - s2) * h * v;
}

double linear(double p, double q, double s) { return (1 - s) * p + s * q; }

template <class T>
BodyState state_of(const planar::Place& q, const planar::Velocity<T>& v) {
  return {q.x, q.y, q.angle, double(v.x), double(v.y), double(v.w)};
}

template <class T>
BodyState state_of(const spatial::Place& q, const spatial::Velocity<T>& v) {
  return {q.x,  q.y,  0,    double(v.x),  double(v.y),  0,           q.z, double(v.z), q.e0,
          q.e1, q.e2, q.e3, double(v.wx), double(v.wy), double(v.wz)};
}

// The orientation at the share s of a step. The rotation vector r from its start follows the cubic whose slopes are the
// angular velocities; at the end, to fourth order, dr/dt = w - r x w / 2 + r x (r x w) / 12.
void turn(const BodyState& a, const BodyState& b, double h, double s, BodyState& to) {
  using Vector = spatial::Vector<double>;
  const auto from = orientation_of(a);
  const Vector r = spatial::turn_between(from, orientation_of(b)), w = {b.wx, b.wy, b.wz};
  const Vector across = spatial::cross(r, w);
  const Vector end = w - 0.5 * across + (1.0 / 12) * spatial::cross(r, across);
  const auto q = spatial::turned_by(from, Vector{cubic(0, a.wx, r.x, end.x, h, s), cubic(0, a.wy, r.y, end.y, h, s),
                                                 cubic(0, a.wz, r.z, end.z, h, s)});
  to.e0 = q.e0, to.e1 = q.e1, to.e2 = q.e2, to.e3 = q.e3;
  to.wx = linear(a.wx, b.wx, s), to.wy = linear(a.wy, b.wy, s), to.wz = linear(a.wz, b.wz, s);
}

// The mean ones of the time between; 0 if there is none.
Accelerations accelerations_between(const Frame& start, const Frame& end, Dimension dimension) {
  Accelerations all(end.bodies.size());
  const double h = end.time - start.time;
  for (std::size_t k = 0; k < all.size() && h > 0; ++k) {
    const BodyState &a = start.bodies[k], &b = end.bodies[k];
    const bool spatial = dimension == Dimension::spatial;
    all[k] = {(b.vx - a.vx) / h, (b.vy - a.vy) / h, (b.vz - a.vz) / h, (spatial ? b.wx - a.wx : b.w - a.w) / h,
              (b.wy - a.wy) / h, (b.wz - a.wz) / h};
  }
  return all;
}

}  // namespace

spatial::Pose<double> orientation_of(const BodyState& b) {
  return spatial::oriented(0.0, 0.0, 0.0, b.e0, b.e1, b.e2, b.e3);
}

std::span<const StateColumn> state_columns(Dimension dimension) {
  using B = BodyState;
  static constexpr StateColumn planar[] = {{"x", &B::x},   {"y", &B::y},   {"angle", &B::angle},
                                           {"vx", &B::vx}, {"vy", &B::vy}, {"omega", &B::w}};
  static constexpr StateColumn in_space[] = {
      {"x", &B::x},   {"y", &B::y},   {"z", &B::z},   {"e0", &B::e0}, {"e1", &B::e1}, {"e2", &B::e2}, {"e3", &B::e3},
      {"vx", &B::vx}, {"vy", &B::vy}, {"vz", &B::vz}, {"wx", &B::wx}, {"wy", &B::wy}, {"wz", &B::wz}};
  if (dimension == Dimension::planar) return planar;
  return in_space;
}

template <class S>
std::vector<BodyState> states_of(const BasicWorld<S>& world, int bodies) {
  std::vector<BodyState> states;
  states.reserve(static_cast<std::size_t>(bodies));
  for (int k = 0; k < bodies; ++k) states.push_back(state_of(world.place(k), world.velocity(k)));
  return states;
}

template <class S>
Frame frame_of(const BasicWorld<S>& world, double time, int bodies) {
  return frame_of(world, time, bodies, world.energy());
}

template <class S>
Frame frame_of(const BasicWorld<S>& world, double time, int bodies, double energy) {
  Frame frame;
  frame.time = time;
  frame.bodies = states_of(world, bodies);
  frame.energy = energy;
  frame.worst = world.worst_position_error();
  frame.passed = world.worst_passed_end();
  return frame;
}

#define CDOT_INSTANTIATE(S)                                             \
  template std::vector<BodyState> states_of(const BasicWorld<S>&, int); \
  template Frame frame_of(const BasicWorld<S>&, double, int);           \
  template Frame frame_of(const BasicWorld<S>&, double, int, double);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
CDOT_FOR_EACH_EXTENDED_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

bool finite(const Frame& frame) {
  for (const BodyState& b : frame.bodies) {
    if (!std::isfinite(b.x + b.y + b.z + b.angle + b.vx + b.vy + b.vz + b.w)) return false;
    if (!std::isfinite(b.e0 + b.e1 + b.e2 + b.e3 + b.wx + b.wy + b.wz)) return false;
  }
  return !std::isnan(frame.energy);
}

template <class S>
void read_sensors(const Scene& scene, BasicWorld<S>& world, const Frame& start, Frame& frame) {
  if (!scene.sensors.empty())
    frame.sensors = sensor_values(scene, world, accelerations_between(start, frame, S::dimension));
}

#define CDOT_INSTANTIATE(S) template void read_sensors(const Scene&, BasicWorld<S>&, const Frame&, Frame&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

Frame between(const Frame& before, const Frame& after, double time) {
  const double h = after.time - before.time, s = (time - before.time) / h;
  Frame frame = after;
  frame.time = time;
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const BodyState &a = before.bodies[k], &b = after.bodies[k];
    frame.bodies[k] = {cubic(a.x, a.vx, b.x, b.vx, h, s),
                       cubic(a.y, a.vy, b.y, b.vy, h, s),
                       cubic(a.angle, a.w, b.angle, b.w, h, s),
                       linear(a.vx, b.vx, s),
                       linear(a.vy, b.vy, s),
                       linear(a.w, b.w, s),
                       cubic(a.z, a.vz, b.z, b.vz, h, s),
                       linear(a.vz, b.vz, s)};
    turn(a, b, h, s, frame.bodies[k]);
  }
  frame.energy = linear(before.energy, after.energy, s);
  for (std::size_t k = 0; k < frame.sensors.size(); ++k)
    frame.sensors[k] = linear(before.sensors[k], after.sensors[k], s);
  return frame;
}

std::vector<double> every(double dt, double until) {
  constexpr double most = 1e8;  // each takes 8 to 24 bytes
  if (until / dt > most)
    throw Error(
        fmt::format("{:.3g} times {} s apart up to {} s are more than {:g}. Likely fix: {:.2g} s, or an earlier end",
                    until / dt, dt, until, most, until / most));
  std::vector<double> times;
  const auto last = static_cast<long long>(std::floor(until / dt * (1 + 1e-12)));
  for (long long k = 0; k <= last; ++k) times.push_back(static_cast<double>(k) * dt);
  return times;
}

std::vector<double> equal_times(double until, int count, int first) {
  std::vector<double> times;
  for (int k = first; k < first + count; ++k) times.push_back(until * k / count);
  return times;
}

}  // namespace cdot
