// A planar scene -> its drawing. The look of a joint follows from its points, directions, rows and coordinates, not
// from its name: coincident points are a pin, others a rod, a rope or a spring; a free slide is a rail.
#include "runtime/tool/viewer/marks.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

#include "runtime/text/html.hpp"

namespace cdot {

namespace {

constexpr double coincident = 1.5;    // picture units below which two points are one
constexpr double rail_overhang = 30;  // beyond the used length of a rail
constexpr double degrees_per_radian = 180 / std::numbers::pi;
constexpr const char* rigid_link = R"(<line class="rigid" x2="1"/>)";
constexpr const char* rope_link = R"(<line class="rope" x2="1"/>)";
constexpr const char* gear_link = R"(<line class="gear" x2="1"/>)";
constexpr const char* spring_link =
    R"(<polyline class="spring" points="0,0 .2,0 .25,-9 .4,9 .5,-9 .6,9 .75,-9 .8,0 1,0"/>)";
constexpr const char* ground_mark = R"(<path class="ground" d="M0 0L-11 17H11ZM-17 17H17"/>)";

// Bodies whose names differ only in their last digits share a colour: the links of a chain.
class Colours {
 public:
  int of(std::string name) {
    while (!name.empty() && name.back() >= '0' && name.back() <= '9') name.pop_back();
    return families_.emplace(name, static_cast<int>(families_.size()) % 8).first->second;
  }

 private:
  std::map<std::string, int> families_;
};

// The body (a, b, … of the spec) that carries the joint's direction, and so its rail; -1: no direction.
int carries_direction(const JointType& type) {
  for (const ParameterInfo& info : type.parameters) {
    if (info.kind == ParameterKind::unit || info.kind == ParameterKind::frame) return info.body;
  }
  return -1;
}

struct JointPoint {
  Anchor anchor;
  Vec2 at;  // in the picture at the start
  bool in_world_frame;
};

class Painter {
 public:
  Painter(const Scene& scene, const std::vector<Frame>& film, Drawing& drawing)
      : scene_(scene),
        film_(film),
        drawing_(drawing),
        world_(build_world<double>(scene)),
        start_(places_of(drawing.view, film.front())) {}

  void joints() {
    for (int joint = 0; joint < static_cast<int>(scene_.joints.size()); ++joint) {
      const JointType& type = world_.joint_type(joint);
      const std::vector<JointPoint> all = points(joint);
      for (const JointPoint& point : all) {
        if (point.anchor.body != world_body) joint_points_[point.anchor.body].push_back(point.anchor.local);
      }
      bool slides = false;
      for (const CoordinateInfo& coordinate : type.coordinates) {
        if (coordinate.unit != "m" || carries_direction(type) < 0 || all.size() != 2) continue;
        slides = true;
        const bool first_carries = carries_direction(type) == 0;
        rail(joint, coordinate, all[first_carries ? 0 : 1], all[first_carries ? 1 : 0]);
      }
      const bool pair = all.size() == 2;
      const double apart = pair ? std::hypot(all[0].at[0] - all[1].at[0], all[0].at[1] - all[1].at[1]) : 0;
      if (pair && (slides || apart < coincident)) {
        pin(all[0], all[1], !slides, !slides && type.row_kinds.size() == 3 && !type.explicit_time);
      } else if (!all.empty()) {
        between_points(joint, all);
      } else if (type.bodies >= 2) {
        const std::vector<int>& bodies = scene_.joints[static_cast<std::size_t>(joint)].definition.bodies;
        if (!is_still(bodies[0]) && !is_still(bodies[1]))
          drawing_.links.push_back({{bodies[0], {}}, {bodies[1], {}}, gear_link});
      }
    }
  }

  void springs() {
    for (const SpringDefinition& spring : scene_.springs) {
      const Anchor from = anchor(spring.body_a, spring.ax, spring.ay), to = anchor(spring.body_b, spring.bx, spring.by);
      link({from, position(from, start_), false}, {to, position(to, start_), false}, spring_link);
    }
  }

