// Options on the command line -> changes of a scene.
#include "runtime/tool/commands/options.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unistd.h>

#include <cdot/methods.hpp>

#include "runtime/tool/scene/keys.hpp"

namespace cdot {

void add_scene(CLI::App& line, SceneOptions& options) {
  line.add_option("SCENE", options.file, "the scene: a TOML file")->required();
}

namespace {

template <auto... path>
CLI::Option* add_number(CLI::App& line, SceneOptions& options, const std::string& flag, const std::string& meaning) {
  using Number = std::remove_cvref_t<decltype((std::declval<Scene>().*....*path))>;
  const auto change = [&options](const Number& x) {
    options.changes.push_back([x](Scene& scene) { (scene.*....*path) = x; });
  };
  return line.add_option_function<Number>(flag, change, meaning)->check(CLI::PositiveNumber);
}

template <const auto& table, auto... path>
CLI::Option* add_choice(CLI::App& line, SceneOptions& options, const std::string& flag, const std::string& meaning) {
  const auto change = [&options](const std::string& name) {
    options.changes.push_back([name](Scene& scene) { (scene.*....*path) = method_called(table, name); });
  };
  return line.add_option_function<std::string>(flag, change, meaning)->check(CLI::IsMember(names_of(table)));
}

constexpr auto settings = &Scene::settings;

// Keys of a scene that are also options, with the same help: --local-error for local_error.
// clang-format off
constexpr struct {
  const char* key;
  CLI::Option* (*add)(CLI::App&, SceneOptions&, const std::string& flag, const std::string& meaning);
} method_keys[] = {
    {"step",        add_number<&Scene::step>},
    {"solver",      add_choice<solvers, settings, &Settings::solver>},
    {"integrator",  add_choice<integrators, settings, &Settings::integrator>},
    {"local_error", add_number<settings, &Settings::local_error>},
    {"kernels",     add_choice<kernel_forms, settings, &Settings::kernels>},
    {"precision",   add_choice<precisions, &Scene::single>},
    {"drift",       add_choice<drifts, settings, &Settings::drift>},
    {"iterations",  add_number<settings, &Settings::iterations>},
    {"substeps",    add_number<settings, &Settings::substeps>},
};
// clang-format on

}  // namespace

CLI::Option* add_until(CLI::App& line, SceneOptions& options) {
  return add_number<&Scene::duration>(line, options, "--until", "end at this time [s] instead of the scene's duration");
}

void add_method(CLI::App& line, SceneOptions& options) {
  const KeyTable top = keys_of_the_top();
  for (const auto& [key, add] : method_keys) {
    const auto row = std::ranges::find(top.rows, key, &KeyTable::Row::name);
    std::string flag = "--" + row->name;
    std::ranges::replace(flag, '_', '-');
    add(line, options, flag, row->meaning);
  }
}

void add_progress(CLI::App& line, SceneOptions& options) {
  line.add_flag("--progress", options.progress, "show progress even if stderr is not a terminal");
}

Scene scene_of(const SceneOptions& options) {
  Scene scene = read_scene(options.file);
  for (const auto& change : options.changes) change(scene);
  return scene;
}

bool progress_shown(const SceneOptions& options) { return options.progress || ::isatty(STDERR_FILENO) != 0; }

void check_within(double at, double end) {
  if (at > end) throw Error(fmt::format("--at {}: the run ends at {} s", at, end));
}

}  // namespace cdot
