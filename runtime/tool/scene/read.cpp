// The text of a TOML file -> a Scene, or all its mistakes.
#include "runtime/tool/scene/read.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <sstream>

#include "runtime/command_line/installation.hpp"
#include "runtime/tool/scene/start.hpp"

namespace cdot {
namespace {

bool fits_a_column(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), fits);
}

// The message of toml++ without the name of its grammar rule.
std::string syntax_error(std::string_view description) {
  constexpr std::string_view rule = "Error while parsing ";
  if (description.starts_with(rule)) description.remove_prefix(rule.size());
  std::string text(description);
  if (text.starts_with("Encountered")) text[0] = 'e';
  return "invalid TOML: " + text;
}

// From the frame of a body to the world's, at its initial pose; or back.
Vec3 turned(const SceneBody& body, Dimension dimension, const Vec3& v, bool to_world) {
  if (dimension == Dimension::planar) {
    const double angle = to_world ? body.definition.angle : -body.definition.angle;
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * v[0] - s * v[1], s * v[0] + c * v[1], 0};
  }
  using Space = Spatial<double>;
  const auto pose = Space::placed(Space::place_of(body.spatial));
  const spatial::Vector<double> from{v[0], v[1], v[2]};
  const auto to = to_world ? spatial::to_world(pose, from) : spatial::to_body(pose, from);
  return {to.x, to.y, to.z};
}

// Each begins with the joint that has it; `cdot compile` knows the numbers of joints.
void check_inputs(Entry& top, const Scene& scene) {
  std::vector<std::string> joints;
  for (const SceneJoint& joint : scene.joints) joints.push_back(joint.name);
  for (std::size_t k = 0; k < scene.inputs.size() && scene.springs.empty(); ++k) {
    const std::string& input = scene.inputs[k];
    if (std::ranges::any_of(joints, [&](const std::string& joint) { return input.starts_with(joint + "."); })) continue;
    const std::string joint = input.substr(0, input.find('.'));
    top.error(top.element("inputs", k), fmt::format("no joint is called \"{}\"", joint), did_you_mean(joint, joints));
  }
}

void read_all(const toml::table& table, Mistakes& mistakes, Scene& scene) {
  Entry top(table, {}, "the scene", mistakes);
  read_settings(top, scene);
  read_bodies(top, scene);
  const BodyNames names(scene);
  read_joints(top, names, scene);
  find_forces_in_time(scene);
  read_springs(top, names, scene);
  check_inputs(top, scene);
  if (mistakes.none()) read_sensors(top, scene);
  else top.has("sensor");  // their words need joints without mistakes
  top.close();
}

}  // namespace

BodyNames::BodyNames(const Scene& scene) : scene_(&scene) {
  const std::vector<SceneBody>& bodies = scene.bodies;
  index_["world"] = world_body;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (!bodies[k].name.empty()) index_.emplace(bodies[k].name, static_cast<int>(k));
  }
  for (const auto& [name, body] : index_) known_.push_back(name);
}

std::optional<std::vector<int>> BodyNames::find(Entry& entry, const std::string& key) const {
  const std::optional<std::vector<std::string>> names = entry.texts(key);
  if (!names) return {};
  std::vector<int> bodies;
  bool all_known = true;
  for (std::size_t k = 0; k < names->size(); ++k) {
    const auto found = index_.find((*names)[k]);
    if (found == index_.end()) {
      entry.error(entry.element(key, k), fmt::format("no body is called \"{}\"", (*names)[k]),
                  did_you_mean((*names)[k], known_));
      all_known = false;
    } else {
      bodies.push_back(found->second);
    }
  }
  if (!all_known) return {};
  return bodies;
}

const std::string& BodyNames::name(int body) const {
  static const std::string world = "world";
  return body == world_body ? world : scene_->bodies[static_cast<std::size_t>(body)].name;
}

Vec3 BodyNames::turned_to_body(int body, const Vec3& direction) const {
  if (body == world_body) return direction;
  return turned(scene_->bodies[static_cast<std::size_t>(body)], dimension(), direction, false);
}

Vec3 BodyNames::to_body(int body, const Vec3& position) const {
  if (body == world_body) return position;
  const Vec3 c = position_of(scene_->bodies[static_cast<std::size_t>(body)], dimension());
  return turned_to_body(body, {position[0] - c[0], position[1] - c[1], position[2] - c[2]});
}

Vec3 BodyNames::to_world(int body, const Vec3& position) const {
  if (body == world_body) return position;
  const SceneBody& source = scene_->bodies[static_cast<std::size_t>(body)];
  const Vec3 c = position_of(source, dimension()), arm = turned(source, dimension(), position, true);
  return {c[0] + arm[0], c[1] + arm[1], c[2] + arm[2]};
}

