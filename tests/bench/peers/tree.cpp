// The spanning tree, from the world outwards, so loops close at their far end.
#include "tests/bench/peers/tree.hpp"

#include <algorithm>

namespace cdot::peers {
namespace {

const State& state(const Problem& problem, int body) {
  static const State still;
  return body == world ? still : problem.bodies[std::size_t(body)].start;
}

void check_closed(const Problem& problem, const Joint& joint) {
  if (joint.kind == JointKind::mount) return;
  if (joint.kind == JointKind::orientation) throw CannotSay("no joint that keeps an orientation alone");
  double reach = 0;
  for (const int body : {joint.a, joint.b})
    if (body != world) reach += norm(local_point(problem, body, body == joint.a ? joint.anchor : joint.anchor_b));
  if (norm(joint.anchor_b - joint.anchor) > 1e-9 * (1 + reach))
    throw CannotSay("the joints of its trees cannot start open");
}

double angle_at_start(const Problem& problem, const Joint& joint) {
  if (problem.planar) return angle(state(problem, joint.b).q) - angle(state(problem, joint.a).q);
  if (angle_between(state(problem, joint.a).q, state(problem, joint.b).q) > 1e-9)
    throw CannotSay("the adapter counts angles in the plane only");
  return 0;
}

Vec3 velocity_at(const State& s, const Vec3& point) { return s.v + cross(s.w, point - s.x); }

}  // namespace

namespace {

Tree spanning(const Problem& problem) {
  Tree tree;
  std::vector<bool> reached(problem.bodies.size(), false), used(problem.joints.size(), false);
  const auto grow = [&](int parent) {
    for (int k = 0; k < int(problem.joints.size()); ++k) {
      const Joint& joint = problem.joints[std::size_t(k)];
      if ((joint.a != parent && joint.b != parent) || only_closes(joint)) continue;
      const int child = joint.a == parent ? joint.b : joint.a;
      if (child == world || reached[std::size_t(child)]) continue;
      reached[std::size_t(child)] = used[std::size_t(k)] = true;
      tree.branches.push_back({child, parent, k});
    }
  };
  std::size_t grown = 0;
  const auto grow_all = [&] {
    for (; grown < tree.branches.size(); ++grown) grow(tree.branches[grown].body);
  };
  for (std::size_t k = 0; k < reached.size(); ++k) {
    if (problem.bodies[k].moves) continue;
    reached[k] = true;
    tree.branches.push_back({int(k), world, -1});
  }
  grow(world);
  grow_all();
  for (std::size_t k = 0; k < reached.size(); ++k) {
    if (reached[k]) continue;
    reached[k] = true;
    tree.branches.push_back({int(k), world, -1});
    grow_all();
  }
  for (std::size_t k = 0; k < used.size(); ++k)
    if (!used[k]) tree.loops.push_back(int(k));
  return tree;
}

}  // namespace

bool only_closes(const Joint& joint) {
  return joint.kind == JointKind::distance || joint.kind == JointKind::max_distance ||
         joint.kind == JointKind::pulley || joint.kind == JointKind::contact;
}

Tree tree_of(const Problem& problem) {
  Tree tree = spanning(problem);
  for (const Branch& branch : tree.branches)
    if (branch.joint >= 0) check_closed(problem, problem.joints[std::size_t(branch.joint)]);
  for (const int loop : tree.loops) {
    const Joint& joint = problem.joints[std::size_t(loop)];
    if (joint.motor || joint.servo || joint.mount || joint.stops || joint.spring || joint.soft || !joint.brakes.empty())
      throw CannotSay("no motors, brakes, stops or springs of a joint that closes a loop");
  }
  return tree;
}

void close_tree(Problem& problem) {
  for (const Branch& branch : spanning(problem).branches) {
    if (branch.joint < 0) continue;
    const Joint& joint = problem.joints[std::size_t(branch.joint)];
    const Vec3 by = sense(problem, branch) * (joint.anchor - joint.anchor_b);
    State& start = problem.bodies[std::size_t(branch.body)].start;
    start.x = start.x + by;
    for (Joint& other : problem.joints) {
      if (other.a == branch.body) other.anchor = other.anchor + by;
      if (other.b == branch.body) other.anchor_b = other.anchor_b + by;
    }
  }
}

const Branch& hinge_between(const Problem& problem, const Tree& tree, int a, int b) {
  for (const Branch& branch : tree.branches) {
    if (branch.joint < 0 || problem.joints[std::size_t(branch.joint)].kind != JointKind::revolute) continue;
    if ((branch.body == a && branch.parent == b) || (branch.body == b && branch.parent == a)) return branch;
  }
  throw CannotSay("keeps the orientation only of bodies that a hinge connects");
}

double sense(const Problem& problem, const Branch& branch) {
  return problem.joints[std::size_t(branch.joint)].b == branch.body ? 1 : -1;
}

Servo servo_from_start(const Problem& problem, const Branch& branch) {
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  Servo servo = *joint.servo;
  servo.target = sense(problem, branch) * (servo.target - angle_at_start(problem, joint));
  return servo;
}

Stops stops_from_start(const Problem& problem, const Branch& branch) {
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  const double start = angle_at_start(problem, joint);
  const double lower = joint.stops->lower - start, upper = joint.stops->upper - start;
  return sense(problem, branch) > 0 ? Stops{lower, upper} : Stops{-upper, -lower};
}

double rate(const Problem& problem, const Branch& branch) {
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  const State &parent = state(problem, branch.parent), &child = state(problem, branch.body);
  const Vec3 along = (1 / norm(joint.axis)) * joint.axis;
  const Vec3 apart = velocity_at(child, joint.anchor_b) - velocity_at(parent, joint.anchor);
  if (joint.kind == JointKind::mount && norm(apart) + norm(child.w - parent.w) > 0)
    throw CannotSay("the adapter starts mounts at rest only");
  if (joint.kind == JointKind::revolute) return dot(child.w - parent.w, along);
  return dot(apart, along);
}

std::vector<Turn> turns_of(const Problem& problem, const Branch& branch, bool free_first) {
  std::vector<Turn> turns = turns_of(problem.joints[std::size_t(branch.joint)], free_first);
  if (sense(problem, branch) > 0) return turns;
  std::reverse(turns.begin(), turns.end());
  for (Turn& turn : turns) turn.axis = -1.0 * turn.axis;
  return turns;
}

Vec3 spin(const Problem& problem, const Branch& branch) {
  return state(problem, branch.body).w - state(problem, branch.parent).w;
}

}  // namespace cdot::peers
