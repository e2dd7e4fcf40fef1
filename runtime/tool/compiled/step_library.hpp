// A scene's own step as a library: `cdot compile` writes it, the machine's compiler builds it, and it is loaded.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// The functions of a loaded step. A state has so many lanes. The numbers of a body are its place and velocity in the
// order of state_columns(); bodies that do not move have none.
struct CompiledStep {
  int lanes, bodies;
  void* (*make)();  // a state at the start of the scene
  void (*destroy)(void* state);
  void (*advance)(void* state, double h, int steps);
  // Of the first lane: the numbers of the bodies; then the energy [J], the largest |C| [m], [rad] and the largest
  // |dC/dt|.
  void (*look)(const void* state, double* numbers);
  // Of one lane: its bodies, or its energy and its largest |C|.
  void (*read)(const void* state, int lane, double* numbers);
  void (*measure)(const void* state, int lane, double* energy, double* C);
  // Of one lane, its bodies, or an input by its number among those that were wished for. begin() after the last.
  void (*write)(void* state, int lane, const double* numbers);
  void (*set_input)(void* state, int lane, int input, double value);
  void (*begin)(void* state);
};

// The program cdot-compile, and the folder of <cdot/pack.hpp>; empty paths if they are not there.
struct SceneCompiler {
  std::filesystem::path program, include;
  double cpu = 20;                // seconds of CPU time that the C++ compiler may take for each method
  std::filesystem::path specs{};  // of scenes that lie in no folder of specs; empty: cdot-compile knows where to look
};
SceneCompiler scene_compiler_beside_program();

struct StepWishes {
  Integrator integrator = Integrator::rk4;
  int lanes = 8;                    // of the step with lanes: 4, 8 or 16
  std::vector<std::string> inputs;  // numbers that may change, as of `cdot compile --input`
};

// The steps of one lane and of many: built, loaded, and kept to the end of the program. With the reason if there are
// none, and its fix if it has one.
struct LoadedSteps {
  CompiledStep one, many;
  std::string failure;
};
LoadedSteps load_steps(const Scene& scene, const StepWishes& wishes, const SceneCompiler& compiler);

// "c++ -O2 -march=native"
std::string compiled_by();

}  // namespace cdot
