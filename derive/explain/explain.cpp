// The derivation from the first sentence to the last: this file is its table of contents.
#include "derive/explain/explain.hpp"

#include <utility>

#include "derive/derivation/free_coordinates.hpp"
#include "derive/explain/lecture.hpp"

namespace cdot::derive {
namespace {

std::string kind_of(const Joint& joint, const Parameter& p) {
  const std::string where = p.body < 0 ? "the world" : joint.bodies[static_cast<std::size_t>(p.body)];
  switch (p.kind) {
    case ParameterKind::point: return "a point fixed in " + where;
    case ParameterKind::vector: return "a vector fixed in " + where;
    case ParameterKind::unit: return "a direction (a vector of length 1) fixed in " + where;
    case ParameterKind::frame:
      return (joint.dimension == 2 ? "the x axis of a frame fixed in "
                                   : "the x axis of a right-handed frame fixed in ") +
             where;
    case ParameterKind::scalar: break;
  }
  return "a number";
}

void describe(const Lecture& lecture, const Parameter& p, Step& step) {
  const bool arm = p.kind == ParameterKind::point && p.body >= 0;
  const bool frame = p.kind == ParameterKind::frame;
  std::vector<Formula> formulas{leaf(p.value, frame ? p.symbol->symbol : p.name)};
  std::string words = "{} [" + text(p.unit) + "]: " + kind_of(lecture.joint, p);
  if (arm) {
    words += ", with the arm {} from the centre of mass {}";
    formulas.push_back(leaf(p.symbol));
    formulas.push_back(leaf(body_symbols(lecture.joint, p.body).x));
  }
  if (frame && !p.axes.empty()) {
    words += ", with the axes {} and {}";
    formulas.push_back(leaf(p.axes[1]));
    formulas.push_back(leaf(p.axes[2]));
  }
  if (p.default_value) {
    const bool constant = p.default_value->kind == Kind::number;
    words += constant ? "; by default {}" : "; by default {} at the start";
    formulas.push_back(lecture.notation.of(p.default_value));
  }
  step.list(words, std::move(formulas));
}

void introduce_bodies(const Joint& joint, Step& step) {
  if (joint.law && joint.law->on_joint) return step.say("The effect is on any joint, with all its rows.");
  if (joint.on_any_coordinate()) {
    step.say(joint.law->free->name + " [" + text(joint.law->free->unit) +
             "] is the coordinate of any joint. Its J and K are those of the joint; a force F on it is J' F on the "
             "bodies.");
    return;
  }
  const BodySymbols a = body_symbols(joint, 0);
  const std::string who = (joint.bodies.size() > 1 ? "bodies " : "body ") + listed(joint.bodies);
  const std::string others = joint.bodies.size() > 1 ? "; likewise the others" : "";
  const std::string rates = "their rates {} [m/s] and {} [rad/s], inverse mass {} [1/kg], ";
  if (joint.dimension == 2) {
    step.say(
        "Vectors are in world axes; × is the cross product of the plane, w × r = w perp(r), perp(r) = (-r.y, r.x).");
    step.list(
        who + "; of a: centre of mass {} [m], angle {} [rad], " + rates + "inverse inertia {} [1/(kg m^2)]" + others,
        {leaf(a.x), leaf(a.theta), leaf(a.v), leaf(a.w), leaf(a.inv_m), leaf(a.inv_I)});
    return;
  }
  step.say(
      "Vectors are in world axes. A vector r fixed in a body turns with it, d/dt r = w × r; S(r) is "
      "the matrix with S(r) u = r × u.");
  step.list(who +
                "; of a: centre of mass {} [m], rotation matrix {} (of the Euler parameters {}, a unit quaternion), " +
                rates + "inverse inertia {} [1/(kg m^2)], a symmetric tensor in world axes" + others,
            {leaf(a.x), leaf({}, "A_a"), leaf({}, "e_a"), leaf(a.v), leaf(a.w), leaf(a.inv_m), leaf(a.inv_I)});
}

void explain_rows(Lecture& lecture, const Part& part, Form form) {
  state_constraint(lecture, part);
  if (part.statements.empty()) return;
  Step& derivative = lecture.section("The time derivative");
  derivative.say("The derivative of C along the motion gives the velocity constraint.");
  differentiate(lecture, part, derivative);

  Step& velocities = lecture.section("The velocities isolated");
  velocities.say("Each term is brought into the form \"something times a velocity\".");
  isolate_velocities(lecture, part, velocities);

  Step& jacobian = lecture.section("The Jacobian by inspection");
  read_jacobian(lecture, part, jacobian);
  explain_form(lecture, part, form);

  Step& mass = lecture.section("The effective mass");
  const std::string product = "K = J M^-1 J', with each body's inv_m and inv_I on the diagonal of M^-1. ";
  mass.say(product + (lecture.joint.law
                          ? "An impulse lambda along the rows is J' lambda on the bodies and changes Cdot "
                            "by K lambda."
                          : "K lambda = -Cdot gives the impulse lambda that makes Cdot vanish, J' lambda "
                            "the impulse on the bodies."));
  multiply_mass(lecture, part, mass);

  Step& gamma = lecture.section("The acceleration level");
  gamma.say(
      "Cdot is differentiated again at constant velocities: J times the accelerations must equal gamma, minus the "
      "remaining terms.");
  differentiate_again(lecture, part, gamma);
}

void explain_coordinate(Lecture& lecture, const Part& part, const Coordinate& coordinate, Form form) {
  Step& step = lecture.section("Coordinate " + coordinate.name);
  step.say("Left free by the joint [" + text(coordinate.unit) + "]; motors, limits, springs and friction act on it: `" +
           coordinate.text + "`");
  const Statement& s = part.statements[0];
  step.show({label("C", s, s.C), {{lecture.notation.definition(s.C), ""}}});
  differentiate(lecture, part, step);
  isolate_velocities(lecture, part, step);
  read_jacobian(lecture, part, step);
  show_form(lecture, part, form, step);
  multiply_mass(lecture, part, step);
  differentiate_again(lecture, part, step);
}

}  // namespace

void Step::say(std::string text, std::vector<Formula> formulas) {
  items.push_back({Item::Kind::paragraph, {std::move(text), std::move(formulas)}, {}});
}

void Step::list(std::string text, std::vector<Formula> formulas) {
  items.push_back({Item::Kind::bullet, {std::move(text), std::move(formulas)}, {}});
}

void Step::show(Chain chain) { items.push_back({Item::Kind::chain, {}, std::move(chain)}); }

void introduce(Lecture& lecture) {
  const Joint& joint = lecture.joint;
  lecture.out.title = joint.name;
  lecture.out.bodies = joint.bodies;
  Step& step = lecture.section("The joint");
  if (!joint.title.empty()) step.say(joint.title);
  if (!joint.source.empty()) step.say("Source: " + joint.source);
  if (!joint.includes.empty()) {
    const std::string word = joint.includes.size() > 1 ? "joints " : "joint ";
    step.say("Composed of the " + word + listed(joint.includes) + ".");
  }
  introduce_bodies(joint, step);
  for (const Parameter& p : joint.parameters) describe(lecture, p, step);
  for (const Coordinate& c : joint.dropped) {
    step.say("The coordinate " + c.name + " that the included joint " + c.from + " leaves free (`" + c.text +
             "`) is constrained here: " + constraint_text(c) + ".");
  }
}

Explanation explain(const Derivation& derivation, Form form) {
  const Joint& joint = derivation.joint;
  Lecture lecture(derivation);
  const Part rows = rows_part(lecture, derivation.rows);
  std::vector<Part> coordinates;
  for (const Block& block : derivation.coordinates) coordinates.push_back(coordinate_part(lecture, block));
  introduce(lecture);
  explain_rows(lecture, rows, form);
  std::vector<const Part*> all{&rows};
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    explain_coordinate(lecture, coordinates[i], joint.coordinates[i], form);
    all.push_back(&coordinates[i]);
  }
  explain_law(lecture);
  state_limits(lecture, all);
  introduce_shared(lecture);
  return std::move(lecture.out);
}

}  // namespace cdot::derive
