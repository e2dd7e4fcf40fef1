// `cdot-run import`: a robot description -> a scene.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "runtime/tool/commands/command.hpp"
#include "runtime/tool/import/model.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {
namespace {

struct Options {
  std::string file, output = "-";
  ImportOptions how;
};

void add_options(Line& line, Options& options) {
  line.add("FILE", &options.file, "a URDF or an MJCF file; - is standard input").required();
  line.add("-o,--output", &options.output, "write the scene here; - is standard output")
      .shown_as("SCENE")
      .shows_default();
  line.add("--floating", &options.how.floating, "the root moves freely; without this it is the world");
  line.add("--balance-inertias", &options.how.balance,
           "an inertia that no rigid body has becomes the mean of its principal moments");
  line.footer(R"(
Links become bodies and joints become joints, with the limits, damping and friction that the file has, and of MJCF with
springs, loops, coupled joints (a spec beside the scene), and actuators that hold a position or a velocity. Links that fixed joints hold together become one body.
The scene begins with a list of the things left out or changed.

Examples
  cdot-run import humanoid.xml -o humanoid.toml
  cdot-run import arm.urdf -o arm.toml && cdot-run simulate arm.toml --html arm.html
  xacro arm.urdf.xacro | cdot-run import - -o arm.toml)");
}

// Specs beside the scene that is written; they go again if it has mistakes.
class SpecsBeside {
 public:
  SpecsBeside(const std::vector<ModelSpec>& specs, const std::filesystem::path& scene) {
    for (const ModelSpec& spec : specs) {
      files_.push_back((scene.parent_path() / spec.file).string());
      write_file(files_.back(), spec.text);
    }
  }
  SpecsBeside(const SpecsBeside&) = delete;
  SpecsBeside& operator=(const SpecsBeside&) = delete;
  ~SpecsBeside() {
    std::error_code none;
    for (const std::string& file : files_) std::filesystem::remove(file, none);
  }
  void keep() { files_.clear(); }

 private:
  std::vector<std::string> files_;
};

// "arm" of "scenes/arm.toml", as a name of a spec.
std::string stem_of(const std::string& output) {
  std::string stem = std::filesystem::path(output).stem().string();
  std::ranges::replace_if(
      stem, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
  return stem.empty() || std::isdigit(static_cast<unsigned char>(stem[0])) ? "model_" + stem : stem;
}

int run(const Options& options) {
  ImportOptions how = options.how;
  how.stem = stem_of(options.output);
  Model model = read_model(read_file(options.file), options.file == "-" ? "standard input" : options.file);
  const std::string text = scene_text(model, how);
  if (!model.specs.empty() && options.output == "-")
    throw Error(fmt::format("{} goes beside the scene. Likely fix: -o FILE", model.specs.front().file));
  SpecsBeside specs(model.specs, options.output);
  const std::string place = (std::filesystem::path(options.output).parent_path() / "imported").string();
  const Scene scene = read_scene(text, place);  // one with mistakes is not written
  specs.keep();
  std::FILE* summary = summary_beside({options.output});
  write_file(options.output, text);
  fmt::print(summary, "{}: {} bodies and {} joints, of {} links and {} joints\n", options.output, scene.bodies.size(),
             scene.joints.size(), model.links.size(), model.joints.size());
  for (const ModelSpec& spec : model.specs) fmt::print(summary, "  wrote     {}\n", spec.file);
  for (const std::string& thing : model.left_out) fmt::print(summary, "  left out  {}\n", thing);
  for (const std::string& thing : model.changed) fmt::print(summary, "  changed   {}\n", thing);
  return well;
}

}  // namespace

Run import_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

}  // namespace cdot
