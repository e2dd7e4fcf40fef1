#include "runtime/accuracy_extrapolate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "runtime/run_process.hpp"
#include "runtime/run_simulate.hpp"
#include "runtime/world_state.hpp"

namespace cdot {
namespace {

using Numbers = std::array<double, 13>;  // of one body: place, then velocity

Numbers numbers_of(const planar::Pose<double>& q, const planar::Velocity<double>& v) {
  return {q.x, q.y, q.angle, v.x, v.y, v.w};
}
Numbers numbers_of(const spatial::Pose<double>& q, const spatial::Velocity<double>& v) {
  return {q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3, v.x, v.y, v.z, v.wx, v.wy, v.wz};
}

void set_state(BasicWorld<Planar<double>>& world, int body, const Numbers& q) {
  world.set_velocity(body, {q[3], q[4], q[5]});
  world.set_pose(body, {q[0], q[1], q[2]});
}
// The velocity first: a body whose tensor turns with it takes its momentum from both.
void set_state(BasicWorld<Spatial<double>>& world, int body, const Numbers& q) {
  world.set_velocity(body, {q[7], q[8], q[9], q[10], q[11], q[12]});
  world.set_pose(body, {q[0], q[1], q[2], q[3], q[4], q[5], q[6]});
}

// One World per column, all at the same time and state between stretches.
template <class S>
class Extrapolator {
 public:
  Extrapolator(const Scene& scene, const Extrapolation& method)
      : method_(method), bodies_(static_cast<int>(scene.bodies.size())) {
    const Scene own = solved_by(method.way, {}, scene);
    std::string warnings;
    for (int k = 0; k < method.columns; ++k) worlds_.push_back(world_at_start<S>(own, warnings));
    table_.resize(worlds_.size());
    state_ = state_of(worlds_.front());
  }

  BasicWorld<S>& world() { return worlds_.front(); }

  // Takes a stretch and returns the estimated error of its end, which is not yet where the Worlds are. accept() goes
  // there, reject() back to its start.
  double attempt(double h) {
    for (std::size_t j = 0; j < worlds_.size(); ++j) {
      for (std::size_t k = 0; k <= j; ++k) worlds_[j].step(h / static_cast<double>(j + 1));
      table_[j] = state_of(worlds_[j]);
    }
    for (std::size_t k = 1; k + 1 < table_.size(); ++k) eliminate(k);
    const std::vector<Numbers> before = table_.back();
    eliminate(table_.size() - 1);
    return distance(before, table_.back());
  }

  // What is extrapolated leaves the joints by its error: back onto them, then all Worlds from there.
  void accept() {
    put(worlds_.front(), table_.back());
    worlds_.front().project(0);
    state_ = state_of(worlds_.front());
    time_ = worlds_.front().time();
    for (auto& world : worlds_) put(world, state_), world.state().time = time_;
  }
  void reject() {
    for (auto& world : worlds_) put(world, state_), world.state().time = time_;
  }

 private:
  // T[j][k+1] = T[j][k] + (T[j][k] - T[j-1][k]) / ((n_j / n_(j-k))^power - 1), in place for all j.
  void eliminate(std::size_t k) {
    for (std::size_t j = table_.size() - 1; j >= k; --j) {
      const double ratio = static_cast<double>(j + 1) / static_cast<double>(j + 1 - k);
      const double weight = 1 / (std::pow(ratio, method_.power) - 1);
      for (std::size_t body = 0; body < table_[j].size(); ++body)
        for (std::size_t n = 0; n < table_[j][body].size(); ++n)
          table_[j][body][n] += weight * (table_[j][body][n] - table_[j - 1][body][n]);
    }
  }

  static double distance(const std::vector<Numbers>& a, const std::vector<Numbers>& b) {
    double worst = 0;
    for (std::size_t body = 0; body < a.size(); ++body)
      for (std::size_t n = 0; n < a[body].size(); ++n) {
        const double apart = std::abs(a[body][n] - b[body][n]) / std::max(1.0, std::abs(b[body][n]));
        if (!(apart <= worst)) worst = std::isfinite(apart) ? apart : std::numeric_limits<double>::infinity();
      }
    return worst;
  }

  std::vector<Numbers> state_of(const BasicWorld<S>& world) const {
    std::vector<Numbers> state;
    for (int body = 0; body < bodies_; ++body) state.push_back(numbers_of(world.pose(body), world.velocity(body)));
    return state;
  }
  void put(BasicWorld<S>& world, const std::vector<Numbers>& state) const {
    for (int body = 0; body < bodies_; ++body)
      if (!world.is_static(body)) set_state(world, body, state[static_cast<std::size_t>(body)]);
  }

  Extrapolation method_;
  int bodies_;
  std::vector<BasicWorld<S>> worlds_;
  std::vector<std::vector<Numbers>> table_;
  std::vector<Numbers> state_;
  double time_ = 0;
};

// From one time to another, with a first stretch of `h`, which becomes what served last.
template <class S>
bool advance(Extrapolator<S>& extrapolator, const Extrapolation& method, double from, double to, double tolerance,
             double& h, const Stop& stop) {
  const double exponent = 1.0 / (method.power * (method.columns - 1) + 1), least = 1e-13 * (to - from);
  double left = to - from;
  while (left > 0) {
    if (stop && stop()) return false;
    const double stretches = std::ceil(left / h), now = left / stretches;
    const double error = extrapolator.attempt(now);
    const double factor = error > 0 ? 0.9 * std::pow(tolerance / error, exponent) : 4.0;
    h = now * std::clamp(factor, 0.2, 4.0);
    if (error <= tolerance || now <= least) {
      extrapolator.accept();
      left = stretches == 1 ? 0 : left - now;
    } else {
      extrapolator.reject();
    }
    h = std::max(h, least);
  }
  return true;
}

template <class S>
Trajectory extrapolated_in(const Scene& scene, const Extrapolation& method, double tolerance,
                           const std::vector<double>& times, const Stop& stop) {
  Trajectory trajectory;
  Extrapolator<S> extrapolator(scene, method);
  double from = 0, h = times.front();
  const double start = cpu_now();
  for (const double to : times) {
    trajectory.stopped = !advance(extrapolator, method, from, to, tolerance, h, stop);
    if (trajectory.stopped) break;
    from = to;
    const Frame frame = frame_of(extrapolator.world(), to, static_cast<int>(scene.bodies.size()));
    trajectory.finite = finite(frame);
    if (!trajectory.finite) break;
    trajectory.C = std::max(trajectory.C, frame.worst.value);
    trajectory.Cdot = std::max(trajectory.Cdot, extrapolator.world().worst_velocity_error().value);
    trajectory.frames.push_back(frame);
  }
  trajectory.cpu = cpu_now() - start;
  return trajectory;
}

}  // namespace

Trajectory extrapolated(const Scene& scene, const Extrapolation& method, double tolerance,
                        const std::vector<double>& times, const Stop& stop) {
  return scene.dimension == Dimension::planar ? extrapolated_in<Planar<double>>(scene, method, tolerance, times, stop)
                                              : extrapolated_in<Spatial<double>>(scene, method, tolerance, times, stop);
}

}  // namespace cdot
