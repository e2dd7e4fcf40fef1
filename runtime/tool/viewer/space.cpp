// A scene in space -> its drawing.
#include "runtime/tool/viewer/space.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "runtime/tool/viewer/picture.hpp"

namespace cdot {
namespace {

constexpr int sides_of_a_disc = 24;
constexpr int floor_lines = 10;

struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(const Vec3& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  double size() const { return std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]}); }
};

double reach(const Shape& shape) { return std::hypot(shape.length, shape.width, shape.depth) / 2; }

// Holds the bodies of all frames, except those further away than ten times the size of the start.
Box box_of(const Scene& scene, const std::vector<Frame>& film) {
  Box start;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const BodyState& b = film.front().bodies[k];
    const double r = std::max(reach(scene.bodies[k].shape), 1e-3);
    start.add({b.x - r, b.y - r, b.z - r});
    start.add({b.x + r, b.y + r, b.z + r});
  }
  Box box = start;
  const double most = 10 * start.size();
  for (const Frame& frame : film)
    for (const BodyState& b : frame.bodies) {
      const Vec3 p = {b.x, b.y, b.z};
      bool near = true;
      for (std::size_t k = 0; k < 3; ++k) near = near && p[k] > start.low[k] - most && p[k] < start.high[k] + most;
      if (near) box.add(p);
    }
  return box;
}

std::vector<SpaceFace> box_faces(double x, double y, double z) {
  const auto corner = [&](int i) { return Vec3{(i & 1 ? x : -x) / 2, (i & 2 ? y : -y) / 2, (i & 4 ? z : -z) / 2}; };
  std::vector<SpaceFace> faces;
  for (const auto& face : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                           std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}})
    faces.push_back({corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3])});
  return faces;
}

std::vector<SpaceFace> disc_faces(double radius, double height) {
  const auto at = [&](int k, double z) {
    const double angle = 2 * std::numbers::pi * k / sides_of_a_disc;
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), z};
  };
  std::vector<SpaceFace> faces;
  SpaceFace top, bottom;
  for (int k = 0; k < sides_of_a_disc; ++k) {
    top.push_back(at(k, height / 2));
    bottom.push_back(at(-k, -height / 2));
    faces.push_back({at(k, -height / 2), at(k + 1, -height / 2), at(k + 1, height / 2), at(k, height / 2)});
  }
  faces.push_back(top);
  faces.push_back(bottom);
  return faces;
}

class SpacePainter {
 public:
  SpacePainter(const Scene& scene, double size)
      : scene_(scene), size_(size), world_(build_world_in<Spatial<double>>(scene)) {}

  SpaceDrawing draw() {
    for (int joint = 0; joint < static_cast<int>(scene_.joints.size()); ++joint) draw_joint(joint);
    for (const SpringDefinition& spring : scene_.springs)
      drawing_.links.push_back({{spring.body_a, {spring.ax, spring.ay, spring.az}},
                                {spring.body_b, {spring.bx, spring.by, spring.bz}},
                                "spring"});
    for (std::size_t k = 0; k < scene_.bodies.size(); ++k) drawing_.bodies.push_back(body(k));
    each_trace(scene_, [&](int body, const Vec3& p) {
      drawing_.traces.push_back({{body, p}, kind(static_cast<std::size_t>(body))});
    });
    return drawing_;
  }

 private:
  std::string kind(std::size_t body) const {
    return scene_.bodies[body].is_static ? "still" : fmt::format("c{}", body % 8);
  }

  // The faces of its shape, or a ball; and lines to joints outside of it.
  SpaceBody body(std::size_t k) const {
    const Shape& shape = scene_.bodies[k].shape;
    SpaceBody look;
    look.kind = kind(k);
    switch (shape.kind) {
      case Shape::rod: look.faces = box_faces(shape.length, shape.width, shape.width); break;
      case Shape::box: look.faces = box_faces(shape.length, shape.width, shape.depth); break;
      case Shape::disc:
        look.faces = disc_faces(shape.length / 2, shape.depth);
        look.lines = {{Vec3{0, 0, shape.depth / 2}, Vec3{shape.length / 2, 0, shape.depth / 2}}};
        break;
      case Shape::ball:
        look.ball = shape.length / 2;
        look.lines = {{Vec3{}, Vec3{shape.length / 2, 0, 0}}};
        break;
      case Shape::none: look.ball = 0.02 * size_; break;
    }
    for (const SpacePoint& point : drawing_.pins) {
      const Vec3& p = point.local;
      if (point.body == static_cast<int>(k) && std::hypot(p[0], p[1], p[2]) > reach(shape))
        look.lines.push_back({Vec3{}, p});
    }
    return look;
  }

  // Its points as pins with a link between them; its axis as a short shaft.
  void draw_joint(int joint) {
    const std::vector<double> numbers = world_.joint_parameters(joint);
    const SceneJoint& source = scene_.joints[static_cast<std::size_t>(joint)];
    const JointType& type = world_.joint_type(joint);
    std::vector<SpacePoint> points;
    for (const ParameterInfo& info : type.parameters) {
      if (info.kind != ParameterKind::point) continue;
      const double* at = numbers.data() + info.offset;
      points.push_back({body_of(source, info.body), {at[0], at[1], at[2]}});
    }
    drawing_.pins.insert(drawing_.pins.end(), points.begin(), points.end());
    const bool rope = !type.row_kinds.empty() && type.row_kinds[0] == RowKind::inequality;
    if (points.size() == 2)
      drawing_.links.push_back({points[0], points[1], source.definition.soft ? "spring" : rope ? "rope" : "rigid"});
    for (const ParameterInfo& info : type.parameters) {
      const bool direction = info.kind == ParameterKind::frame || info.kind == ParameterKind::unit;
      if (!direction || points.empty() || body_of(source, info.body) != points[0].body) continue;
      const double* n = numbers.data() + info.offset;
      SpacePoint from = points[0], to = points[0];
      for (std::size_t k = 0; k < 3; ++k) {
        from.local[k] -= 0.04 * size_ * n[k];
        to.local[k] += 0.04 * size_ * n[k];
      }
      drawing_.links.push_back({from, to, "rigid"});
      break;
    }
  }

  static int body_of(const SceneJoint& joint, int body) {
    return body < 0 ? world_body : joint.definition.bodies[static_cast<std::size_t>(body)];
  }

  const Scene& scene_;
  double size_;
  SpatialWorld<double> world_;
  SpaceDrawing drawing_;
};

// A square grid below the mechanism.
std::vector<SpaceLine> floor_of(const Box& box) {
  const double half = 0.75 * box.size(), z = box.low[2];
  const double x = (box.low[0] + box.high[0]) / 2, y = (box.low[1] + box.high[1]) / 2;
  std::vector<SpaceLine> lines;
  for (int k = 0; k <= floor_lines; ++k) {
    const double at = half * (2.0 * k / floor_lines - 1);
    lines.push_back({Vec3{x + at, y - half, z}, Vec3{x + at, y + half, z}});
    lines.push_back({Vec3{x - half, y + at, z}, Vec3{x + half, y + at, z}});
  }
  return lines;
}

}  // namespace

SpaceDrawing draw_in_space(const Scene& scene, const std::vector<Frame>& film) {
  const Box box = box_of(scene, film);
  SpaceDrawing drawing = SpacePainter(scene, box.size()).draw();
  drawing.centre = {(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2, (box.low[2] + box.high[2]) / 2};
  drawing.radius = std::max(0.65 * box.size(), 1e-9);
  drawing.floor = floor_of(box);
  return drawing;
}

}  // namespace cdot
