// The spanning tree, nearest to the world first, so that loops close at their far end.
#include "tests/bench/peers/tree.hpp"

#include <algorithm>

namespace cdot::peers {
namespace {

const State& state(const Problem& problem, int body) {
  static const State still;
  return body == world ? still : problem.bodies[std::size_t(body)].start;
}

void check_closed(const Problem& problem, const Joint& joint) {
  if (joint.kind == JointKind::distance || joint.kind == JointKind::max_distance)
    throw CannotSay("no joint that keeps a distance");
  double reach = 0;
  for (const int body : {joint.a, joint.b})
    if (body != world) reach += norm(local_point(problem, body, body == joint.a ? joint.anchor : joint.anchor_b));
  if (norm(joint.anchor_b - joint.anchor) > 1e-9 * (1 + reach))
    throw CannotSay("the joints of its trees cannot start open");
}

Vec3 velocity_at(const State& s, const Vec3& point) { return s.v + cross(s.w, point - s.x); }

}  // namespace

Tree tree_of(const Problem& problem) {
  Tree tree;
  std::vector<bool> reached(problem.bodies.size(), false), used(problem.joints.size(), false);
  const auto grow = [&](int parent) {
    for (int k = 0; k < int(problem.joints.size()); ++k) {
      const Joint& joint = problem.joints[std::size_t(k)];
      if (joint.a != parent && joint.b != parent) continue;
      const int child = joint.a == parent ? joint.b : joint.a;
      if (child == world || reached[std::size_t(child)]) continue;
      check_closed(problem, joint);
      reached[std::size_t(child)] = used[std::size_t(k)] = true;
      tree.branches.push_back({child, parent, k});
    }
  };
  std::size_t grown = 0;
  const auto grow_all = [&] {
    for (; grown < tree.branches.size(); ++grown) grow(tree.branches[grown].body);
  };
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

double rate(const Problem& problem, const Branch& branch) {
  const Joint& joint = problem.joints[std::size_t(branch.joint)];
  const State &parent = state(problem, branch.parent), &child = state(problem, branch.body);
  if (joint.kind == JointKind::revolute) return dot(child.w - parent.w, joint.axis);
  return dot(velocity_at(child, joint.anchor_b) - velocity_at(parent, joint.anchor), joint.axis);
}

Vec3 spin(const Problem& problem, const Branch& branch) {
  return state(problem, branch.body).w - state(problem, branch.parent).w;
}

}  // namespace cdot::peers
