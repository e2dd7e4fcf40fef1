// An example -> the engine's first answers, in a folder like that of the page.
#include "derive/play/first_sight.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <string>

#include "derive/play/engine.hpp"
#include "runtime/tool/compiled/compiler.hpp"

namespace cdot::play {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// The current directory, while it lives.
class WorkingIn {
 public:
  explicit WorkingIn(const fs::path& folder) { fs::current_path(folder); }
  ~WorkingIn() { fs::current_path(before_); }

 private:
  fs::path before_ = fs::current_path();
};

// The spec whose derivation the page opens with: an own one, or that of the first joint. As page.js chooses.
std::string spec_of(const json& joints, const std::string& folder, const json& own) {
  const auto path_of = [&](const json& joint) {
    std::string type = joint["type"];
    type.resize(std::min(type.find('#'), type.size()));
    const std::string path = folder + type;
    return path + (fs::exists(path + ".effect") ? ".effect" : ".joint");
  };
  for (const json& joint : joints)
    if (own.contains(path_of(joint))) return path_of(joint);
  return joints.empty() ? "" : path_of(joints[0]);
}

}  // namespace

json first_sight(const json& files, const json& example) {
  const ScratchFolder scratch;
  const WorkingIn folder(scratch.file(""));
  Engine engine;
  const auto ask = [&](const json& request) { return json::parse(engine.ask(request.dump())); };
  const std::string scene = "specs/planar/scene.toml";  // the engine reads the dimension from the text
  ask({{"do", "write"}, {"files", files}});
  ask({{"do", "write"}, {"files", example["specs"]}});
  ask({{"do", "write"}, {"files", {{scene, example["scene"]}}}});
  const json described = ask({{"do", "load"}, {"path", scene}});
  if (described.contains("problems")) return nullptr;
  json seen{{"scene", described}};
  const std::string space = described["dimension"] == 2 ? "specs/planar/" : "specs/spatial/";
  const std::string spec = spec_of(described["joints"], space, example["specs"]);
  const json lecture = spec.empty() ? json() : ask({{"do", "explain"}, {"path", spec}});
  if (lecture.contains("html")) seen["spec"] = spec, seen["lecture"] = lecture;
  return seen;
}

}  // namespace cdot::play
