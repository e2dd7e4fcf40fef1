#include "runtime/run_frame.hpp"

#include <cmath>

namespace cdot {
namespace {

// The cubic with values p, q and slopes u, v at the ends of a step of length h, at the share s of
// it.
double cubic(double p, double u, double q, double v, double h, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * p + (s3 - 2 * s2 + s) * h * u + (3 * s2 - 2 * s3) * q +
         (s3 - s2) * h * v;
}

double linear(double p, double q, double s) { return (1 - s) * p + s * q; }

// How far apart two times may be and still be the same, relative to a step.
constexpr double same_time = 1e-6;

}  // namespace

Frame frame_of(const World<double>& world, double time, int bodies) {
  Frame frame;
  frame.time = time;
  frame.bodies.reserve(static_cast<std::size_t>(bodies));
  for (int k = 0; k < bodies; ++k) {
    const planar::Pose<double> pose = world.pose(k);
    const planar::Velocity<double> velocity = world.velocity(k);
    frame.bodies.push_back({pose.x, pose.y, pose.angle, velocity.x, velocity.y, velocity.w});
  }
  frame.energy = world.energy();
  frame.worst = world.worst_position_error();
  return frame;
}

bool finite(const Frame& frame) {
  for (const BodyState& b : frame.bodies) {
    if (!std::isfinite(b.x + b.y + b.angle + b.vx + b.vy + b.w)) return false;
  }
  return true;
}

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
                       linear(a.w, b.w, s)};
  }
  frame.energy = linear(before.energy, after.energy, s);
  return frame;
}

Sampler::Sampler(std::vector<double> ascending_times, Take take)
    : times_(std::move(ascending_times)), take_(std::move(take)) {}

void Sampler::step(const Frame& before, const Frame& after) {
  const double slack = same_time * (after.time - before.time);
  for (; next_ < times_.size() && times_[next_] <= after.time + slack; ++next_) {
    const double time = times_[next_];
    const bool at_end = std::abs(time - after.time) <= slack;
    Frame frame = at_end ? after : between(before, after, time);
    frame.time = time;
    take_(frame);
  }
}

std::vector<double> every(double dt, double until) {
  std::vector<double> times;
  const auto last = static_cast<long long>(std::floor(until / dt * (1 + 1e-12)));
  for (long long k = 0; k <= last; ++k) times.push_back(static_cast<double>(k) * dt);
  return times;
}

}  // namespace cdot
