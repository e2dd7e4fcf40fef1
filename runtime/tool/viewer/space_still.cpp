// A drawing in space -> the still: projected through its camera, painted from back to front. space.js does the same in
// the page with a camera that orbits.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/rotation.hpp>

#include "runtime/tool/viewer/picture.hpp"
#include "runtime/tool/viewer/space.hpp"

namespace cdot {
namespace {

// X right, Y down, depth away from the eye, and pixels per metre at that depth.
struct Seen {
  double x, y, depth, scale;
};

class Projection {
 public:
  explicit Projection(const SpaceDrawing& drawing)
      : drawing_(drawing),
        c_(std::cos(drawing.camera.yaw)),
        s_(std::sin(drawing.camera.yaw)),
        cp_(std::cos(drawing.camera.pitch)),
        sp_(std::sin(drawing.camera.pitch)) {}

  Seen operator()(const Vec3& p) const {
    const SpaceDrawing& d = drawing_;
    const double u = p[0] - d.centre[0], v = p[1] - d.centre[1], w = p[2] - d.centre[2];
    const double right = c_ * u + s_ * v, into = -s_ * u + c_ * v;
    const double up = cp_ * w + sp_ * into, depth = cp_ * into - sp_ * w;
    const double scale =
        d.camera.zoom * 0.42 * std::min(d.width, d.height) / d.radius / (1 + 0.2 * std::max(-4.0, depth / d.radius));
    return {d.width / 2 + scale * right, d.height / 2 - scale * up, depth, scale};
  }

 private:
  const SpaceDrawing& drawing_;
  double c_, s_, cp_, sp_;
};

Vec3 placed(const Frame& frame, const SpacePoint& p) {
  if (p.body == world_body) return p.local;
  const BodyState& b = frame.bodies[static_cast<std::size_t>(p.body)];
  const auto pose = spatial::oriented(b.x, b.y, b.z, b.e0, b.e1, b.e2, b.e3);
  const auto r = to_world(pose, spatial::Vector<double>{p.local[0], p.local[1], p.local[2]});
  return {b.x + r.x, b.y + r.y, b.z + r.z};
}

std::string circle(const Seen& p, double r) {
  return fmt::format("M{0:.1f} {1:.1f}a{2:.1f} {2:.1f} 0 1 0 {3:.1f} 0a{2:.1f} {2:.1f} 0 1 0 {4:.1f} 0Z", p.x - r, p.y,
                     r, 2 * r, -2 * r);
}

double mean_depth(const std::vector<Seen>& points) {
  double sum = 0;
  for (const Seen& p : points) sum += p.depth;
  return sum / static_cast<double>(points.size());
}

struct Item {
  double depth;
  std::string path, kind;
  double opacity = 0;  // of its fill
};

class Still {
 public:
  Still(const SpaceDrawing& drawing, const Frame& frame) : drawing_(drawing), frame_(frame), project_(drawing) {}

  std::string svg(bool with_still) {
    for (std::size_t k = 0; k < drawing_.bodies.size(); ++k)
      if (with_still || drawing_.bodies[k].kind != "still") add_body(static_cast<int>(k));
    for (const SpaceLink& link : drawing_.links) add_line(link.from, link.to, link.kind);
    for (const SpacePoint& pin : drawing_.pins) {
      const Seen at = project_(placed(frame_, pin));
      items_.push_back({at.depth - 1e-3 * drawing_.radius, circle(at, 5), "pin", 1});
    }
    std::stable_sort(items_.begin(), items_.end(), [](const Item& p, const Item& q) { return p.depth > q.depth; });
    std::string svg;
    for (const Item& item : items_)
      svg += fmt::format("<path class=\"body {}\" style=\"fill-opacity:{:.2f}\" d=\"{}\"/>\n", item.kind, item.opacity,
                         item.path);
    return svg;
  }

 private:
  void add_body(int body) {
    const SpaceBody& look = drawing_.bodies[static_cast<std::size_t>(body)];
    for (const SpaceFace& face : look.faces) add_face(body, face, look.kind);
    if (look.ball > 0) {
      const Seen at = project_(placed(frame_, {body, {}}));
      items_.push_back({at.depth, circle(at, std::max(3.0, at.scale * look.ball)), look.kind, 0.45});
    }
    for (const SpaceLine& line : look.lines) add_line({body, line[0]}, {body, line[1]}, look.kind + " line");
  }

  // Only faces towards the eye are drawn, brighter the more they face it.
  void add_face(int body, const SpaceFace& face, const std::string& kind) {
    std::vector<Seen> seen;
    for (const Vec3& corner : face) seen.push_back(project_(placed(frame_, {body, corner})));
    double area = 0, size = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const Seen &p = seen[k], &q = seen[(k + 1) % seen.size()];
      area += p.x * q.y - p.y * q.x;
      size += std::hypot(q.x - p.x, q.y - p.y);
    }
    if (area >= 0) return;
    const double shade = std::min(1.0, -area / (size * size) * 8);
    items_.push_back({mean_depth(seen), path_through(seen) + "Z", kind, 0.25 + 0.5 * shade});
  }

  void add_line(const SpacePoint& from, const SpacePoint& to, const std::string& kind) {
    const std::vector<Seen> seen = {project_(placed(frame_, from)), project_(placed(frame_, to))};
    items_.push_back({mean_depth(seen), path_through(seen), kind});
  }

  const SpaceDrawing& drawing_;
  const Frame& frame_;
  Projection project_;
  std::vector<Item> items_;
};

}  // namespace

std::string space_background(const SpaceDrawing& drawing, const std::vector<Frame>& film) {
  const Projection project(drawing);
  std::string floor;
  for (const SpaceLine& line : drawing.floor) floor += path_through(std::array{project(line[0]), project(line[1])});
  std::string svg = fmt::format("<path class=\"floor\" d=\"{}\"/>\n", floor);
  for (const SpaceTrace& trace : drawing.traces)
    svg += trace_svg(trace.colour, film, [&](const Frame& frame) { return project(placed(frame, trace.point)); });
  return svg;
}

std::string space_snapshot(const SpaceDrawing& drawing, const Frame& frame, bool with_still) {
  return Still(drawing, frame).svg(with_still);
}

}  // namespace cdot
