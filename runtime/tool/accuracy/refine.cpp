// A method, refined; and symmetric methods, composed to order 10.
#include "runtime/tool/accuracy/refine.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/methods.hpp>

#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

constexpr double settled = 3e-13;  // [m, rad]: a change that is round-off of doubles
constexpr double small = 1e-6;     // [m, rad]: below it, stagnation means round-off
constexpr int most_idle = 3;       // finer knobs without a smaller change that make stagnation

// The trajectory of one knob.
Trajectory made(const Scene& scene, const Way& way, const Knob& knob, const std::vector<double>& times,
                const Stop& stop) {
  if (row_of(way.integrator).symmetric) return composed(way.integrator, scene, knob.steps, times, stop, way.extended);
  return trajectory_of(scene, way, knob, times, stop);
}

std::string name_of_method(Integrator integrator) {
  const std::string name(name_of(integrators, integrator));
  return row_of(integrator).symmetric ? "composed " + name : name;
}

}  // namespace

// Of the two successive knobs that differ least the finer one is best: coarser knobs have larger errors of the method,
// finer ones more round-off.
Refined refined(Integrator integrator, bool extended, const Scene& scene, const std::vector<double>& times,
                const Effort& effort, const Stop& stop) {
  const Way way{.integrator = integrator, .extended = extended};
  Refined refined{name_of_method(integrator), way, {}, {}, {}, false, 0};
  Trajectory before;
  const double start = cpu_now();
  const Stop enough = [&] { return (stop && stop()) || cpu_now() - start > effort.cpu; };
  long long last = 0;
  int idle = 0;
  for (int level = 0; has_level(way, level) && !refined.at_its_floor && !enough(); ++level) {
    if (refined.evaluations + 2 * last > effort.evaluations) break;  // a knob costs at most twice the previous one
    Trajectory now = made(scene, way, knob_at(way, level), times, enough);
    last = now.counts.evaluations;
    refined.evaluations += last;
    if (now.stopped) break;
    const bool whole = now.finite && now.frames.size() == times.size();
    if (whole && before.frames.size() == times.size()) {
      std::vector<double> changes = distances(now.frames, before.frames, scene.dimension);
      const double change = largest(changes), best = refined.change();
      idle = change < best || best > small ? 0 : idle + 1;
      if (change < best) refined.best = now, refined.knob = knob_at(way, level), refined.changes = std::move(changes);
      refined.at_its_floor = idle == most_idle || change <= settled;
    }
    before = whole ? std::move(now) : Trajectory{};
  }
  return refined;
}

double Refined::change() const { return found() ? largest(changes) : std::numeric_limits<double>::infinity(); }

