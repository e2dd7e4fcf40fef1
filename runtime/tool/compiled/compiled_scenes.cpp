// A scene -> libraries of its own step, one for each method, and their runs.
#include "runtime/tool/compiled/compiled_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <dlfcn.h>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <set>

#include <cdot/methods.hpp>

#include "runtime/command_line/installation.hpp"
#include "runtime/tool/compiled/compiler.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {
namespace {

namespace fs = std::filesystem;

constexpr int most_lanes = 8;
constexpr double least_measured = 2e-3;  // [s]: a shorter run is repeated
constexpr int most_repeats = 1000;
constexpr const char* optimised = "-O2 -march=native";
// The same bits alone and in a lane (the head of each compiled scene tells why).
constexpr const char* for_library = "-std=c++20 -ffp-contract=off -fno-tree-slp-vectorize -fPIC -shared -w";

// The functions of CompiledStep for {0} lanes each.
constexpr const char* program_text = R"(#include <cdot/pack.hpp>

#include "scene.hpp"

namespace {

double first(double x) { return x; }
template <class Pack>
double first(const Pack& x) { return x[0]; }

template <class T>
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
  static void look(const void* of, double* numbers) {
    const State& state = *static_cast<const State*>(of);
    for (int i = 0; i < Scene::bodies; ++i) numbers = body(state.q[i], state.v[i], numbers);
    *numbers++ = first(Scene::energy(state));
    *numbers = numbers[1] = 0;
    if constexpr (Scene::rows > 0) {
      T C[Scene::rows], Cdot[Scene::rows];
      Scene::errors(state.q, state.time, C);
      Scene::rates(state.J, state.v, Cdot);
      for (int r = 0; r < Scene::rows; ++r) {
        larger(numbers[0], first(C[r]));
        larger(numbers[1], first(Cdot[r]));
      }
    }
  }

 private:
  static void larger(double& most, double x) {
    if (!((x < 0 ? -x : x) <= most)) most = x < 0 ? -x : x;
  }
  template <class Pose, class Velocity>
  static double* body(const Pose& q, const Velocity& v, double* to) {
    if constexpr (requires { q.e0; }) {
      for (const T& x : {q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3, v.x, v.y, v.z, v.wx, v.wy, v.wz}) *to++ = first(x);
    } else {
      for (const T& x : {q.x, q.y, q.angle, v.x, v.y, v.w}) *to++ = first(x);
    }
    return to;
  }
};

struct Step {
  void* (*make)();
  void (*destroy)(void*);
  void (*advance)(void*, double, int);
  void (*look)(const void*, double*);
};
template <class T>
constexpr Step step = {Run<T>::make, Run<T>::destroy, Run<T>::advance, Run<T>::look};

}  // namespace

extern "C" const void* cdot_step(int lanes) {
  return lanes == 1 ? &step<double> : &step<cdot::Pack<double, 8>>;
}
)";

// The first of these places that is there, seen from the running program.
fs::path beside_program(std::initializer_list<const char*> places) {
  std::error_code none;
  for (const char* place : places)
    if (const fs::path path = command_line::own_folder() / place; fs::exists(path, none)) return fs::canonical(path);
  return {};
}

// The folder of specs to which the scene belongs, as an option; none: `cdot compile` knows where to look.
std::string specs_of(const Scene& scene) {
  for (fs::path folder = fs::absolute(scene.file).parent_path(); folder.has_relative_path();
       folder = folder.parent_path())
    if (folder.filename() == "specs") return " --specs " + quoted(folder.string());
  return {};
}

// Writes the step of one method into the folder and compiles it to `library`. Returns the reason if it cannot.
std::string build(const Scene& scene, Integrator integrator, const ScratchFolder& folder, const std::string& library,
                  const SceneCompiler& compiler) {
  if (compiler.program.empty() || compiler.include.empty())
    return "the program cdot-compile is not beside cdot-run. Fix: build or install it";
  const Ran written = shell(fmt::format(
      "{} compile {} --integrator {} --name Compiled -o {}{}", quoted(compiler.program.string()), quoted(scene.file),
      name_of(integrators, integrator), quoted(folder.file("scene.hpp")), specs_of(scene)));
  if (!written.well) return first_line(written.output);
  std::ofstream(folder.file("program.cpp")) << program_text;
  const Ran built = shell(fmt::format("ulimit -t {}; {} {} {} -I{} {} -o {}", std::ceil(compiler.cpu), compiler_name(),
                                      optimised, for_library, quoted(compiler.include.string()),
                                      quoted(folder.file("program.cpp")), quoted(library)));
  if (built.well) return {};
  if (built.output.find("signal") != std::string::npos)
    return fmt::format("{} takes more than {} s of CPU time. Fix: a larger --budget", compiler_name(),
                       std::ceil(compiler.cpu));
  return fmt::format("{} failed: {}", compiler_name(), first_line(built.output));
}

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

std::string compiled_by() { return fmt::format("{} {}", compiler_name(), optimised); }

// Where both are installed, or in the folder of a build.
SceneCompiler scene_compiler_beside_program() {
  const fs::path header = beside_program({"../include/cdot/pack.hpp"});
  return {beside_program({"cdot-compile", "../derive/cdot-compile"}), header.parent_path().parent_path()};
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
  for (const Integrator integrator : wanted) {
    if (!compiles) break;
    const std::string name(name_of(integrators, integrator));
    doing("compiling the scene for " + name);
    const ScratchFolder folder;
    const std::string library = folder.file("step.so");
    const std::string failure = build(scene, integrator, folder, library, compiler);
    if (failure.empty()) load(library, integrator);
    else left_out_.push_back(name + ": " + failure);
  }
  std::erase_if(ways, [&](const Way& way) { return way.lanes > 0 && !steps_.contains({way.integrator, way.lanes}); });
}

// The library stays loaded to the end of the program.
void CompiledScenes::load(const std::string& library, Integrator integrator) {
  void* const loaded = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = loaded ? dlsym(loaded, "cdot_step") : nullptr;
  if (!found) throw Error(fmt::format("a compiled scene cannot be loaded: {}", dlerror()));
  const auto step = reinterpret_cast<const void* (*)(int)>(found);
  for (const int lanes : {1, most_lanes}) steps_[{integrator, lanes}] = *static_cast<const CompiledStep*>(step(lanes));
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
