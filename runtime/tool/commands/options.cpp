// Options on the command line -> changes of a scene.
#include "runtime/tool/commands/options.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unistd.h>

#include <cdot/methods.hpp>

#include "runtime/tool/run/pick_integrator.hpp"
#include "runtime/tool/scene/keys.hpp"

namespace cdot {

void add_scene(Line& line, SceneOptions& options) {
  line.add("SCENE", &options.file,
           "the scene: a TOML file, the name of a scene in specs/scenes, or - for standard input")
      .required();
}

namespace {

template <auto list, auto... path>
void add_number(Line& line, SceneOptions& options, const std::string& flag, const std::string& meaning) {
  using Number = std::remove_cvref_t<decltype((std::declval<Scene>().*....*path))>;
  const std::function change = [&options](Number x) {
    (options.*list).push_back([x](Scene& scene) { (scene.*....*path) = x; });
  };
  line.add(flag, change, meaning).positive().repeatable();
}

template <auto list, const auto& table, auto... path>
void add_choice(Line& line, SceneOptions& options, const std::string& flag, const std::string& meaning) {
  const std::function change = [&options](const std::string& name) {
    (options.*list).push_back([name](Scene& scene) { (scene.*....*path) = method_called(table, name); });
  };
  line.add(flag, change, meaning).one_of(names_of(table)).repeatable();
}

void add_integrator(Line& line, SceneOptions& options, const std::string& flag, const std::string& meaning) {
  const std::function change = [&options](const std::string& name) {
    options.methods.push_back([name](Scene& scene) { name_integrator(scene, name); });
  };
  line.add(flag, change, meaning).one_of(integrator_choices()).repeatable();
}

constexpr auto settings = &Scene::settings;
constexpr auto methods = &SceneOptions::methods, others = &SceneOptions::changes;

// Keys of a scene that are also options, with the same help: --local-error for local_error.
// clang-format off
constexpr struct {
  const char* key;
  void (*add)(Line&, SceneOptions&, const std::string& flag, const std::string& meaning);
} method_keys[] = {
    {"step",        add_number<methods, &Scene::step>},
    {"solver",      add_choice<methods, solvers, settings, &Settings::solver>},
    {"integrator",  add_integrator},
    {"local_error", add_number<methods, settings, &Settings::local_error>},
    {"kernels",     add_choice<methods, kernel_forms, settings, &Settings::kernels>},
    {"precision",   add_choice<methods, precisions, &Scene::single>},
    {"drift",       add_choice<methods, drifts, &Scene::drift>},
    {"iterations",  add_number<methods, settings, &Settings::iterations>},
    {"substeps",    add_number<methods, settings, &Settings::substeps>},
    {"on_failure",  add_choice<others, failure_answers, &Scene::on_failure>},
};
// clang-format on

}  // namespace

void add_until(Line& line, SceneOptions& options) {
  add_number<others, &Scene::duration>(line, options, "--until",
                                       "end at this time [s] instead of the scene's duration");
}

void add_method(Line& line, SceneOptions& options) {
  const KeyTable top = keys_of_the_top();
  for (const auto& [key, add] : method_keys) {
    const auto row = std::ranges::find(top.rows, key, &KeyTable::Row::name);
    std::string flag = "--" + row->name;
    std::ranges::replace(flag, '_', '-');
    add(line, options, flag, row->meaning);
  }
}

void add_progress(Line& line, SceneOptions& options) {
  line.add("--progress", &options.progress, "show progress even if stderr is not a terminal");
}

Scene scene_of(const SceneOptions& options) {
  Scene scene = read_scene(options.file);
  for (const auto& change : options.changes) change(scene);
  if (options.methods.empty()) return with_integrator(std::move(scene));
  // A method replaces an accuracy.
  scene.accuracy = 0;
  const double written = scene.step;
  for (const auto& change : options.methods) change(scene);
  if (scene.step != written && scene.step > scene.duration)
    throw Error(fmt::format("--step {}: the run ends at {} s. Likely fix: a step of at most {} s", scene.step,
                            scene.duration, scene.duration));
  scene.step_by_options = scene.step == 0;
  if (scene.step_by_options) scene.step = usual_step(scene.duration, scene.settings.local_error > 0);
  settle_drift(scene);
  return with_integrator(std::move(scene));
}

bool progress_shown(const SceneOptions& options) { return options.progress || ::isatty(STDERR_FILENO) != 0; }

void check_within(double at, double end) {
  if (at > end) throw Error(fmt::format("--at {}: the run ends at {} s", at, end));
}

}  // namespace cdot