  void bodies() {
    for (std::size_t k = 0; k < scene_.bodies.size(); ++k) {
      const SceneBody& body = scene_.bodies[k];
      const std::string kind = body.is_static ? "still" : fmt::format("c{}", colours_.of(body.name));
      drawing_.bodies.push_back({static_cast<int>(k), fmt::format(R"(<g class="body {}"><title>{}</title>{}</g>)", kind,
                                                                  text::html_escaped(body.name), body_svg(k))});
    }
  }

  void traces() {
    each_trace(scene_, [&](int body, const Vec3& p) {
      drawing_.traces.push_back(
          {anchor(body, p[0], p[1]), colours_.of(scene_.bodies[static_cast<std::size_t>(body)].name)});
    });
  }

 private:
  Anchor anchor(int body, double x, double y) const {
    const double s = drawing_.view.scale;
    if (body == world_body) return {body, {s * (x - drawing_.view.left), s * (drawing_.view.top - y)}};
    return {body, {s * x, -s * y}};
  }

  bool is_still(int body) const {
    return body == world_body || scene_.bodies[static_cast<std::size_t>(body)].is_static;
  }

  std::vector<JointPoint> points(int joint) const {
    const std::vector<double> numbers = world_.joint_parameters(joint);
    const SceneJoint& source = scene_.joints[static_cast<std::size_t>(joint)];
    std::vector<JointPoint> result;
    for (const ParameterInfo& info : world_.joint_type(joint).parameters) {
      if (info.kind != ParameterKind::point) continue;
      const int body = info.body < 0 ? world_body : source.definition.bodies[static_cast<std::size_t>(info.body)];
      const auto at = static_cast<std::size_t>(info.offset);
      const Anchor place = anchor(body, numbers[at], numbers[at + 1]);
      result.push_back({place, position(place, start_), info.body < 0});
    }
    return result;
  }

  void mark_ground(const JointPoint& point) {
    drawing_.pins.push_back({world_body, fmt::format(R"svg(<g transform="translate({:.2f} {:.2f})">{}</g>)svg",
                                                     point.at[0], point.at[1], ground_mark)});
  }

  void pin(const JointPoint& p, const JointPoint& q, bool grounded, bool welded) {
    const JointPoint& moving = is_still(p.anchor.body) ? q : p;
    if (grounded && (is_still(p.anchor.body) || is_still(q.anchor.body))) mark_ground(moving);
    const Vec2 at = moving.anchor.local;
    const char* svg = welded ? R"svg(<rect class="pin" x="{0:.2f}" y="{1:.2f}" width="9" height="9" )svg"
                               R"svg(transform="translate(-4.5 -4.5)"/>)svg"
                             : R"(<circle class="pin" cx="{0:.2f}" cy="{1:.2f}" r="5"/>)";
    drawing_.pins.push_back({moving.anchor.body, fmt::format(fmt::runtime(svg), at[0], at[1])});
  }

  void link(const JointPoint& p, const JointPoint& q, const char* svg) {
    drawing_.links.push_back({p.anchor, q.anchor, svg});
    for (const JointPoint* end : {&p, &q}) {
      if (end->anchor.body == world_body) mark_ground(*end);
    }
  }

  // The direction in the picture, in degrees, in which moving `body` increases the coordinate [m], by differences.
  double slide_direction(int joint, const CoordinateInfo& coordinate, int body) {
    const planar::Place pose = world_.place(body);
    const double step = 1e-3 / drawing_.view.scale, before = world_.coordinate(joint, coordinate.name);
    world_.set_pose(body, {pose.x + step, pose.y, pose.angle});
    const double along_x = world_.coordinate(joint, coordinate.name) - before;
    world_.set_pose(body, {pose.x, pose.y + step, pose.angle});
    const double along_y = world_.coordinate(joint, coordinate.name) - before;
    world_.set_pose(body, {pose.x, pose.y, pose.angle});
    return std::atan2(-along_y, along_x) * degrees_per_radian;
  }

