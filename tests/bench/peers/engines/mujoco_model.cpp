#include "tests/bench/peers/engines/mujoco_model.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

#include "tests/bench/peers/words.hpp"

namespace cdot::peers {

std::string name_of(int body) { return body == peers::world ? "world" : fmt::format("b{}", body); }

namespace {

std::string text(const Vec3& a) { return fmt::format("{} {} {}", a[0], a[1], a[2]); }
std::string text(const Quaternion& q) { return fmt::format("{} {} {} {}", q[0], q[1], q[2], q[3]); }

std::string text(const Spring& spring) {
  return fmt::format(" stiffness='{}' damping='{}'", spring.stiffness, spring.damping);
}

// Soft slides in all directions, before the hinge.
std::string soft_text(const Problem& problem, const Branch& branch, const Spring& soft) {
  std::string out;
  for (const Vec3& axis : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
    out +=
        fmt::format("<joint type='slide' axis='{}'{}/>", text(local_direction(problem, branch.body, axis)), text(soft));
  return out;
}

// Sprung slides along its axis and across it, and a sprung ball.
std::string mount_text(const Problem& problem, const Branch& branch, const Joint& joint) {
  const auto& [along, across, twist, bend] = *joint.mount;
  if (twist != bend) throw CannotSay("no springs with a stiffness for each turn");
  const bool forth = sense(problem, branch) > 0;
  const Vec3 off = forth ? joint.anchor_b - joint.anchor : joint.anchor - joint.anchor_b;
  const std::string at = text(local_point(problem, branch.body, forth ? joint.anchor_b : joint.anchor));
  const Vec3 side =
                 norm(cross(joint.axis, {0, 0, 1})) > 0.1 ? cross({0, 0, 1}, joint.axis) : cross({0, 1, 0}, joint.axis),
             y = (1 / norm(side)) * side;
  std::string out;
  for (const auto& [axis, stiffness] : {std::pair{joint.axis, along}, {y, across}, {cross(joint.axis, y), across}})
    out += fmt::format("<joint type='slide' pos='{}' axis='{}' stiffness='{}' springref='{}'/>", at,
                       text(local_direction(problem, branch.body, axis)), stiffness, -dot(off, axis));
  return out + fmt::format("<joint type='ball' pos='{}' stiffness='{}'/>", at, bend);
}

// A series of hinges.
std::string turns_text(const Problem& problem, const Branch& branch, const std::vector<Turn>& turns) {
  std::string out;
  for (std::size_t k = 0; k < turns.size(); ++k)
    out += fmt::format("<joint name='j{}t{}' type='hinge' pos='{}' axis='{}'/>", branch.joint, k,
                       text(local_point(problem, branch.body, problem.joints[std::size_t(branch.joint)].anchor)),
                       text(local_direction(problem, branch.body, turns[k].axis)));
  return out;
}

std::string joint_text(const Problem& problem, const Branch& branch, bool free_first) {
  if (branch.joint < 0) return problem.bodies[std::size_t(branch.body)].moves ? "<freejoint/>" : "";
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  if (!joint.turns.empty()) return turns_text(problem, branch, turns_of(problem, branch, free_first));
  if (joint.kind == JointKind::fixed) return "";  // part of its parent
  if (joint.kind == JointKind::mount) return mount_text(problem, branch, joint);
  if (joint.soft && joint.kind != JointKind::revolute) throw CannotSay("the adapter makes hinges soft only");
  const char* type = joint.kind == JointKind::revolute    ? "hinge"
                     : joint.kind == JointKind::prismatic ? "slide"
                                                          : "ball";
  std::string out = joint.soft ? soft_text(problem, branch, *joint.soft) : "";
  out += fmt::format("<joint name='j{}' type='{}' pos='{}'", branch.joint, type,
                     text(local_point(problem, branch.body, joint.anchor)));
  if (joint.kind != JointKind::spherical)
    out += fmt::format(" axis='{}'", text(local_direction(problem, branch.body, joint.axis)));
  if (joint.spring) out += text(*joint.spring);
  if (!joint.brakes.empty())
    out += fmt::format(" frictionloss='{}'", std::accumulate(joint.brakes.begin(), joint.brakes.end(), 0.0));
  if (joint.stops) {
    const Stops stops = stops_from_start(problem, branch);
    out += fmt::format(" limited='true' range='{} {}'", stops.lower, stops.upper);
  }
  return out + "/>";
}

double rope_at_start(const Joint& joint) {
  if (joint.kind != JointKind::pulley) return norm(joint.anchor_b - joint.anchor);
  return norm(joint.anchor - joint.wheel) + joint.ratio * norm(joint.anchor_b - joint.wheel_b);
}

// The balls of contacts on a body, and their planes in the world.
std::string balls_text(const Problem& problem, int body) {
  std::string out;
  for (const Joint& joint : problem.joints) {
    if (joint.kind != JointKind::contact) continue;
    const std::string rough = fmt::format("condim='3' friction='{} 0 0'", joint.friction);
    if (joint.a == body)
      out += fmt::format("<geom type='sphere' size='{}' pos='{}' {}/>", tip,
                         text(local_point(problem, body, joint.anchor)), rough);
    if (body == world)
      out += fmt::format("<geom type='plane' size='0 0 1' pos='{}' zaxis='{}' {}/>",
                         text(joint.anchor_b - tip * joint.axis), text(joint.axis), rough);
  }
  return out;
}

// The ends and wheels of ropes on a body or in the world.
std::string sites_text(const Problem& problem, int body) {
  std::string out;
  const auto add = [&](char side, std::size_t joint, const Vec3& at) {
    out += fmt::format("<site name='{}{}' pos='{}'/>", side, joint, text(local_point(problem, body, at)));
  };
  for (std::size_t k = 0; k < problem.joints.size(); ++k) {
    const Joint& joint = problem.joints[k];
    if (!only_closes(joint) || joint.kind == JointKind::contact) continue;
    if (joint.a == body) add('a', k, joint.anchor);
    if (joint.b == body) add('b', k, joint.anchor_b);
    if (joint.kind != JointKind::pulley || body != world) continue;
    add('v', k, joint.wheel);
    add('w', k, joint.wheel_b);
  }
  return out;
}

std::string ropes_text(const Problem& problem) {
  std::string out;
  for (std::size_t k = 0; k < problem.joints.size(); ++k) {
    const Joint& joint = problem.joints[k];
    if (!only_closes(joint) || joint.kind == JointKind::contact) continue;
    out += fmt::format("<spatial name='r{}'", k);
    if (joint.kind == JointKind::max_distance) out += fmt::format(" limited='true' range='0 {}'", joint.length);
    out += fmt::format("><site site='a{}'/>", k);
    if (joint.kind == JointKind::pulley)
      out += fmt::format("<site site='v{0}'/><pulley divisor='{1}'/><site site='w{0}'/>", k, 1 / joint.ratio);
    out += fmt::format("<site site='b{}'/></spatial>", k);
  }
  return out;
}

// Equality constraints of locked hinges.
std::string holds_text(const Problem& problem, const Tree& tree, bool free_first) {
  std::string out;
  for (const Branch& branch : tree.branches) {
    if (branch.joint < 0) continue;
    const std::vector<Turn> turns = turns_of(problem, branch, free_first);
    for (std::size_t k = 0; k < turns.size(); ++k)
      if (turns[k].held) out += fmt::format("<joint joint1='j{}t{}' polycoef='0 0 0 0 0'/>", branch.joint, k);
  }
  return out;
}

std::string drive_text(const std::string& joint, double most) {
  std::string out = fmt::format("<general biastype='affine' joint='{}'", joint);
  if (std::isfinite(most)) out += fmt::format(" forcelimited='true' forcerange='{} {}'", -most, most);
  return out + "/>";
}
std::string drives_text(const Problem& problem, const Tree& tree, bool free_first, std::vector<Drive>& drives) {
  std::string out;
  const auto add = [&](const std::string& joint, double most, const Drive& drive) {
    out += drive_text(joint, most);
    drives.push_back(drive);
  };
  for (const Branch& branch : tree.branches) {
    if (branch.joint < 0) continue;
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const std::vector<Turn> turns = turns_of(problem, branch, free_first);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      if (turns[k].motor) add(fmt::format("j{}t{}", branch.joint, k), turns[k].motor->most, {1, *turns[k].motor});
    }
    const std::string name = fmt::format("j{}", branch.joint);
    if (joint.motor) add(name, joint.motor->most, {sense(problem, branch), *joint.motor});
    if (joint.servo) add(name, joint.servo->most, {1, {}, servo_from_start(problem, branch)});
  }
  return out;
}

std::string loop_text(const Problem& problem, const Tree& tree, const Joint& joint) {
  const std::size_t k = std::size_t(&joint - problem.joints.data());
  if (joint.kind == JointKind::max_distance) return "";  // its tendon's limit
  if (joint.kind == JointKind::contact) return "";
  if (only_closes(joint))
    return fmt::format("<tendon tendon1='r{}' polycoef='{} 1 0 0 0'/>", k, joint.length - rope_at_start(joint));
  if (joint.kind == JointKind::orientation)
    return fmt::format("<joint joint1='j{}' polycoef='0 0 0 0 0'/>",
                       hinge_between(problem, tree, joint.a, joint.b).joint);
  return fmt::format("<connect body1='{}' body2='{}' anchor='{}'/>", name_of(joint.a), name_of(joint.b),
                     text(local_point(problem, joint.a, joint.anchor)));
}

std::string body_text(const Problem& problem, const Tree& tree, const Branch& branch, bool free_first) {
  const Body& body = problem.bodies[std::size_t(branch.body)];
  Quaternion q = body.start.q;
  if (branch.parent != world) q = conjugate(problem.bodies[std::size_t(branch.parent)].start.q) * q;
  std::string out = fmt::format(
      "<body name='b{}' pos='{}' quat='{}'><inertial pos='0 0 0' mass='{}' diaginertia='{}'/>{}{}\n", branch.body,
      text(local_point(problem, branch.parent, body.start.x)), text(q), body.mass, text(body.inertia),
      joint_text(problem, branch, free_first), sites_text(problem, branch.body) + balls_text(problem, branch.body));
  for (const Branch& child : tree.branches)
    if (child.parent == branch.body) out += body_text(problem, tree, child, free_first);
  return out + "</body>\n";
}

}  // namespace

std::string model_text(const Problem& problem, const Tree& tree, bool free_first, std::vector<Drive>& drives) {
  std::string out =
      fmt::format("<mujoco><compiler inertiafromgeom='false' angle='radian'/><option gravity='{}'/><worldbody>",
                  text(problem.gravity));
  for (const Branch& branch : tree.branches)
    if (branch.parent == world) out += body_text(problem, tree, branch, free_first);
  out += sites_text(problem, world) + balls_text(problem, world) + "</worldbody><tendon>" + ropes_text(problem) +
         "</tendon><equality>";
  for (const int loop : tree.loops) out += loop_text(problem, tree, problem.joints[std::size_t(loop)]);
  out += holds_text(problem, tree, free_first) + "</equality><actuator>";
  return out + drives_text(problem, tree, free_first, drives) + "</actuator></mujoco>";
}

}  // namespace cdot::peers
