// Options of several commands.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "runtime/tool/commands/command.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// They replace the scene's own settings.
struct SceneOptions {
  std::string file;
  std::vector<std::function<void(Scene&)>> changes;
  bool progress = false;
};

void add_scene(CLI::App& line, SceneOptions& options);
CLI::Option* add_until(CLI::App& line, SceneOptions& options);
void add_method(CLI::App& line, SceneOptions& options);
void add_progress(CLI::App& line, SceneOptions& options);

Scene scene_of(const SceneOptions& options);
bool progress_shown(const SceneOptions& options);

// Throws Error if a run that ends at `end` has no state at `--at`.
void check_within(double at, double end);

// Adds the options of a command. run() gets their values.
template <class Options>
Run with_options(CLI::App& line, void (*add)(CLI::App&, Options&), int (*run)(const Options&)) {
  auto options = std::make_shared<Options>();
  add(line, *options);
  return [options, run] { return run(*options); };
}

}  // namespace cdot
