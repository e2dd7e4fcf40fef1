// A film -> the view that shows all of it; poses -> places in that view.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "runtime/tool/viewer/marks.hpp"

namespace cdot {
namespace {

constexpr double picture_size = 1000, margin = 60;

struct Bounds {
  double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
  void add(double x, double y, double radius) {
    left = std::min(left, x - radius), right = std::max(right, x + radius);
    bottom = std::min(bottom, y - radius), top = std::max(top, y + radius);
  }
  double size() const { return std::max(right - left, top - bottom); }
};

Bounds bounds_of(const Scene& scene, const Frame& frame) {
  Bounds bounds;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Shape& shape = scene.bodies[k].shape;
    const double radius = shape.kind == Shape::rod   ? shape.length / 2
                          : shape.kind == Shape::box ? std::hypot(shape.length, shape.width) / 2
                                                     : shape.length / 2;
    bounds.add(frame.bodies[k].x, frame.bodies[k].y, radius);
  }
  return bounds;
}

// Adds the points of joints and springs that are fixed in the world.
void add_world_points(const Scene& scene, Bounds& bounds) {
  for (const SceneJoint& joint : scene.joints) {
    const JointType* type = find_joint_type(Dimension::planar, joint.definition.type);
    for (const NamedValue& value : joint.definition.parameters) {
      for (const ParameterInfo& info : type->parameters) {
        const bool in_world =
            info.body < 0 || joint.definition.bodies[static_cast<std::size_t>(info.body)] == world_body;
        if (info.name == value.name && info.kind == ParameterKind::point && in_world) {
          bounds.add(value.numbers[0], value.numbers[1], 0);
        }
      }
    }
  }
  for (const SpringDefinition& spring : scene.springs) {
    if (spring.body_a == world_body) bounds.add(spring.ax, spring.ay, 0);
    if (spring.body_b == world_body) bounds.add(spring.bx, spring.by, 0);
  }
}

}  // namespace

// The bounds of all frames, limited to ten times the size of the start on each side.
View view_of(const Scene& scene, const std::vector<Frame>& film) {
  Bounds start = bounds_of(scene, film.front());
  add_world_points(scene, start);
  const double reach = 10 * std::max(start.size(), 1e-9);
  Bounds bounds = start;
  for (const Frame& frame : film) {
    const Bounds now = bounds_of(scene, frame);
    bounds.add(std::max(now.left, start.left - reach), std::max(now.bottom, start.bottom - reach), 0);
    bounds.add(std::min(now.right, start.right + reach), std::min(now.top, start.top + reach), 0);
  }
  View view;
  view.scale = picture_size / std::max(bounds.size(), 1e-9);
  view.left = bounds.left - margin / view.scale;
  view.top = bounds.top + margin / view.scale;
  view.width = (bounds.right - bounds.left) * view.scale + 2 * margin;
  view.height = (bounds.top - bounds.bottom) * view.scale + 2 * margin;
  return view;
}

Place place_of(const View& view, const BodyState& state) {
  return {view.scale * (state.x - view.left), view.scale * (view.top - state.y), -state.angle * 180 / std::numbers::pi};
}

std::vector<Place> places_of(const View& view, const Frame& frame) {
  std::vector<Place> places;
  for (const BodyState& state : frame.bodies) places.push_back(place_of(view, state));
  return places;
}

std::string transform(const Place& place) {
  return fmt::format("translate({:.2f} {:.2f}) rotate({:.2f})", place.x, place.y, place.degrees);
}

Vec2 position(const Anchor& anchor, const std::vector<Place>& places) {
  if (anchor.body == world_body) return anchor.local;
  const Place& place = places[static_cast<std::size_t>(anchor.body)];
  const double angle = place.degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  return {place.x + c * anchor.local[0] - s * anchor.local[1], place.y + s * anchor.local[0] + c * anchor.local[1]};
}

std::string link_transform(const Link& link, const std::vector<Place>& places) {
  const Vec2 from = position(link.from, places), to = position(link.to, places);
  const double dx = to[0] - from[0], dy = to[1] - from[1];
  const Place place{from[0], from[1], std::atan2(dy, dx) * 180 / std::numbers::pi};
  return fmt::format("{} scale({:.3f} 1)", transform(place), std::hypot(dx, dy));
}

}  // namespace cdot
