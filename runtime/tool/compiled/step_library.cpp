#include "runtime/tool/compiled/step_library.hpp"

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <fmt/format.h>
#include <fstream>

#include <cdot/methods.hpp>

#include "runtime/command_line/installation.hpp"
#include "runtime/tool/compiled/compiler.hpp"

namespace cdot {
namespace {

namespace fs = std::filesystem;

constexpr const char* optimised = "-O2 -march=native";
// The same bits alone and in a lane (the head of each compiled scene tells why).
constexpr const char* for_library = "-std=c++20 -ffp-contract=off -fno-tree-slp-vectorize -fPIC -shared -w";

// The functions of CompiledStep for one lane and for CDOT_LANES of them. CDOT_SET_INPUTS are the cases of a switch.
constexpr const char* program_text = R"(#include <cdot/pack.hpp>

#include "scene.hpp"

namespace {

double get(double x, int) { return x; }
template <class Pack>
double get(const Pack& x, int lane) { return x[lane]; }
void set(double& x, int, double value) { x = value; }
template <class Pack>
void set(Pack& x, int lane, double value) { x.set(lane, value); }

template <class T, int lanes>
struct Run {
  using Scene = cdot::scenes::Compiled<T>;
  using State = typename Scene::State;

  static void* make() {
    State* const state = new State;
    Scene::reset(*state);
    return state;
  }
  static void destroy(void* state) { delete static_cast<State*>(state); }
  static void advance(void* state, double h, int steps) {
    for (int k = 0; k < steps; ++k) Scene::step(*static_cast<State*>(state), T(h));
  }
  static void begin(void* state) { Scene::begin(*static_cast<State*>(state)); }

  static void look(const void* of, double* numbers) {
    const State& state = *static_cast<const State*>(of);
    read(of, 0, numbers);
    numbers += Scene::bodies * numbers_of_body;
    measure(of, 0, numbers, numbers + 1);
    numbers[2] = 0;
    if constexpr (Scene::rows > 0) {
      T Cdot[Scene::rows];
      Scene::rates(state.J, state.v, Cdot);
      for (const T& rate : Cdot) larger(numbers[2], get(rate, 0));
    }
  }
  static void read(const void* of, int lane, double* numbers) {
    State& state = *const_cast<State*>(static_cast<const State*>(of));
    each_number(state, [&](const T& x) { *numbers++ = get(x, lane); });
  }
  static void write(void* of, int lane, const double* numbers) {
    each_number(*static_cast<State*>(of), [&](T& x) { set(x, lane, *numbers++); });
  }
  static void measure(const void* of, int lane, double* energy, double* most) {
    const State& state = *static_cast<const State*>(of);
    *energy = get(Scene::energy(state), lane);
    *most = 0;
    if constexpr (Scene::rows > 0) {
      T C[Scene::rows];
      if constexpr (requires { state.p; }) Scene::errors(state.p, state.q, state.time, C);
      else Scene::errors(state.q, state.time, C);
      for (const T& error : C) larger(*most, get(error, lane));
    }
  }
  static void set_input(void* of, int lane, int input, double value) {
    State& state = *static_cast<State*>(of);
    switch (input) { CDOT_SET_INPUTS }
  }

  static constexpr bool in_space = requires(State s) { s.q[0].e0; };
  static constexpr int numbers_of_body = in_space ? 13 : 6;

