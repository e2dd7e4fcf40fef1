// What an adapter has words for, beside bodies that move freely and joints that hold for good.
#pragma once

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

struct Words {
  bool held_orientations = false, motors = false, stops = false, springs = false, soft_joints = false, damping = false,
       sleep = false;
};
inline constexpr Words all_words{.held_orientations = true,
                                 .motors = true,
                                 .stops = true,
                                 .springs = true,
                                 .soft_joints = true,
                                 .damping = true,
                                 .sleep = true};

// Throws CannotSay.
inline void check(const Problem& problem, const Words& known) {
  const auto need = [](bool asked, bool said, const char* what) {
    if (asked && !said) throw CannotSay(what);
  };
  need(problem.sleep_after > 0, known.sleep, "nothing sleeps in it");
  for (const Body& body : problem.bodies) {
    need(!body.turns, known.held_orientations, "no body that cannot turn");
    need(body.damping > 0, known.damping, "no damping of a body's motion against the world");
  }
  for (const Joint& joint : problem.joints) {
    need(joint.motor.has_value(), known.motors, "no motor that has a speed and a greatest torque");
    need(joint.stops.has_value(), known.stops, "no stops of a hinge");
    need(joint.spring.has_value(), known.springs, "no spring or damper of a joint");
    need(joint.soft.has_value(), known.soft_joints, "no joint that gives like a spring");
  }
}

}  // namespace cdot::peers
