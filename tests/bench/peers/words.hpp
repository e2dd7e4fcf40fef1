// Optional features of a problem that an adapter may not support.
#pragma once

#include <algorithm>

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

struct Lacks {
  bool held_orientations = false, motors = false, stops = false, springs = false, soft_joints = false, sleep = false,
       two_axes = false, brakes = false, servos = false, mounts = false, contacts = false;
};

// Throws CannotSay.
inline void check(const Problem& problem, const Lacks& lacks) {
  const auto refuse = [](bool asked, bool lacking, const char* what) {
    if (asked && lacking) throw CannotSay(what);
  };
  refuse(problem.sleep_after > 0, lacks.sleep, "nothing sleeps in it");
  for (const Body& body : problem.bodies) refuse(!body.turns, lacks.held_orientations, "no body that cannot turn");
  for (const Joint& joint : problem.joints) {
    refuse(joint.axis_b.has_value(), lacks.two_axes, "takes one axis for both bodies");
    refuse(joint.kind == JointKind::contact, lacks.contacts, "the adapter knows no contact");
    refuse(joint.motor.has_value(), lacks.motors, "no motor that has a speed and a greatest torque");
    refuse(!joint.brakes.empty(), lacks.brakes, "no dry friction in a joint");
    refuse(joint.servo.has_value(), lacks.servos, "no servo that has a greatest torque");
    refuse(joint.mount.has_value(), lacks.mounts, "no springs with a stiffness for each axis");
    refuse(joint.stops.has_value(), lacks.stops, "no stops of a hinge");
    refuse(joint.spring.has_value(), lacks.springs, "no spring or damper of a joint");
    refuse(joint.soft.has_value(), lacks.soft_joints, "no joint that gives like a spring");
  }
}

// The radius of a ball about the point of a body that touches a plane. The plane is lower by as much.
constexpr double tip = 1e-4;  // [m]

// The speed of a motor in a step of h from this time.
inline double speed_of(const Motor& motor, double time) { return motor.speed_at ? motor.speed_at(time) : motor.speed; }

// An engine's motor as a servo: the rate after a step of h by its spring and damper, taken implicitly and stiff enough
// that inertia does not matter.
inline double speed_of(const Servo& servo, double angle, double h) {
  return (servo.target - angle) / (h + servo.damping / servo.stiffness);
}

// Thrown if an engine has no joint of that kind.
inline CannotSay no_such(const Joint& joint) {
  return CannotSay(joint.kind == JointKind::pulley         ? "no rope over wheels"
                   : joint.kind == JointKind::max_distance ? "no string"
                                                           : "no joint that keeps a distance");
}

// With six-degree joints every way runs with both orders of rotations.
template <class Way>
std::vector<Way> with_free_turns_first(const Problem& problem, std::vector<Way> ways) {
  if (std::none_of(problem.joints.begin(), problem.joints.end(),
                   [](const Joint& joint) { return joint.kind == JointKind::six_dof; }))
    return ways;
  const std::vector<Way> as_given = ways;
  for (Way way : as_given) {
    way.free_first = true;
    way.name += ", the free turn first";
    way.changed += way.changed.empty() ? "the free turn first" : ", the free turn first";
    ways.push_back(way);
  }
  return ways;
}

}  // namespace cdot::peers
