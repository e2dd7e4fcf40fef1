// A scene as its own step (`cdot compile`), built by the machine's compiler and loaded: ways beside those of the World.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "runtime/tool/compiled/step_library.hpp"
#include "runtime/tool/run/trajectory.hpp"

namespace cdot {

class CompiledScenes {
 public:
  using Doing = std::function<void(const std::string& what)>;

  // Compiles the scene for each way with lanes, and removes the ways that cannot be compiled.
  CompiledScenes(const Scene& scene, std::vector<Way>& ways, const SceneCompiler& compiler, const Doing& doing);

  // As trajectory_of() and cpu_of() of a World. The CPU time of a trajectory is that of all lanes, cpu() that of one.
  Trajectory trajectory(const Way& way, const Knob& knob, const std::vector<double>& times, const Stop& stop) const;
  double cpu(const Way& way, const Knob& knob, const std::vector<double>& times, const Stop& stop) const;

  const std::vector<std::string>& left_out() const {
    return left_out_;
  }  // the reasons, each with its fix if it has one

 private:
  friend class CompiledRun;
  Dimension dimension_;
  Frame start_;                      // of a World: bodies that do not move stay there
  std::vector<std::size_t> moving_;  // numbers of bodies
  std::map<std::pair<Integrator, int>, CompiledStep> steps_;
  std::vector<std::string> left_out_;
};

// A run of a compiled scene, which outlives it.
class CompiledRun {
 public:
  CompiledRun(const CompiledScenes& scenes, const Way& way);
  void advance(double h, int steps = 1) { step_.advance(state_.get(), h, steps); }
  // Of the first lane; reads energy, C and Cdot anew.
  Frame frame(double time);
  void look();
  double energy() const { return *(numbers_.end() - 3); }  // as these: of the last look [J]
  double C() const { return *(numbers_.end() - 2); }       // the largest |C| [m], [rad]
  double Cdot() const { return numbers_.back(); }

 private:
  const CompiledScenes& scenes_;
  const CompiledStep& step_;
  std::unique_ptr<void, void (*)(void*)> state_;
  std::vector<double> numbers_;
};

// By each method that `cdot compile` writes: alone, and eight at a time.
const std::vector<Way>& compiled_ways();
}  // namespace cdot
