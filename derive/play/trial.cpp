#include "derive/play/trial.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <vector>

#include <cdot/joints.hpp>
#include <cdot/world.hpp>

#include "runtime/own/own.hpp"

namespace cdot::play {
namespace {

// The type of a spec. An effect without bodies has no dimension: the plane is enough to try it.
struct Tried {
  JointType type;
  bool in_space;
};
Tried type_of(const std::string& spec) {
  const OwnType own = add_own_type(spec);
  if (own.name.empty()) throw Error(own.problems);
  if (!own.has_bodies) return {*find_coordinate_effect(own.name), false};
  for (const Dimension dimension : {Dimension::planar, Dimension::spatial})
    if (const JointType* const type = find_joint_type(dimension, own.name))
      return {*type, dimension == Dimension::spatial};
  throw Error("there is no joint `" + own.name + "`");
}

// Within its range, and not at an end of it.
double usual_value(const ParameterInfo& info) {
  if (info.name == "lower") return -0.5;
  if (std::isfinite(info.above) && std::isfinite(info.below)) return (info.above + info.below) / 2;
  return std::isfinite(info.above) ? std::max(info.above, 0.0) + 1 : std::min(info.below, 2.0) - 1;
}

// Points and directions of later parameters differ from those before: no two coincide, and second directions lie across
// the first.
std::string value_of(const ParameterInfo& info, int directions_before, bool in_space) {
  const double turn = 0.1 * info.offset / info.size;
  if (info.kind == ParameterKind::scalar) return fmt::format("{}", usual_value(info));
  if (info.kind == ParameterKind::point)
    return in_space ? fmt::format("[0.3, {:.2g}, 0.1]", turn) : fmt::format("[0.3, {:.2g}]", turn);
  const bool first = directions_before % 2 == 0;
  if (!in_space) return first ? fmt::format("[1, {:.2g}]", turn) : fmt::format("[{:.2g}, 1]", turn);
  return first ? fmt::format("[0.3, {:.2g}, 1]", turn - 0.2) : fmt::format("[1, {:.2g}, 0.3]", turn);
}

std::string parameters_of(const JointType& type, bool in_space) {
  std::string text;
  int directions = 0;
  for (const ParameterInfo& info : type.parameters) {
    if (info.has_default) continue;
    text += fmt::format("{} = {}\n", info.name, value_of(info, directions, in_space));
    directions += info.kind == ParameterKind::unit || info.kind == ParameterKind::frame;
  }
  return text;
}

// Three bodies lie on no line.
std::string body_text(int index, bool in_space) {
  return fmt::format(
      "[[body]]\nname     = \"body{0}\"\nmass     = 1\nshape    = {{ {1} }}\nposition = [{2:.2g}, {3:.2g}{4}]\n\n",
      index, in_space ? "box = [0.6, 0.2, 0.1]" : "rod = 0.6", 0.8 * index, 0.1 * index * index, in_space ? ", 0" : "");
}

// { speed = 1, most = 1 }: the parameters without a default on a coordinate, and a speed, so that a drive moves; else
// the first. One number alone stands for itself.
std::string on_coordinate(const JointType& type) {
  std::string numbers, last;
  int required = 0, given = 0;
  for (std::size_t k = 0; k < type.parameters.size(); ++k) {
    const ParameterInfo& info = type.parameters[k];
    const bool needed = type.coordinate_uses[k] == CoordinateUse::required;
    if (!needed && info.name != "speed") continue;
    last = fmt::format("{}", usual_value(info));
    numbers += fmt::format("{}{} = {}", numbers.empty() ? "" : ", ", info.name, last);
    ++given, required += needed;
  }
  const auto first = std::ranges::find(type.coordinate_uses, CoordinateUse::by_default);
  if (given == 0 && first != type.coordinate_uses.end()) {
    const ParameterInfo& info = type.parameters[static_cast<std::size_t>(first - type.coordinate_uses.begin())];
    numbers = fmt::format("{} = {}", info.name, usual_value(info));
  }
  return given == 1 && required == 1 ? last : "{ " + numbers + " }";
}

}  // namespace

std::string trial_scene(const std::string& spec) {
  const auto [type, in_space] = type_of(spec);
  const std::string name = std::filesystem::path(spec).stem().string();
  // Gravity is inclined, for what slides on level rails.
  std::string text = fmt::format("title    = \"{}\"\n{}duration = 10\nproject  = true\n\n", name,
                                 in_space ? "dimension = 3\ngravity  = [3, 0, -9.81]\n" : "gravity  = [3, -9.81]\n");
  if (type.bodies == 0) {
    const bool turns = type.acts_on_joint() || type.acts_on("rad");
    const char* const of = type.acts_on_joint() ? "" : turns ? "angle." : "slide.";
    return text + body_text(1, false) +
           fmt::format("[[joint]]\ntype   = \"{}\"\nbodies = [\"world\", \"body1\"]\nat     = [0.5, 0.1]\n{}{} = {}\n",
                       turns ? "revolute" : "prismatic", of, name, on_coordinate(type));
  }
  // One stands still, as specs see it: in the plane b, whose curve a follows; in space a.
  std::vector<std::string> bodies;
  for (int k = 1; k < std::max(type.bodies, 2); ++k) {
    text += body_text(k, in_space);
    bodies.push_back(fmt::format("\"body{}\"", k));
  }
  if (type.bodies > 1) bodies.insert(in_space ? bodies.begin() : bodies.begin() + 1, "\"world\"");
  return text + fmt::format("[[joint]]\ntype   = \"{}\"\nbodies = [{}]\n{}", name, fmt::join(bodies, ", "),
                            parameters_of(type, in_space));
}

}  // namespace cdot::play
