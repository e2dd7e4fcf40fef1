// The [[sensor]] entries of a scene -> formulas over what a run measures.
#include <algorithm>
#include <fmt/format.h>
#include <map>

#include "runtime/tool/scene/keys.hpp"
#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

std::string unit_of_force(std::string_view unit) { return unit == "rad" ? "N*m" : unit == "m" ? "N" : ""; }

void add_joint_to(Measurable& all, const SceneJoint& joint, int number, Dimension dimension) {
  using enum Measured::What;
  for (const CoordinateInfo& c : find_joint_type(dimension, joint.definition.type)->coordinates) {
    const std::string name(c.name), path = joint.name + "." + name, unit(c.unit);
    all.add(path, unit, {coordinate, number, name});
    all.add("rate(" + path + ")", unit + "/s", {rate, number, name});
    if (unit_of_force(unit).empty()) continue;
    all.add("force(" + path + ")", unit_of_force(unit), {effects, number, name});
    all.add("power(" + path + ")", "J/s", {power, number, name});
    const auto here = std::ranges::find(joint.effects, name, &CoordinateEffects::coordinate);
    if (here == joint.effects.end()) continue;
    for (const SpecEffect& effect : here->specs) {
      all.add("force(" + path + "." + effect.type + ")", unit_of_force(unit), {effects, number, name, effect.type});
      all.add("power(" + path + "." + effect.type + ")", "J/s", {power, number, name, effect.type});
    }
  }
  all.add("power(" + joint.name + ")", "J/s", {given, number, ""});
  all.add("force(" + joint.name + ")", "N", {force, number, ""}, true);
  all.add("torque(" + joint.name + ")", "N*m", {torque, number, ""}, dimension == Dimension::spatial);
}

struct SensorReading {
  const Measurable& all;
  std::map<std::string, Span>& used;
  Sensor sensor{};
};

void read_sensor_name(Entry& entry, const char*, SensorReading& to) {
  to.sensor.name = read_name(entry, to.used, std::nullopt).value_or("");
}

// A torque and an energy have the same units, so joules are those of a sensor that measures energy alone.
std::string usual_unit(const Sensor& sensor) {
  const std::string& unit = sensor.formula.unit();
  const auto is_energy = [](const Measured& m) { return m.what == Measured::energy || m.what == Measured::kinetic; };
  if (unit == "kg*m/s^2") return "N";
  if (unit == "kg*m^2/s^3") return "W";
  if (unit != "kg*m^2/s^2") return unit;
  return std::ranges::all_of(sensor.measured, is_energy) ? "J" : "N*m";
}

void read_value(Entry& entry, const char* key, SensorReading& to) {
  entry.required(key, "value = \"energy\"");
  const std::optional<std::string> text = entry.text(key);
  if (!text) return;
  Formula::Reading read = Formula::read(*text, to.all.words);
  for (const FormulaMistake& mistake : read.mistakes)
    entry.error(place_in(entry.where(key), *text, mistake), mistake.cause, mistake.fix);
  if (!read.formula) return;
  to.sensor.formula = std::move(*read.formula);
  for (const Formula::Input& input : to.sensor.formula.inputs())
    to.sensor.measured.push_back(
        input.of == Formula::Input::quantity ? to.all.measured[static_cast<std::size_t>(input.index)] : Measured{});
  to.sensor.unit = usual_unit(to.sensor);
}

// clang-format off
constexpr Key<SensorReading> sensor_keys[] = {
    {"name", "letters, digits, _ and -; names the CSV column", "required", read_sensor_name},
    {"value", "an expression in the language of the specs: \"power(pin.angle)\"", "required", read_value},
};
// clang-format on

}  // namespace

Measurable measurable_of(const Scene& scene) {
  Measurable all;
  all.words.dimension = scene.dimension == Dimension::planar ? 2 : 3;
  for (const SceneBody& body : scene.bodies) all.words.bodies.push_back(body.name);
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    add_joint_to(all, scene.joints[k], static_cast<int>(k), scene.dimension);
  const bool spatial = scene.dimension == Dimension::spatial;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const std::string& name = scene.bodies[k].name;
    all.add("acceleration(" + name + ")", "m/s^2", {Measured::acceleration, static_cast<int>(k)}, true);
    all.add("angular_acceleration(" + name + ")", "rad/s^2", {Measured::angular_acceleration, static_cast<int>(k)},
            spatial);
  }
  all.add("energy", "J", {Measured::energy});
  all.add("kinetic", "J", {Measured::kinetic});
  return all;
}

void read_sensors(Entry& top, Scene& scene) {
  if (!top.has("sensor")) return;
  const Measurable all = measurable_of(scene);
  std::map<std::string, Span> used{{"time", {}}};
  for (Entry& entry : top.list("sensor")) {
    SensorReading read{all, used};
    read_keys(entry, sensor_keys, scene.dimension, read);
    entry.close();
    scene.sensors.push_back(std::move(read.sensor));
  }
}

KeyTable keys_of_a_sensor() { return table_of("[[sensor]]", sensor_keys); }

}  // namespace cdot