 private:
  static void larger(double& most, double x) {
    if (!((x < 0 ? -x : x) <= most)) most = x < 0 ? -x : x;
  }
  template <class F>
  static void each_number(State& state, F f) {
    for (int i = 0; i < Scene::bodies; ++i) {
      auto& q = state.q[i];
      auto& v = state.v[i];
      if constexpr (in_space)
        for (T* x : {&q.x, &q.y, &q.z, &q.e0, &q.e1, &q.e2, &q.e3, &v.x, &v.y, &v.z, &v.wx, &v.wy, &v.wz}) f(*x);
      else
        for (T* x : {&q.x, &q.y, &q.angle, &v.x, &v.y, &v.w}) f(*x);
    }
  }
};

struct Step {
  int lanes, bodies;
  void* (*make)();
  void (*destroy)(void*);
  void (*advance)(void*, double, int);
  void (*look)(const void*, double*);
  void (*read)(const void*, int, double*);
  void (*measure)(const void*, int, double*, double*);
  void (*write)(void*, int, const double*);
  void (*set_input)(void*, int, int, double);
  void (*begin)(void*);
};
template <class T, int lanes, class R = Run<T, lanes>>
constexpr Step step = {lanes,   R::Scene::bodies, R::make,  R::destroy,   R::advance, R::look,
                       R::read, R::measure,       R::write, R::set_input, R::begin};

}  // namespace

extern "C" const void* cdot_step(int lanes) {
  return lanes == 1 ? &step<double, 1> : &step<cdot::Pack<double, CDOT_LANES>, CDOT_LANES>;
}
)";

// The first of these places that is there, seen from the running program.
fs::path beside_program(std::initializer_list<const char*> places) {
  std::error_code none;
  for (const char* place : places)
    if (const fs::path path = command_line::own_folder() / place; fs::exists(path, none)) return fs::canonical(path);
  return {};
}

// The folder of specs to which the scene belongs, as an option.
std::string specs_of(const Scene& scene, const SceneCompiler& compiler) {
  for (fs::path folder = fs::absolute(scene.file).parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    if (folder.filename() == "specs") return " --specs " + quoted(folder.string());
  return compiler.specs.empty() ? "" : " --specs " + quoted(compiler.specs.string());
}

// "case 0: set(state.p.guide_phi, lane, value); break; ..."
std::string cases_of(const std::vector<std::string>& inputs) {
  std::string cases;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    std::string member = inputs[k];
    std::ranges::replace(member, '.', '_');
    cases += fmt::format("case {}: set(state.p.{}, lane, value); break; ", k, member);
  }
  return cases;
}

std::string options_of(const StepWishes& wishes) {
  std::string options = fmt::format(" --integrator {}", name_of(integrators, wishes.integrator));
  if (!wishes.inputs.empty()) options += " --input " + quoted(fmt::format("{}", fmt::join(wishes.inputs, ",")));
  return options;
}

// Writes the step of one method into the folder and compiles it to `library`. Returns the reason if it cannot.
std::string build(const Scene& scene, const StepWishes& wishes, const ScratchFolder& folder, const std::string& library,
                  const SceneCompiler& compiler) {
  if (!has_program(compiler_name())) return no_compiler();
  if (compiler.program.empty() || compiler.include.empty())
    return "the program cdot-compile is not beside cdot-run. Fix: build or install it";
  if (!fs::is_regular_file(scene.file)) return fmt::format("{} is no file. Fix: write the scene into one", scene.file);
  const Ran written = shell(fmt::format("{} compile {}{} --name Compiled -o {}{}", quoted(compiler.program.string()),
                                        quoted(scene.file), options_of(wishes), quoted(folder.file("scene.hpp")),
                                        specs_of(scene, compiler)));
  if (!written.well) return first_line(written.output);
  std::ofstream(folder.file("program.cpp")) << fmt::format("#define CDOT_LANES {}\n#define CDOT_SET_INPUTS {}\n{}",
                                                           wishes.lanes, cases_of(wishes.inputs), program_text);
  const Ran built = shell(fmt::format("ulimit -t {}; {} {} {} -I{} {} -o {}", std::ceil(compiler.cpu), compiler_name(),
                                      optimised, for_library, quoted(compiler.include.string()),
                                      quoted(folder.file("program.cpp")), quoted(library)));
  if (built.well) return {};
  if (built.output.find("signal") != std::string::npos)
    return fmt::format("{} takes more than {} s of CPU time. Fix: a larger --budget", compiler_name(),
                       std::ceil(compiler.cpu));
  return fmt::format("{} failed: {}", compiler_name(), first_line(built.output));
}

// The functions of these lanes in a library that stays loaded.
CompiledStep step_of(const std::string& library, int lanes) {
  void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = loaded ? dlsym(loaded, "cdot_step") : nullptr;
  if (!found) throw Error(fmt::format("a compiled scene cannot be loaded: {}", dlerror()));
  return *static_cast<const CompiledStep*>(reinterpret_cast<const void* (*)(int)>(found)(lanes));
}

}  // namespace

std::string compiled_by() { return fmt::format("{} {}", compiler_name(), optimised); }

// Where both are installed, or in the folder of a build.
SceneCompiler scene_compiler_beside_program() {
  const fs::path header = beside_program({"../include/cdot/pack.hpp"});
  return {beside_program({"cdot-compile", "../derive/cdot-compile"}), header.parent_path().parent_path()};
}

LoadedSteps load_steps(const Scene& scene, const StepWishes& wishes, const SceneCompiler& compiler) {
  const ScratchFolder folder;
  const std::string library = folder.file("step.so");
  LoadedSteps steps{};
  steps.failure = build(scene, wishes, folder, library, compiler);
  if (steps.failure.empty()) steps.one = step_of(library, 1), steps.many = step_of(library, wishes.lanes);
  return steps;
}

}  // namespace cdot
