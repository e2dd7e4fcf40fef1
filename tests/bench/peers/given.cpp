// Properties of joints that the scene has and the World does not report: springs, motors, stops, effects of specs.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include <cdot/effects.hpp>

#include "runtime/tool/scene/scene.hpp"
#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/problem.hpp"

namespace cdot::peers {
namespace {

Spring spring_of(const SceneJoint& source, const Softness& softness) {
  if (softness.by_frequency) throw CannotSay(source.name + ": no adapter knows a spring by its frequency");
  return {softness.stiffness, softness.damping};
}

// The length of a direction in the scene; the World normalises it.
double given_length(const SceneJoint& source) {
  for (const NamedValue& value : source.definition.parameters)
    if (value.name == "t" || value.name == "fa")
      return std::hypot(value.numbers[0], value.numbers[1], value.numbers.size() > 2 ? value.numbers[2] : 0);
  return 1;
}

bool locks(const CoordinateEffects& effects) {
  return effects.limit && effects.limit->lower.value_or(-1) == 0 && effects.limit->upper.value_or(1) == 0;
}

// Cardan angles depend on their order and differ from twists, except if at most one rotation is free; only that case is
// supported.
void take_turns(const SceneJoint& source, Joint& joint) {
  static const std::map<std::string_view, std::size_t> places{
      {"bend_a", 0}, {"bend_b", 1}, {"twist_x", 0}, {"twist_y", 1}, {"twist_z", 2}};
  int held_slides = 0;
  std::ptrdiff_t held_turns = 0;
  for (const CoordinateEffects& effects : source.effects) {
    const bool slides = effects.coordinate.starts_with("slide"), drives = joint.kind == JointKind::universal;
    if (effects.friction || !effects.springs.empty() || (effects.motor && !drives) ||
        (effects.limit && !locks(effects)))
      throw CannotSay(source.name + ": adapters hold the turns of a joint or drive those of a universal one, no more");
    held_slides += slides;
    if (slides) continue;
    Turn& turn = joint.turns.at(places.at(effects.coordinate));
    turn.held = effects.limit.has_value();
    held_turns += turn.held;
    if (effects.motor) turn.motor = {effects.motor->speed, effects.motor->max_force};
  }
  if (joint.kind == JointKind::six_dof && (held_slides != 3 || held_turns == 1))
    throw CannotSay(source.name + ": adapters know joints of six degrees without slides and with one turn, or all");
}

// Many engines know stops at both ends only: a missing one is so far away that nothing here meets it, and within a
// turn.
Stops stops_of(const Limit& limit) {
  constexpr double far = 3;  // [rad]
  return {limit.lower.value_or(limit.upper.value_or(far) - far),
          limit.upper.value_or(limit.lower.value_or(-far) + far)};
}

double number(const SpecEffect& effect, std::string_view name, double otherwise = 0) {
  const auto found = std::ranges::find(effect.parameters, name, &NamedValue::name);
  return found == effect.parameters.end() ? otherwise : found->numbers.at(0);
}

// An effect of a spec that engines have too.
void take_spec(const SceneJoint& source, const SpecEffect& effect, Joint& joint) {
  const auto in_time = std::ranges::any_of(effect.parameters, [](const NamedValue& n) { return !n.in_time.empty(); });
  if (effect.type == "brake") {
    joint.brakes.push_back(number(effect, "torque"));
  } else if (effect.type == "servo" || effect.type == "position_drive") {
    const bool smooth = effect.type == "servo";
    joint.servo = {number(effect, "target"), number(effect, "k"), smooth ? 0 : number(effect, "d"),
                   number(effect, "most"), smooth};
    if (smooth && number(effect, "d") > 0) joint.spring = Spring{0, number(effect, "d")};  // which knows no limit
  } else if (effect.type == "conveyor") {
    joint.motor = {number(effect, "speed"), number(effect, "most")};
  } else if (effect.type == "motor" && in_time) {
    const auto speed = std::ranges::find(effect.parameters, "speed", &NamedValue::name);
    const Profile profile = speed->in_time.at(0).profile;
    joint.motor = {0, number(effect, "max", unlimited), [profile](double time) { return profile.at(time).value; }};
  } else if (effect.type != "dc_motor") {
    throw CannotSay(fmt::format("{}: no adapter knows {}", source.name, effect.type));
  }
}

// Motors of direct current between the world and a body are a constant torque and a damper, together.
void take_dc_motors(const CoordinateEffects& effects, Problem& problem, Joint& joint) {
  double stall = 0, damping = 0;
  for (const SpecEffect& effect : effects.specs)
    if (effect.type == "dc_motor")
      stall += number(effect, "stall"), damping += number(effect, "stall") / number(effect, "idle");
  if (damping == 0) return;
  if (joint.a != world || joint.spring) throw CannotSay("no adapter knows this motor of direct current");
  Vec3& torque = problem.bodies[std::size_t(joint.b)].torque;
  torque = torque + stall * joint.axis;
  joint.spring = Spring{0, damping};
}

}  // namespace

void take_given(const SceneJoint& source, Problem& problem, Joint& joint) {
  joint.axis = given_length(source) * joint.axis;
  if (source.definition.soft) joint.soft = spring_of(source, *source.definition.soft);
  if (!joint.turns.empty()) return take_turns(source, joint);
  for (const CoordinateEffects& effects : source.effects) {
    const bool turns = joint.kind == JointKind::revolute;
    if (effects.friction || effects.load || (!turns && effects.limit) || effects.springs.size() > 1)
      throw CannotSay(source.name + ": no adapter knows friction, loads, two springs at once, or stops of a slider");
    for (const SpecEffect& effect : effects.specs) take_spec(source, effect, joint);
    if (effects.motor) joint.motor = {effects.motor->speed, effects.motor->max_force};
    if (effects.limit) joint.stops = stops_of(*effects.limit);
    for (const CoordinateSpring& spring : effects.springs) joint.spring = spring_of(source, spring.softness);
    take_dc_motors(effects, problem, joint);
  }
}

}  // namespace cdot::peers
