// Joints and effects that nobody compiled: their specs lie beside the scene.
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

#include "runtime/own/own.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

// The mistakes of a spec are those of the scene; then it has no name.
OwnType own_type(Entry& entry, const std::string& key, const std::string& spec) {
  OwnType own = add_own_type(spec);
  if (!own.name.empty()) return own;
  const std::string problems = own.problems.substr(0, own.problems.find_last_not_of('\n') + 1);
  entry.error(entry.where(key), fmt::format("{} cannot be used:\n{}", spec, problems), "correct the spec");
  return own;
}

}  // namespace

std::string spec_beside(const Entry& entry, const std::string& name, const std::vector<std::string>& endings) {
  const auto is_spec = [&](const std::filesystem::path& path) {
    return std::ranges::find(endings, path.extension().string()) != endings.end() &&
           std::filesystem::is_regular_file(path);
  };
  if (const std::string path = entry.beside(name); is_spec(path)) return path;
  for (const std::string& ending : endings)
    if (const std::string path = entry.beside(name + ending); is_spec(path)) return path;
  return {};
}

const JointType* own_joint_type(Entry& joint, Dimension dimension, const std::string& spec) {
  const OwnType own = own_type(joint, "type", spec);
  if (own.name.empty()) return nullptr;
  const JointType* const type = find_joint_type(dimension, own.name);
  const bool in_space = dimension == Dimension::spatial;
  const std::string stem = std::filesystem::path(spec).stem().string();
  if (!own.has_bodies)
    joint.error(joint.where("type"), fmt::format("{} is an effect on the coordinate of a joint", spec),
                fmt::format("name it there: angle.{} = {{ … }}", stem));
  else if (!type)
    joint.error(joint.where("type"),
                fmt::format("{} is a joint {}, and this scene is {}", spec, in_space ? "of the plane" : "in space",
                            in_space ? "in space" : "planar"));
  return type;
}

const JointType* own_effect_type(Entry& coordinate, const std::string& key, const std::string& spec) {
  const OwnType own = own_type(coordinate, key, spec);
  if (own.name.empty()) return nullptr;
  const JointType* const type = find_coordinate_effect(own.name);
  if (!type)
    coordinate.error(coordinate.where(key), fmt::format("{} does not act on the coordinate of any joint", spec),
                     fmt::format("[[joint]] type = \"{}\" makes it act on bodies", key));
  return type;
}

}  // namespace cdot