std::optional<Vec3> read_vector(Entry& entry, const std::string& key, Dimension dimension) {
  const std::size_t size = dimension == Dimension::planar ? 2 : 3;
  const std::optional<std::vector<double>> values = entry.numbers(key, size);
  if (!values) return {};
  return Vec3{(*values)[0], (*values)[1], size == 3 ? (*values)[2] : 0};
}

std::optional<Vec3> read_of_body(Entry& entry, const std::string& key, int body, const BodyNames& names,
                                 Vec3 (BodyNames::*from_world)(int, const Vec3&) const) {
  std::optional<Entry> table = entry.table(key);
  if (!table) return read_vector(entry, key, names.dimension());
  const std::optional<Vec3> world = read_vector(*table, "world", names.dimension());
  if (!table->has("world"))
    table->error(table->header(), fmt::format("`{}` has no `world`", key),
                 names.dimension() == Dimension::planar ? "{ world = [x, y] }" : "{ world = [x, y, z] }");
  table->close();
  return world ? std::optional((names.*from_world)(body, *world)) : std::nullopt;
}

std::optional<std::string> read_name(Entry& entry, std::map<std::string, Span>& used,
                                     const std::optional<std::string>& fallback) {
  if (!entry.has("name")) {
    if (!fallback) entry.error(entry.header(), entry.what() + " has no `name`", "name = \"rod\"");
    return fallback;
  }
  const Span where = entry.where("name");
  const std::optional<std::string> name = entry.text("name");
  if (!name) return {};
  entry.rename(fmt::format("{} \"{}\"", entry.what(), entry.written("name")));
  if (!fits_a_column(*name)) {
    entry.error(where, fmt::format("\"{}\" is not a valid name", *name), "use letters, digits, _ and -");
    return {};
  }
  const auto [earlier, is_new] = used.emplace(*name, where);
  if (is_new) return name;
  const Span first = earlier->second;
  const bool same_place = first == where;
  entry.error(where,
              first.line == 0 ? fmt::format("\"{}\" is reserved for the immovable world", *name)
              : same_place    ? fmt::format("all copies are called \"{}\"", *name)
                              : fmt::format("line {1} already has the name \"{0}\"", *name, first.line),
              same_place && first.line > 0 ? fmt::format("name = \"{}{{i}}\"", *name) : "");
  return {};
}

Scene read_scene(std::string_view text, const std::string& name) {
  auto mistakes = std::make_shared<Mistakes>(name, text);
  Scene scene;
  scene.file = name;
  try {
    if (const std::optional<Span> deep = find_deep_key(text))
      mistakes->add(*deep, fmt::format("a key has more than {} parts", most_parts_of_key),
                    "`cdot-run list --keys` shows all keys of a scene");
    else read_all(toml::parse(text, name), *mistakes, scene);
  } catch (const toml::parse_error& error) {
    mistakes->add(span_of(error.source()), syntax_error(error.description()));
  }
  scene.source = mistakes;
  if (mistakes->none()) find_starts(scene, *mistakes);
  if (!mistakes->none()) throw SceneError(mistakes->report(), mistakes->count());
  return scene;
}

namespace {

namespace fs = std::filesystem;

// Folders of scenes that go by their names, the scenes' own first.
std::vector<fs::path> scene_folders() {
  const fs::path scenes = fs::path("specs") / "scenes", installed = command_line::installed(scenes);
  std::vector<fs::path> folders;
  for (const fs::path& of : {scenes, installed})
    if (!of.empty()) folders.insert(folders.end(), {of, of / "spatial", of / "gallery"});
  return folders;
}

std::string content_of(std::istream& stream, const std::string& name) {
  std::stringstream text;
  text << stream.rdbuf();  // fails for an empty file, which is no mistake here
  if (!stream) throw SceneError(fmt::format("{}: error: cannot be read\n", name), 1);
  return text.str();
}

}  // namespace

std::string file_of_scene(const std::string& scene) {
  if (fs::exists(scene)) return scene;
  std::vector<std::string> names;
  for (const fs::path& folder : scene_folders()) {
    if (const fs::path file = folder / (scene + ".toml"); fs::exists(file)) return file.string();
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, none))
      if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  const bool is_name = scene.find_first_of("/.") == scene.npos;
  const std::string fix = is_name && !names.empty() ? fmt::format("  fix: {}\n", did_you_mean(scene, names)) : "";
  throw SceneError(fmt::format("{}: error: there is no such scene\n{}", scene, fix), 1);
}

Scene read_scene(const std::string& scene) {
  if (scene == "-") return read_scene(content_of(std::cin, "<stdin>"), "<stdin>");
  const std::string path = file_of_scene(scene);
  if (fs::is_directory(path)) throw SceneError(fmt::format("{}: error: this is a folder, not a scene\n", path), 1);
  std::ifstream file(path, std::ios::binary);
  return read_scene(content_of(file, path), path);
}

}  // namespace cdot
