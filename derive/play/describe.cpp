#include "derive/play/describe.hpp"

#include <cdot/methods.hpp>

namespace cdot::play {
namespace {

using nlohmann::json;

constexpr const char* shape_names[] = {"none", "rod", "box", "disc", "ball"};
constexpr const char* kind_names[] = {"point", "vector", "unit", "frame", "scalar"};

json body_json(const SceneBody& body) {
  const Shape& shape = body.shape;
  return {
      {"name", body.name},
      {"static", body.is_static},
      {"traces", body.traces},
      {"shape",
       {{"kind", shape_names[shape.kind]}, {"length", shape.length}, {"width", shape.width}, {"depth", shape.depth}}}};
}

// The motors of a joint, with their numbers among its effects.
json motors_of(const SceneJoint& joint) {
  json motors = json::array();
  int number = 0;
  for (const CoordinateEffects& effects : joint.effects)
    effects.each([&]<class Effect>(const Effect& effect) {
      if constexpr (std::is_same_v<Effect, Motor>) {
        json motor{{"effect", number}, {"coordinate", effects.coordinate}, {"speed", effect.speed}};
        if (effect.max_force < unlimited) motor["max"] = effect.max_force;
        motors.push_back(motor);
      }
      ++number;
    });
  return motors;
}

const char* law_name(const Motor&) { return "motor"; }
const char* law_name(const Limit&) { return "limit"; }
const char* law_name(const CoordinateSpring&) { return "spring"; }
const char* law_name(const DryFriction&) { return "friction"; }
const char* law_name(const Load&) { return "load"; }
const std::string& law_name(const SpecEffect& effect) { return effect.type; }

// The specs in specs/coordinate, or own ones, behind the effects on its coordinates.
json laws_of(const SceneJoint& joint) {
  json laws = json::array();
  for (const CoordinateEffects& effects : joint.effects)
    effects.each([&](const auto& effect) { laws.push_back(law_name(effect)); });
  return laws;
}

template <class S>
json joint_json(const SceneJoint& joint, const BasicWorld<S>& world, int number) {
  const JointType& type = world.joint_type(number);
  const std::vector<double> numbers = world.joint_parameters(number);
  json parameters = json::array(), coordinates = json::array();
  for (const ParameterInfo& info : type.parameters)
    parameters.push_back(
        {{"name", info.name},
         {"kind", kind_names[static_cast<int>(info.kind)]},
         {"body", info.body},
         {"unit", info.unit},
         {"numbers", std::vector<double>(numbers.begin() + info.offset, numbers.begin() + info.offset + info.size)}});
  for (const CoordinateInfo& info : type.coordinates) coordinates.push_back({{"name", info.name}, {"unit", info.unit}});
  return {{"name", joint.name},
          {"type", type.name},
          {"title", type.title},
          {"effect", type.is_effect},
          {"bodies", joint.definition.bodies},
          {"parameters", parameters},
          {"coordinates", coordinates},
          {"motors", motors_of(joint)},
          {"laws", laws_of(joint)}};
}

json spring_json(const SpringDefinition& s) {
  return {{"bodies", {s.body_a, s.body_b}}, {"from", {s.ax, s.ay, s.az}}, {"to", {s.bx, s.by, s.bz}}};
}

}  // namespace

std::vector<double> numbers_of(const planar::Place& place) { return {place.x, place.y, place.angle}; }
std::vector<double> numbers_of(const spatial::Place& p) { return {p.x, p.y, p.z, p.e0, p.e1, p.e2, p.e3}; }

template <class S>
json description_of(const Scene& scene, const BasicWorld<S>& world) {
  json d{{"title", scene.title},
         {"dimension", S::dimension == Dimension::planar ? 2 : 3},
         {"gravity", {scene.settings.gravity_x, scene.settings.gravity_y, scene.settings.gravity_z}},
         {"bodies", json::array()},
         {"joints", json::array()},
         {"springs", json::array()},
         {"sensors", json::array()},
         {"methods", names_of(integrators)}};
  for (const SceneBody& body : scene.bodies) d["bodies"].push_back(body_json(body));
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    d["joints"].push_back(joint_json(scene.joints[k], world, static_cast<int>(k)));
  for (const SpringDefinition& spring : scene.springs) d["springs"].push_back(spring_json(spring));
  for (const Sensor& sensor : scene.sensors)
    d["sensors"].push_back({{"name", sensor.name}, {"unit", sensor.formula.unit()}});
  return d;
}

std::string failure_text(const Scene& scene, const StepResult& result) {
  const std::string body = result.body >= 0 && result.body < std::ssize(scene.bodies)
                               ? scene.bodies[static_cast<std::size_t>(result.body)].name
                               : "";
  const std::string joint = result.joint >= 0 && result.joint < std::ssize(scene.joints)
                                ? scene.joints[static_cast<std::size_t>(result.joint)].name
                                : "the pointer";
  return in_words(result, body, joint) + ". Likely fix: " + likely_fix(result.problem, OnFailure::stop);
}

template json description_of(const Scene&, const BasicWorld<Planar<double>>&);
template json description_of(const Scene&, const BasicWorld<Spatial<double>>&);

}  // namespace cdot::play
