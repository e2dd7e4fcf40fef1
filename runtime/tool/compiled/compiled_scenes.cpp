// A scene -> libraries of its own step, one for each method, and their runs.
#include "runtime/tool/compiled/compiled_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

#include <cdot/methods.hpp>

#include "runtime/tool/compiled/compiler.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

constexpr int most_lanes = 8;
constexpr double least_measured = 2e-3;  // [s]: a shorter run is repeated
constexpr int most_repeats = 1000;
}  // namespace

const std::vector<Way>& compiled_ways() {
  static const std::vector<Way> ways = [] {
    std::vector<Way> ways;
    for (const Integrator integrator : {Integrator::euler, Integrator::rattle, Integrator::rk4, Integrator::dop853})
      for (const int lanes : {1, most_lanes})
        ways.push_back({integrator, Solver::direct, Drift::projection, 0, false, false, false, lanes});
    return ways;
  }();
  return ways;
}

CompiledScenes::CompiledScenes(const Scene& scene, std::vector<Way>& ways, const SceneCompiler& compiler,
                               const Doing& doing)
    : dimension_(scene.dimension) {
  std::set<Integrator> wanted;
  for (const Way& way : ways)
    if (way.lanes > 0) wanted.insert(way.integrator);
  if (wanted.empty()) return;
  in_space_of<double>(scene, [&]<class S>(S) {
    std::string warnings;
    const int bodies = static_cast<int>(scene.bodies.size());
    const auto world = world_at_start<S>(scene, warnings);
    start_ = cdot::frame_of(world, 0, bodies);
    for (int body = 0; body < bodies; ++body)
      if (!world.is_static(body)) moving_.push_back(static_cast<std::size_t>(body));
  });
  const bool compiles = has_program(compiler_name());
  if (!compiles) left_out_.push_back(no_compiler());
  // The most exact ones first: the compiler has one budget for all.
  const double start = cpu_of_children();
  for (auto one = wanted.rbegin(); compiles && one != wanted.rend(); ++one) {
    const Integrator integrator = *one;
    SceneCompiler in_time = compiler;
    in_time.cpu = std::max(1.0, compiler.cpu - (cpu_of_children() - start));
    const std::string name(name_of(integrators, integrator));
    doing("compiling the scene for " + name);
    const LoadedSteps steps = load_steps(scene, {integrator, most_lanes, {}}, in_time);
    if (steps.failure.empty()) steps_[{integrator, 1}] = steps.one, steps_[{integrator, most_lanes}] = steps.many;
    else left_out_.push_back(name + ": " + steps.failure);
  }
  std::erase_if(ways, [&](const Way& way) { return way.lanes > 0 && !steps_.contains({way.integrator, way.lanes}); });
}

CompiledRun::CompiledRun(const CompiledScenes& scenes, const Way& way)
    : scenes_(scenes),
      step_(scenes.steps_.at({way.integrator, way.lanes})),
      state_(step_.make(), step_.destroy),
      numbers_(scenes.moving_.size() * state_columns(scenes.dimension_).size() + 3) {}

void CompiledRun::look() { step_.look(state_.get(), numbers_.data()); }

Frame CompiledRun::frame(double time) {
  look();
  Frame frame = scenes_.start_;
  frame.time = time;
  auto number = numbers_.begin();
  for (const std::size_t body : scenes_.moving_)
    for (const StateColumn& column : state_columns(scenes_.dimension_)) frame.bodies[body].*column.number = *number++;
  frame.energy = energy();
  return frame;
}

Trajectory CompiledScenes::trajectory(const Way& way, const Knob& knob, const std::vector<double>& times,
                                      const Stop& stop) const {
  CompiledRun run(*this, way);
  Trajectory trajectory;
  trajectory.least_energy = std::numeric_limits<double>::infinity();
  trajectory.most_energy = -trajectory.least_energy;
  double from = 0;
  for (const double to : times) {
    for (int k = 0; k < knob.steps; ++k) {
      const double start = cpu_now();
      run.advance((to - from) / knob.steps);
      const double stepped = cpu_now();
      run.look();
      trajectory.least_energy = std::min(trajectory.least_energy, run.energy());
      trajectory.most_energy = std::max(trajectory.most_energy, run.energy());
      trajectory.C = std::max(trajectory.C, run.C());
      trajectory.Cdot = std::max(trajectory.Cdot, run.Cdot());
      trajectory.cpu += stepped - start;
      trajectory.looking += cpu_now() - stepped;
    }
    from = to;
    const Frame frame = run.frame(to);
    trajectory.finite = finite(frame);
    if (!trajectory.finite) break;
    trajectory.frames.push_back(frame);
    trajectory.stopped = stop && stop();
    if (trajectory.stopped) break;
  }
  return trajectory;
}

double CompiledScenes::cpu(const Way& way, const Knob& knob, const std::vector<double>& times, const Stop& stop) const {
  double total = 0;
  int runs = 0;
  for (bool stopped = false; !stopped && total < least_measured && runs < most_repeats; ++runs) {
    CompiledRun run(*this, way);
    double from = 0;
    const double start = cpu_now();
    for (const double to : times) {
      run.advance((to - from) / knob.steps, knob.steps);
      from = to;
      if ((stopped = stop && stop())) break;
    }
    total += cpu_now() - start;
  }
  return total / runs / way.lanes;
}

}  // namespace cdot