  // A line on the body of `base` through its point, over the path of `rider` in the film.
  void rail(int joint, const CoordinateInfo& coordinate, const JointPoint& base, const JointPoint& rider) {
    if (is_still(rider.anchor.body)) return;
    const auto turned_by = [&](const std::vector<Place>& places) {
      return base.anchor.body == world_body ? 0 : places[static_cast<std::size_t>(base.anchor.body)].degrees;
    };
    const double degrees = slide_direction(joint, coordinate, rider.anchor.body) - turned_by(start_);
    double least = 0, most = 0;
    for (const Frame& frame : film_) {
      const std::vector<Place> places = places_of(drawing_.view, frame);
      const Vec2 from = position(base.anchor, places), to = position(rider.anchor, places);
      const double angle = (degrees + turned_by(places)) / degrees_per_radian;
      const double along = std::cos(angle) * (to[0] - from[0]) + std::sin(angle) * (to[1] - from[1]);
      least = std::min(least, along);
      most = std::max(most, along);
    }
    drawing_.bodies.push_back(
        {base.anchor.body, fmt::format(R"svg(<line class="rail" x1="{:.0f}" x2="{:.0f}" )svg"
                                       R"svg(transform="translate({:.2f} {:.2f}) rotate({:.2f})"/>)svg",
                                       least - rail_overhang, most + rail_overhang, base.anchor.local[0],
                                       base.anchor.local[1], degrees)});
  }

  // Links two points. Two points of bodies with two points of the world hang on a rope over those.
  void between_points(int joint, const std::vector<JointPoint>& all) {
    const JointType& type = world_.joint_type(joint);
    const bool soft = scene_.joints[static_cast<std::size_t>(joint)].definition.soft.has_value();
    const bool loose = !type.row_kinds.empty() && type.row_kinds[0] == RowKind::inequality;
    const char* svg = soft ? spring_link : loose ? rope_link : rigid_link;
    std::vector<JointPoint> fixed, riding;
    for (const JointPoint& point : all) (point.in_world_frame ? fixed : riding).push_back(point);
    if (fixed.size() == 2 && riding.size() == 2) {
      drawing_.links.push_back({riding[0].anchor, fixed[0].anchor, rope_link});
      drawing_.links.push_back({fixed[0].anchor, fixed[1].anchor, rope_link});
      drawing_.links.push_back({riding[1].anchor, fixed[1].anchor, rope_link});
      for (const JointPoint& wheel : fixed) {
        drawing_.pins.push_back({world_body, fmt::format(R"(<circle class="pin" cx="{:.2f}" cy="{:.2f}" r="9"/>)",
                                                         wheel.at[0], wheel.at[1])});
      }
    } else if (all.size() == 2) {
      link(all[0], all[1], svg);
    }
  }

  std::string body_svg(std::size_t body) const {
    const Shape& shape = scene_.bodies[body].shape;
    const double length = drawing_.view.scale * shape.length;
    const double width = std::clamp(drawing_.view.scale * shape.width, 3.0, 1e6);
    switch (shape.kind) {
      case Shape::rod: {
        const double bar = std::clamp(width, 5.0, 26.0);
        return fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" rx="{:.2f}"/>)",
                           -length / 2 - bar / 2, -bar / 2, length + bar, bar, bar / 2);
      }
      case Shape::box:
        return fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" rx="2"/>)", -length / 2,
                           -width / 2, length, width);
      case Shape::disc: return fmt::format(R"(<circle r="{0:.2f}"/><line x2="{0:.2f}"/>)", std::max(length / 2, 3.0));
      case Shape::ball:
      case Shape::none: break;
    }
    std::string svg;
    const auto found = joint_points_.find(static_cast<int>(body));
    if (found != joint_points_.end()) {
      for (const Vec2& p : found->second) svg += fmt::format(R"(<line x2="{:.2f}" y2="{:.2f}"/>)", p[0], p[1]);
    }
    return svg + R"(<circle r="9"/>)";
  }

  const Scene& scene_;
  const std::vector<Frame>& film_;
  Drawing& drawing_;
  World<double> world_;
  std::vector<Place> start_;
  Colours colours_;
  std::map<int, std::vector<Vec2>> joint_points_;  // of each body, for bodies without a shape
};

}  // namespace

Drawing draw(const Scene& scene, const std::vector<Frame>& film) {
  Drawing drawing;
  drawing.view = view_of(scene, film);
  Painter painter(scene, film, drawing);
  painter.joints();
  painter.springs();
  painter.bodies();
  painter.traces();
  return drawing;
}

}  // namespace cdot