std::vector<double> distances(const std::vector<Frame>& a, const std::vector<Frame>& b, Dimension dimension) {
  std::vector<double> result;
  for (std::size_t k = 0; k < a.size(); ++k) result.push_back(apart(a[k], b[k], dimension).larger());
  return result;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

namespace {

// M. Sofroniou & G. Spaletta, Optim. Methods Softw. 20, 2005: 35 stages of order 10, symmetric about the last of these.
constexpr double stages[] = {
    0.07879572252168641926390768,  0.31309610341510852776481247,  0.02791838323507806610952027,
    -0.22959284159390709415121340, 0.13096206107716486317465686,  -0.26973340565451071434460973,
    0.07497334315589143566613711,  0.11199342399981020488957508,  0.36613344954622675119314812,
    -0.39910563013603589787862981, 0.10308739852747107731580277,  0.41143087395589023782070412,
    -0.00486636058313526176219566, -0.39203335370863990644808194, 0.05194250296244964703718290,
    0.05066509075992449633587434,  0.04967437063972987905456880,  0.04931773575959453791768001,
};
constexpr int middle = std::size(stages) - 1;

// With reversed velocities a step of a reversible method goes back. J, C and impulses belong to the poses: nothing is
// evaluated anew.
template <class S>
void turn_round(WorldData<S>& world) {
  using T = typename S::Scalar;
  for (auto& v : world.bodies.velocity) v = S::sum({}, v, T(-1));
  if constexpr (S::has_gyroscopes)
    for (auto& gyroscope : world.gyroscopes) {
      gyroscope.momentum = T(-1) * gyroscope.momentum;
      gyroscope.spin = T(-1) * gyroscope.spin;
    }
}

template <class S>
void composed_step(BasicWorld<S>& world, double h) {
  for (int k = -middle; k <= middle; ++k) {
    const double part = stages[middle - std::abs(k)] * h;
    if (part < 0) turn_round(world.data());
    world.step(std::abs(part));
    if (part < 0) turn_round(world.data());
  }
}

template <class S>
Trajectory composed_in(Integrator symmetric, const Scene& scene, int steps, const std::vector<double>& times,
                       const Stop& stop) {
  Trajectory trajectory;
  std::string warnings;
  BasicWorld<S> world = world_at_start<S>(solved_by({symmetric}, {}, scene), warnings);
  const double start = cpu_now();
  double from = 0;
  for (const double to : times) {
    for (int k = 0; k < steps; ++k) {
      composed_step(world, (to - from) / steps);
      world.data().time = from + (to - from) * (k + 1) / steps;  // the World counts steps back as forwards
    }
    from = to;
    trajectory.counts.evaluations += (2 * middle + 1) * static_cast<long long>(steps);
    const Frame frame = frame_of(world, to, static_cast<int>(scene.bodies.size()));
    trajectory.finite = finite(frame);
    if (!trajectory.finite) break;
    trajectory.C = std::max(trajectory.C, frame.worst.value);
    trajectory.Cdot = std::max(trajectory.Cdot, world.worst_velocity_error().value);
    trajectory.frames.push_back(frame);
    trajectory.stopped = stop && stop();
    if (trajectory.stopped) break;
  }
  trajectory.cpu = cpu_now() - start;
  return trajectory;
}

bool damps(const Softness& softness) { return softness.damping > 0 || softness.damping_ratio > 0; }

bool acts_one_way(const CoordinateEffects& effects) {
  bool any = false;
  effects.each([&](const auto& effect) { any |= effect.acts_one_way(); });
  return any;
}

bool acts_one_way(Dimension dimension, const SceneJoint& joint) {
  const JointType& type = *find_joint_type(dimension, joint.definition.type);
  return type.explicit_time || type.without_energy || in_time(joint.definition.parameters) || !joint.bonds.empty() ||
         (joint.definition.soft && damps(*joint.definition.soft)) ||
         std::any_of(type.row_kinds.begin(), type.row_kinds.end(),
                     [](RowKind kind) { return kind == RowKind::inequality; }) ||
         std::any_of(joint.effects.begin(), joint.effects.end(),
                     [](const CoordinateEffects& effects) { return acts_one_way(effects); });
}

bool damped(const SceneBody& body) {
  return body.definition.linear_damping > 0 || body.definition.angular_damping > 0 || body.spatial.linear_damping > 0 ||
         body.spatial.angular_damping > 0;
}

}  // namespace

bool reversible(const Scene& scene) {
  return std::none_of(scene.joints.begin(), scene.joints.end(),
                      [&](const SceneJoint& joint) { return acts_one_way(scene.dimension, joint); }) &&
         std::none_of(scene.bodies.begin(), scene.bodies.end(), damped) &&
         std::none_of(scene.springs.begin(), scene.springs.end(),
                      [](const SpringDefinition& spring) { return spring.damping > 0; });
}

Trajectory composed(Integrator symmetric, const Scene& scene, int steps, const std::vector<double>& times,
                    const Stop& stop, bool extended) {
  return in_space_of(scene, {.extended = extended},
                     [&]<class S>(S) { return composed_in<S>(symmetric, scene, steps, times, stop); });
}

}  // namespace cdot
