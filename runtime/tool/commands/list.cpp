// `cdot-run list`: the joints and effects with their parameters and coordinates, or the keys of a scene.
#include <algorithm>
#include <fmt/format.h>

#include <cdot/effects.hpp>
#include <cdot/joints.hpp>

#include "runtime/rows/parameters.hpp"
#include "runtime/text/json.hpp"
#include "runtime/text/spelling.hpp"
#include "runtime/tool/commands/options.hpp"
#include "runtime/tool/scene/keys.hpp"

namespace cdot {
namespace {

using text::Json;

constexpr const char* parameter_kinds[] = {"point", "vector", "unit", "frame", "scalar"};  // by ParameterKind
constexpr const char* row_kinds[] = {"equality", "inequality", "velocity"};                // by RowKind

const char* kind_of(const ParameterInfo& parameter) { return parameter_kinds[static_cast<int>(parameter.kind)]; }

std::string body_name(const ParameterInfo& parameter) {
  if (parameter.kind == ParameterKind::scalar) return "";
  return parameter.body < 0 ? "world" : std::string(1, static_cast<char>('a' + parameter.body));
}

// What a scene may put on a coordinate.
std::vector<std::string> effects_on(const CoordinateInfo& coordinate) {
  std::vector<std::string> effects;
  for (const EffectKind* kind : effect_kinds) effects.push_back(kind->key);
  for (const JointType& type : coordinate_effects())
    if (type.acts_on(coordinate.unit) && std::ranges::find(effects, type.name) == effects.end())
      effects.push_back(std::string(type.name));
  return effects;
}

std::string list_text(const JointType& type) {
  const char* body_or_bodies = type.bodies == 1 ? "body" : "bodies";
  const size_t rows = type.row_kinds.size();
  std::string text = type.acts_on_joint() ? fmt::format("{}  (any joint)\n", type.name)
                     : type.is_effect     ? fmt::format("{}  ({} {})\n", type.name, type.bodies, body_or_bodies)
                                      : fmt::format("{}  ({} {}, {} row{})\n", type.name, type.bodies, body_or_bodies,
                                                    rows, rows == 1 ? "" : "s");
  text += fmt::format("    \"{}\"\n", type.title);
  for (const ParameterInfo& parameter : type.parameters) {
    const std::string body = body_name(parameter);
    text += fmt::format("    {:<12} {} [{}]{}{}\n", parameter.name, kind_of(parameter), parameter.unit,
                        body.empty() ? range_of(parameter) : " on " + body, parameter.has_default ? ", optional" : "");
  }
  for (const CoordinateInfo& coordinate : type.coordinates)
    text += fmt::format("    {:<12} coordinate [{}]: {}\n", coordinate.name, coordinate.unit,
                        fmt::join(effects_on(coordinate), ", "));
  return text;
}

std::string list_text(Dimension dimension, const char* place) {
  std::string joints, effects;
  for (const JointType& type : joint_types(dimension)) (type.is_effect ? effects : joints) += list_text(type);
  return fmt::format("Joints {0}\n\n{1}\nEffects {0}\n\n{2}", place, joints, effects);
}

void add_to(Json& list, Dimension dimension) {
  for (const JointType& type : joint_types(dimension)) {
    Json joint = {{"type", type.name},
                  {"dimension", dimension == Dimension::planar ? 2 : 3},
                  {"bodies", type.bodies},
                  {"effect", type.is_effect}};
    for (const RowKind kind : type.row_kinds) joint["rows"].push_back(row_kinds[static_cast<int>(kind)]);
    joint["parameters"] = Json::array();
    for (const ParameterInfo& parameter : type.parameters) {
      joint["parameters"].push_back({{"name", parameter.name},
                                     {"kind", kind_of(parameter)},
                                     {"body", body_name(parameter)},
                                     {"unit", parameter.unit},
                                     {"has_default", parameter.has_default}});
    }
    joint["coordinates"] = Json::array();
    for (const CoordinateInfo& coordinate : type.coordinates) {
      joint["coordinates"].push_back(
          {{"name", coordinate.name}, {"unit", coordinate.unit}, {"effects", effects_on(coordinate)}});
    }
    list.push_back(joint);
  }
}

std::string list_of_effects_on_joints() {
  std::string text = "Effects on a joint itself\n\n";
  for (const JointType& type : coordinate_effects())
    if (type.acts_on_joint()) text += list_text(type);
  return text;
}

std::string list_text() {
  return list_text(Dimension::planar, "in the plane (dimension = 2)") + "\n" +
         list_text(Dimension::spatial, "in space (dimension = 3)") + "\n" + list_of_effects_on_joints();
}

std::string list_text(const std::string& name) {
  std::string text;
  std::vector<std::string> names;
  const auto add = [&](std::span<const JointType> types, const char* place) {
    for (const JointType& type : types) {
      names.emplace_back(type.name);
      if (type.name == name) text += fmt::format("{}{}:\n{}", text.empty() ? "" : "\n", place, list_text(type));
    }
  };
  add(joint_types(Dimension::planar), "In the plane");
  add(joint_types(Dimension::spatial), "In space");
  if (text.empty()) add(coordinate_effects(), "On a coordinate or a joint");
  if (text.empty())
    throw Error(fmt::format("no joint or effect has the name `{}`{}", name, text::did_you_mean(name, names)));
  return text;
}

std::string list_json() {
  Json list = Json::array();
  add_to(list, Dimension::planar);
  add_to(list, Dimension::spatial);
  return list.dump(2) + "\n";
}

std::string keys_text() {
  std::string text;
  for (const KeyTable& table : {keys_of_the_top(), keys_of_a_body(), keys_of_a_shape(), keys_of_a_joint(),
                                keys_of_effects(), keys_of_a_spring(), keys_of_a_sensor(), keys_of_copies()}) {
    text += fmt::format("{}{}\n\n", text.empty() ? "" : "\n", table.title);
    for (const auto& [name, meaning, otherwise] : table.rows) {
      const char* lead = otherwise.empty() ? "" : otherwise == "required" ? "; " : "; default: ";
      text += fmt::format("    {:<16} {}{}{}\n", name, meaning, lead, otherwise);
    }
  }
  return text;
}

struct Options {
  std::string name;
  bool json = false, keys = false;
};

void add_options(Line& line, Options& options) {
  line.add("NAME", &options.name, "only this joint or effect");
  line.add("--json", &options.json, "print JSON").excludes("NAME");
  line.add("--keys", &options.keys, "list the keys of a scene file instead").excludes("--json").excludes("NAME");
}

int run(const Options& options) {
  fmt::print("{}", options.keys            ? keys_text()
                   : options.json          ? list_json()
                   : !options.name.empty() ? list_text(options.name)
                                           : list_text());
  return well;
}

}  // namespace

Run list_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

}  // namespace cdot
