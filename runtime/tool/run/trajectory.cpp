// A scene and a way -> a trajectory.
#include "runtime/tool/run/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <cdot/rotation.hpp>

#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

constexpr double least_measured = 2e-3;  // [s]: a shorter run is repeated
constexpr int most_repeats = 16;         // since building the World may cost more than the run

// Calls after_step() after every step(h), and at_sample(time, cpu so far) at every time until it returns false.
template <class S, class F, class G>
void run(BasicWorld<S>& world, const Knob& knob, const std::vector<double>& times, F after_step, G at_sample) {
  double from = 0, cpu = 0;
  for (const double to : times) {
    const double h = (to - from) / knob.steps;
    const double start = cpu_now();
    for (int k = 0; k < knob.steps; ++k) {
      world.step(h);
      after_step();
    }
    cpu += cpu_now() - start;
    if (!at_sample(to, cpu)) return;
    from = to;
  }
}

template <class T, class Random>
void move_body(World<T>& world, int body, const Perturbation& by, Random off) {
  const auto q = world.place(body);
  const auto v = world.velocity(body);
  world.set_velocity(body, {v.x + by.speed * off(), v.y + by.speed * off(), v.w + by.spin * off()});
  world.set_pose(body, {q.x + by.position * off(), q.y + by.position * off(), q.angle + by.angle * off()});
}
// The velocity comes first: the momentum of a body whose tensor turns follows from velocity and pose.
template <class T, class Random>
void move_body(SpatialWorld<T>& world, int body, const Perturbation& by, Random off) {
  const auto q = world.place(body);
  const auto v = world.velocity(body);
  const auto turned =
      spatial::turned_by(world.pose(body), {T(by.angle * off()), T(by.angle * off()), T(by.angle * off())});
  world.set_velocity(body, {v.x + by.speed * off(), v.y + by.speed * off(), v.z + by.speed * off(),
                            v.wx + by.spin * off(), v.wy + by.spin * off(), v.wz + by.spin * off()});
  world.set_pose(body, {q.x + by.position * off(), q.y + by.position * off(), q.z + by.position * off(),
                        double(turned.e0), double(turned.e1), double(turned.e2), double(turned.e3)});
}

template <class S>
void move_start(BasicWorld<S>& world, int bodies, const Perturbation& by) {
  if (by.position == 0 && by.angle == 0 && by.speed == 0 && by.spin == 0) return;
  std::mt19937 random(by.seed);
  // -1 to 1 from the generator's bits: the same with every library.
  const auto off = [&] { return 2 * (static_cast<double>(random()) / 4294967295.0) - 1; };
  for (int body = 0; body < bodies; ++body)
    if (!world.is_static(body)) move_body(world, body, by, off);
  world.project(0);
}

// Collects the largest errors of joints and the range of the energy.
template <class S>
class ErrorMonitor {
 public:
  ErrorMonitor(const BasicWorld<S>& world, Trajectory& trajectory) : world_(world), trajectory_(trajectory) {}
  void check() {
    const double start = cpu_now();
    trajectory_.C = std::max(trajectory_.C, world_.worst_position_error().value);
    trajectory_.Cdot = std::max(trajectory_.Cdot, world_.worst_velocity_error().value);
    const double energy = world_.energy();
    trajectory_.least_energy = first_ ? energy : std::min(trajectory_.least_energy, energy);
    trajectory_.most_energy = first_ ? energy : std::max(trajectory_.most_energy, energy);
    first_ = false;
    trajectory_.looking += cpu_now() - start;
  }

 private:
  const BasicWorld<S>& world_;
  Trajectory& trajectory_;
  bool first_ = true;
};

}  // namespace

Trajectory trajectory_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
                         const Stop& stop, const Perturbation& perturbation, bool watched) {
  return in_space_of(scene, way, [&]<class S>(S) {
    Trajectory trajectory;
    std::string warnings;  // the caller has them: they concern the scene, not the way
    BasicWorld<S> world = world_at_start<S>(solved_by(way, knob, scene), warnings);
    const int bodies = static_cast<int>(scene.bodies.size());
    move_start(world, bodies, perturbation);
    ErrorMonitor<S> monitor(world, trajectory);
    const auto after_step = [&] {
      if (watched) monitor.check();
    };
    run(world, knob, times, after_step, [&](double time, double cpu) {
      trajectory.cpu = watched ? cpu - trajectory.looking : cpu;
      if (!watched) monitor.check();
      trajectory.counts = world.step_counts();
      const Frame frame = frame_of(world, time, bodies);
      trajectory.finite = finite(frame);
      if (!trajectory.finite) return false;
      trajectory.frames.push_back(frame);
      trajectory.stopped = stop && stop();
      return !trajectory.stopped;
    });
    return trajectory;
  });
}

double cpu_of(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
              const Stop& stop) {
  return in_space_of(scene, way, [&]<class S>(S) {
    const Scene own = solved_by(way, knob, scene);
    std::string warnings;
    double total = 0;
    int runs = 0;
    for (bool stopped = false; !stopped && total < least_measured && runs < most_repeats; ++runs) {
      BasicWorld<S> world = world_at_start<S>(own, warnings);
      double whole = 0;
      const auto nothing = [] {};
      run(world, knob, times, nothing, [&](double, double cpu) {
        whole = cpu;
        stopped = stop && stop();
        return !stopped;
      });
      total += whole;
    }
    return total / runs;
  });
}

Apart apart(const BodyState& a, const BodyState& b, Dimension dimension) {
  return {std::hypot(a.x - b.x, a.y - b.y, a.z - b.z),
          dimension == Dimension::planar ? std::abs(a.angle - b.angle)
                                         : spatial::norm(spatial::turn_between(orientation_of(a), orientation_of(b)))};
}

Apart apart(const Frame& a, const Frame& b, Dimension dimension) {
  Apart worst;
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    const Apart one = apart(a.bodies[k], b.bodies[k], dimension);
    worst.position = std::max(worst.position, one.position);
    worst.angle = std::max(worst.angle, one.angle);
  }
  return worst;
}

}  // namespace cdot
