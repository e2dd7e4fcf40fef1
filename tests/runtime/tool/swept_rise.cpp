#include "tests/runtime/tool/swept_rise.hpp"

#include <algorithm>
#include <limits>

#include <cdot/balance.hpp>

#include "runtime/motion/vectors.hpp"
#include "runtime/sweeps/gain.hpp"

namespace cdot::test {
namespace {

constexpr double slight = 0.005;  // of the energies of the run

// The largest |F v| + |torque w| of gravity and constant forces within a step of h, which changes v by h F / m.
template <class S>
double power_of_forces(const BasicWorld<S>& world, const Scene& scene, double h) {
  const Settings& s = scene.settings;
  const double g = std::hypot(s.gravity_x, s.gravity_y, s.gravity_z);
  const auto power_of = [h](double force, double speed, double lightness) {
    return force > 0 ? force * (speed + h * force * lightness) : 0;
  };
  double power = 0;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    if (world.is_static(i)) continue;
    const auto v = world.velocity(i);
    const auto m = world.inverse_mass(i);
    const double weight = g / double(m.m);
    if constexpr (S::dimension == Dimension::planar) {
      const BodyDefinition& of = scene.bodies[static_cast<std::size_t>(i)].definition;
      power += power_of(weight + std::hypot(of.force_x, of.force_y), std::hypot(v.x, v.y), m.m);
      power += power_of(std::abs(of.torque), std::abs(v.w), m.I);
    } else {
      const SpatialBodyDefinition& of = scene.bodies[static_cast<std::size_t>(i)].spatial;
      power += power_of(weight + std::hypot(of.force_x, of.force_y, of.force_z), std::hypot(v.x, v.y, v.z), m.m);
      power += power_of(std::hypot(of.torque_x, of.torque_y, of.torque_z), std::hypot(v.wx, v.wy, v.wz),
                        m.Ixx + m.Iyy + m.Izz);
    }
  }
  return power;
}

// The rotation of a turning tensor by its mean spin is of second order, so a step changes the energy by (w h)^3 of it.
template <class S>
double missed_by_turning(const BasicWorld<S>& world, double h) {
  double sum = 0;
  if constexpr (S::has_gyroscopes)
    for (int i = 0; i < world.body_count(); ++i) {
      if (world.is_static(i)) continue;
      const auto v = world.velocity(i);
      const auto m = world.inverse_mass(i);
      const spatial::Vector<double> w{v.wx, v.wy, v.wz};
      const auto I = spatial::inverse(spatial::Symmetric<double>{m.Ixx, m.Iyy, m.Izz, m.Ixy, m.Ixz, m.Iyz});
      sum += 0.5 * spatial::dot(w, I * w) * std::pow(h * spatial::norm(w), 3);
    }
  return sum;
}

// Velocities correct the round-off of poses: sum m (epsilon x / h)^2 / 2, with a few roundings in a step.
template <class S>
double energy_of_round_off(const BasicWorld<S>& world, double h) {
  constexpr double epsilon = 8 * double(std::numeric_limits<typename S::Scalar>::epsilon());
  double sum = 0;
  for (int i = 0; i < world.body_count(); ++i) {
    if (world.is_static(i)) continue;
    const double far = spatial::norm(position<double>(world.pose(i)));
    sum += 0.5 / double(world.inverse_mass(i).m) * std::pow(epsilon * far / h, 2);
  }
  return sum;
}

// Of the gaps of a start, which a step may close at once.
template <class S>
double energy_of_gaps(BasicWorld<S>& world, double h) {
  const WorldData<S>& state = world.data();
  double energy = 0;
  for (const auto& batch : state.batches) {
    Batch<S> rows = *batch;  // a copy, because the next step may start from the World's own rows
    rows.ops->evaluate(rows, 0, rows.count(), state.bodies, typename S::Scalar(state.time));
    energy += cdot::energy_of_gaps(rows, 0, rows.count(), state.bodies, h);
  }
  return energy;
}

template <class S>
SweptRise watch(const Scene& scene, const SweptWay& way) {
  BasicWorld<S> world = build_world_in<S>(scene);
  if (scene.project) world.project(by_precision<typename S::Scalar>(1e-5, 1e-12));
  SweptRise seen;
  seen.bound = slight;
  seen.starts = world.worst_position_error().value <= 1e-3 && world.worst_passed_end().by <= 1e-6;
  if (!seen.starts) return seen;
  BalanceWatch balance;
  balance.look(world.balance());
  const double longest = way.jitter.longest * way.unit / way.substeps;
  const double shortest = way.jitter.shortest * way.unit / way.substeps;
  const double of_gaps = energy_of_gaps(world, shortest);
  double power = power_of_forces(world, scene, longest), missed = energy_of_round_off(world, shortest);
  for (int k = 0; !seen.fails && world.time() < way.duration; ++k) {
    seen.fails = !world.step(way.jitter.length(k) * way.unit);
    if (seen.fails) break;
    balance.look(world.balance());
    power = std::max(power, power_of_forces(world, scene, longest));
    missed += way.substeps * missed_by_turning(world, way.jitter.length(k) * way.unit / way.substeps);
  }
  seen.starts = of_gaps <= slight * balance.risen.scale;
  seen.risen = balance.risen.share(), seen.time = balance.risen.time;
  if (power + missed > 0) seen.bound += (longest * power + missed) / balance.risen.scale;
  return seen;
}

}  // namespace

Scene with_sweeps(Scene scene, const SweptWay& way) {
  scene.settings = {.solver = Solver::iterative,
                    .integrator = way.integrator,
                    .drift = way.drift,
                    .iterations = way.sweeps,
                    .substeps = way.substeps,
                    .gravity_x = scene.settings.gravity_x,
                    .gravity_y = scene.settings.gravity_y,
                    .gravity_z = scene.settings.gravity_z};
  return scene;
}

SweptRise swept_rise(const Scene& scene, const SweptWay& way) {
  SweptRise seen;
  const auto run = [&](auto space) { seen = watch<decltype(space)>(with_sweeps(scene, way), way); };
  if (scene.single) in_space_of<float>(scene, run);
  else in_space_of<double>(scene, run);
  return seen;
}

}  // namespace cdot::test
