// Bodies, shapes and joints -> connected groups and the boxes around them.
#include "runtime/tool/scene/extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "runtime/tool/scene/read.hpp"

namespace cdot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Box {
  Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

  void add(const Vec3& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  double diagonal() const {
    return low[0] > high[0] ? 0 : std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  }
};

// Union-find over the bodies of a scene.
class Groups {
 public:
  explicit Groups(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int body) {
    int& parent = parent_[static_cast<std::size_t>(body)];
    if (parent != body) parent = of(parent);
    return parent;
  }
  void join(int a, int b) { parent_[static_cast<std::size_t>(of(a))] = of(b); }

 private:
  std::vector<int> parent_;
};

// A point of a body, in its frame.
struct Mark {
  int body;
  Vec3 point;
};

Vec3 three(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers.size() > 2 ? numbers[2] : 0}; }

// The bodies of a joint or a spring, and its points.
struct Link {
  std::vector<int> bodies;
  std::vector<Mark> marks;
};

Link link_of(const SceneJoint& joint, Dimension dimension) {
  Link link{joint.definition.bodies, {}};
  for (const ParameterInfo& parameter : find_joint_type(dimension, joint.definition.type)->parameters) {
    if (parameter.kind != ParameterKind::point) continue;
    for (const NamedValue& given : joint.definition.parameters)
      if (given.name == parameter.name)
        link.marks.push_back({parameter.body < 0 ? world_body : link.bodies[static_cast<std::size_t>(parameter.body)],
                              three(given.numbers)});
  }
  return link;
}

Link link_of(const SpringDefinition& spring) {
  return {{spring.body_a, spring.body_b},
          {{spring.body_a, {spring.ax, spring.ay, spring.az}}, {spring.body_b, {spring.bx, spring.by, spring.bz}}}};
}

bool movable(const Scene& scene, int body) {
  return body != world_body && !scene.bodies[static_cast<std::size_t>(body)].is_static;
}

// The first movable body; world_body if there is none.
int anchor_of(const Scene& scene, const Link& link) {
  const auto found =
      std::find_if(link.bodies.begin(), link.bodies.end(), [&](int body) { return movable(scene, body); });
  return found == link.bodies.end() ? world_body : *found;
}

std::vector<Link> links_of(const Scene& scene) {
  std::vector<Link> links;
  for (const SceneJoint& joint : scene.joints) links.push_back(link_of(joint, scene.dimension));
  for (const SpringDefinition& spring : scene.springs) links.push_back(link_of(spring));
  return links;
}

}  // namespace

Extents extents_of(const Scene& scene) {
  const std::vector<Link> links = links_of(scene);
  Groups groups(scene.bodies.size());
  for (const Link& link : links)
    for (const int body : link.bodies)
      if (movable(scene, body)) groups.join(body, anchor_of(scene, link));

  const BodyNames frames(scene);
  std::vector<Box> boxes(scene.bodies.size());
  const auto add = [&](int body, const Mark& mark) {
    boxes[static_cast<std::size_t>(groups.of(body))].add(frames.to_world(mark.body, mark.point));
  };
  Extents extents;
  std::vector<int> members(scene.bodies.size());
  for (int body = 0; body < std::ssize(scene.bodies); ++body) {
    if (!movable(scene, body)) continue;
    extents.mechanisms += groups.of(body) == body;
    ++members[static_cast<std::size_t>(groups.of(body))];
    const Shape& shape = scene.bodies[static_cast<std::size_t>(body)].shape;
    for (const double side : {-0.5, 0.0, 0.5})
      add(body, {body, {side * shape.length, side * shape.width, side * shape.depth}});
  }
  for (const Link& link : links)
    if (const int anchor = anchor_of(scene, link); anchor != world_body)
      for (const Mark& mark : link.marks) add(anchor, mark);
  for (int body = 0; body < std::ssize(scene.bodies); ++body) {
    const auto group = static_cast<std::size_t>(groups.of(body));
    extents.of_body.push_back(boxes[group].diagonal());
    extents.bodies.push_back(members[group]);
  }
  return extents;
}

}  // namespace cdot
