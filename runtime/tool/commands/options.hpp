// Options of several commands.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/tool/commands/command.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// They replace the scene's own settings.
struct SceneOptions {
  std::string file;
  std::vector<std::function<void(Scene&)>> changes, methods;  // methods: an accuracy of the scene then counts no more
  bool progress = false;
};

void add_scene(Line& line, SceneOptions& options);
void add_until(Line& line, SceneOptions& options);
void add_method(Line& line, SceneOptions& options);
void add_progress(Line& line, SceneOptions& options);

Scene scene_of(const SceneOptions& options);
bool progress_shown(const SceneOptions& options);

// Throws Error if a run that ends at `end` has no state at `--at`.
void check_within(double at, double end);

}  // namespace cdot
