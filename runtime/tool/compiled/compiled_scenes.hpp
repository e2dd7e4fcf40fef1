// A scene as its own step (`cdot compile`), built by the machine's compiler and loaded: ways beside those of the World.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "runtime/tool/run/trajectory.hpp"

namespace cdot {

// The functions of a loaded step. A state has so many lanes; all lanes move alike.
struct CompiledStep {
  void* (*make)();  // a state at the start of the scene
  void (*destroy)(void* state);
  void (*advance)(void* state, double h, int steps);
  // Of the first lane: for each body that moves its place and velocity in the order of state_columns(); then the energy
  // [J], the largest |C| [m], [rad] and the largest |dC/dt|.
  void (*look)(const void* state, double* numbers);
};

// The program cdot-compile, and the folder of <cdot/pack.hpp>; empty paths if they are not there.
struct SceneCompiler {
  std::filesystem::path program, include;
  double cpu = 20;  // seconds of CPU time that the C++ compiler may take for each method
};
SceneCompiler scene_compiler_beside_program();

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
  void load(const std::string& library, Integrator integrator);

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
// "c++ -O2 -march=native"
std::string compiled_by();

}  // namespace cdot
