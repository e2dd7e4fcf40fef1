#include "derive/picture/picture.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/picture/labels.hpp"

namespace cdot::derive {

const char* const picture_style = R"(
.poses { display: flex; flex-wrap: wrap; gap: 1rem 1.5rem; }
.poses figure { margin: 0; width: 27rem; max-width: 100%; }
.poses figcaption { font-size: .92rem; }
.pose { width: 100%; height: auto; border: 1px solid var(--line); border-radius: 4px; }
.pose { --b0: #2166ac; --b1: #b8570b; --b2: #1b7837; --b3: #8e3a8e; --of-world: #55555c; --let: #b3163b; }
@media (prefers-color-scheme: dark) {
  .pose { --b0: #7db8ec; --b1: #f0a35c; --b2: #7fcf94; --b3: #d79ad7; --of-world: #a8a8b0; --let: #ff7d95; }
}
.pose path { fill: none; stroke-linejoin: round; stroke-linecap: round; }
.pose .skin { opacity: .16; }
.pose .rim { opacity: .35; stroke-width: 1.2; }
.pose .axis { stroke-width: 1.2; opacity: .8; }
.pose .arrow { stroke-width: 2; }
.pose .seen-from { stroke: var(--soft); }
.pose text { font: 13px system-ui, sans-serif; fill: var(--ink); stroke: var(--paper); stroke-width: 3px; }
.pose text { paint-order: stroke; stroke-linejoin: round; }
.pose text.small { font-size: 9px; fill: var(--soft); }
.pose text.body { font-weight: bold; }
.pose .b0 { stroke: var(--b0); } .pose text.b0, .pose circle.b0, .pose .head.b0 { fill: var(--b0); }
.pose .b1 { stroke: var(--b1); } .pose text.b1, .pose circle.b1, .pose .head.b1 { fill: var(--b1); }
.pose .b2 { stroke: var(--b2); } .pose text.b2, .pose circle.b2, .pose .head.b2 { fill: var(--b2); }
.pose .b3 { stroke: var(--b3); } .pose text.b3, .pose circle.b3, .pose .head.b3 { fill: var(--b3); }
.pose .of-world { stroke: var(--of-world); } .pose text.of-world, .pose .head.of-world { fill: var(--of-world); }
.pose .let { stroke: var(--let); } .pose text.let, .pose .head.let { fill: var(--let); }
.pose text[class] { stroke: var(--paper); }
.pose circle.point.let { fill: var(--let); } .pose circle.of-world { fill: var(--of-world); }
.pose circle.zero { fill: none; stroke-width: 1.6; }
)";

namespace {

constexpr double paper_width = 420, paper_height = 330, margin = 40;  // in pixels
// Of the extent of the mechanism.
constexpr double direction_share = 0.24, axis_share = 0.13, outline_share = 0.05;
constexpr int colours = 4;

// Turned by 30 degrees about the vertical and tilted by 25: no axis of the world hides another.
constexpr double turn_cos = 0.8660254037844386, turn_sin = 0.5;
constexpr double tilt_cos = 0.9063077870366499, tilt_sin = 0.42261826174069944;

OnPaper plus(OnPaper p, OnPaper q, double share = 1) { return {p.x + share * q.x, p.y + share * q.y}; }
double length_of(OnPaper p) { return std::hypot(p.x, p.y); }

struct Extent {
  double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL;
  void add(OnPaper p, double around = 0) {
    x0 = std::min(x0, p.x - around), y0 = std::min(y0, p.y - around);
    x1 = std::max(x1, p.x + around), y1 = std::max(y1, p.y + around);
  }
};

struct Lengths {
  double direction, axis, outline;  // [m]
};

// The corners of the convex hull, counterclockwise (Andrew's monotone chain).
std::vector<OnPaper> hull_of(std::vector<OnPaper> points) {
  std::ranges::sort(points, [](OnPaper p, OnPaper q) { return p.x != q.x ? p.x < q.x : p.y < q.y; });
  const auto left_turn = [](OnPaper p, OnPaper q, OnPaper r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
  };
  std::vector<OnPaper> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const OnPaper p : points) {
      while (hull.size() >= first + 2 && !left_turn(hull[hull.size() - 2], hull.back(), p)) hull.pop_back();
      hull.push_back(p);
    }
    if (hull.size() > 1) hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

std::string colour_of(int body) {
  if (body == of_no_body) return "let";
  return body < 0 ? "of-world" : "b" + std::to_string(body % colours);
}

// -0 and what rounds to it are 0.
std::string pixels(double x) { return fmt::format("{:.1f}", std::fabs(x) < 0.05 ? 0.0 : x); }
std::string pixels(OnPaper p) { return pixels(p.x) + " " + pixels(p.y); }

class Drawing {
 public:
  Drawing(const Marks& marks, int dimension) : marks_(marks), dimension_(dimension) {}

  // All that has a length in metres.
  Extent mechanism() const {
    Extent extent;
    for (const BodyMark& body : marks_.bodies)
      for (const Triple<double>& corner : body.corners) extent.add(on_paper(corner));
    for (const PointMark& point : marks_.points) extent.add(on_paper(point.at));
    for (const ArrowMark& arrow : marks_.arrows)
      if (!arrow.direction) extent.add(plus(on_paper(arrow.from), on_paper(arrow.along)));
    return extent;
  }

  Extent all(const Lengths& lengths) const {
    Extent extent = mechanism();
    for (const BodyMark& body : marks_.bodies) {
      for (const Triple<double>& corner : body.corners) extent.add(on_paper(corner), lengths.outline);
      for (const Triple<double>& axis : body.axes)
        extent.add(plus(on_paper(body.centre), on_paper(axis), lengths.axis));
    }
    for (const ArrowMark& arrow : marks_.arrows) extent.add(tip(arrow, lengths));
    return extent;
  }

  std::string svg(double scale, const Lengths& lengths) {
    const Extent extent = all(lengths);
    scale_ = scale;
    centre_ = {(extent.x0 + extent.x1) / 2, (extent.y0 + extent.y1) / 2};
    for (std::size_t b = 0; b < marks_.bodies.size(); ++b) draw_body(static_cast<int>(b), lengths);
    for (const ArrowMark& arrow : marks_.arrows) draw_arrow(arrow, lengths);
    for (const PointMark& point : marks_.points) draw_point(point);
    if (dimension_ == 3) draw_directions_of_world();
    write_labels();
    return fmt::format("<svg class=\"pose\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\">\n{}</svg>\n",
                       paper_width, paper_height, drawn_);
  }

 private:
  struct Label {
    OnPaper at;
    std::string text, kind;
    double font;
  };

  OnPaper on_paper(const Triple<double>& p) const { return projected(p, dimension_); }
  OnPaper tip(const ArrowMark& arrow, const Lengths& lengths) const {
    return plus(on_paper(arrow.from), on_paper(arrow.along), arrow.direction ? lengths.direction : 1);
  }
  // In pixels, y down.
  OnPaper pixel(OnPaper p) const {
    return {paper_width / 2 + scale_ * (p.x - centre_.x), paper_height / 2 - scale_ * (p.y - centre_.y)};
  }

  void draw_body(int b, const Lengths& lengths) {
    const BodyMark& body = marks_.bodies[static_cast<std::size_t>(b)];
    std::vector<OnPaper> corners;
    for (const Triple<double>& corner : body.corners) corners.push_back(pixel(on_paper(corner)));
    std::string path;
    for (const OnPaper p : hull_of(corners)) path += (path.empty() ? "M" : "L") + pixels(p);
    drawn_ += fmt::format("<path class=\"skin {}\" style=\"stroke-width:{}\" d=\"{}Z\"/>\n", colour_of(b),
                          pixels(2 * scale_ * lengths.outline), path);
    drawn_ += fmt::format("<path class=\"rim {}\" d=\"{}Z\"/>\n", colour_of(b), path);
    const OnPaper centre = pixel(on_paper(body.centre));
    for (std::size_t k = 0; k < body.axes.size(); ++k) {
      const OnPaper end = pixel(plus(on_paper(body.centre), on_paper(body.axes[k]), lengths.axis));
      draw_line("axis " + colour_of(b), "", centre, end);
      labels_.push_back({end, std::string(1, "xyz"[k]), "small", 9});
    }
    labels_.insert(labels_.begin(), {centre, body.name, "body " + colour_of(b), 13});
  }

  void draw_arrow(const ArrowMark& arrow, const Lengths& lengths) {
    const OnPaper from = pixel(on_paper(arrow.from));
    if (arrow.is_zero()) {
      drawn_ += fmt::format("<circle class=\"zero {}\" data-name=\"{}\" cx=\"{}\" cy=\"{}\" r=\"7\"/>\n",
                            colour_of(arrow.body), arrow.name, pixels(from.x), pixels(from.y));
      return labels_.push_back({from, arrow.name + " = 0", colour_of(arrow.body), 13});
    }
    const OnPaper end = pixel(tip(arrow, lengths));
    draw_line("arrow " + colour_of(arrow.body), arrow.name, from, end);
    labels_.push_back({plus(end, plus(from, end, -1), 0.15), arrow.name, colour_of(arrow.body), 13});
  }

  // With a head, unless it is seen from its end.
  void draw_line(const std::string& kind, const std::string& name, OnPaper from, OnPaper to) {
    taken_.avoid(from, to);
    const std::string named = name.empty() ? "" : fmt::format(" data-name=\"{}\"", name);
    drawn_ += fmt::format("<path class=\"{}\"{} d=\"M{}L{}\"/>\n", kind, named, pixels(from), pixels(to));
    const OnPaper along = plus(to, from, -1);
    const double length = length_of(along), head = std::min(kind.starts_with("axis") ? 5.0 : 8.0, length / 2);
    if (length < 2) return;
    const OnPaper back = plus(to, along, -head / length),
                  side{-along.y * 0.4 * head / length, along.x * 0.4 * head / length};
    drawn_ += fmt::format("<path class=\"head {}\" d=\"M{}L{}L{}Z\"/>\n", kind, pixels(plus(back, side)), pixels(to),
                          pixels(plus(back, side, -1)));
  }

  void draw_point(const PointMark& point) {
    const OnPaper at = pixel(on_paper(point.at));
    taken_.avoid(plus(at, {-4, -4}), plus(at, {4, 4}));
    taken_.avoid(plus(at, {-4, 4}), plus(at, {4, -4}));
    drawn_ += fmt::format("<circle class=\"point {}\" data-name=\"{}\" cx=\"{}\" cy=\"{}\" r=\"3.5\"/>\n",
                          colour_of(point.body), point.name, pixels(at.x), pixels(at.y));
    labels_.insert(labels_.begin(), {at, point.name, colour_of(point.body), 13});
  }

  void draw_directions_of_world() {
    const OnPaper corner{26, paper_height - 22};
    for (std::size_t k = 0; k < 3; ++k) {
      Triple<double> axis{};
      axis[k] = 1;
      const OnPaper along = on_paper(axis), end = plus(corner, {along.x, -along.y}, 18);
      draw_line("axis seen-from", "", corner, end);
      labels_.push_back({end, std::string(1, "xyz"[k]), "small", 9});
    }
  }

  void write_labels() {
    for (const Label& label : labels_) {
      const LabelBox box = taken_.place(label.at, label.text, label.font);
      drawn_ += fmt::format("<text class=\"{}\" x=\"{}\" y=\"{}\">{}</text>\n", label.kind, pixels(box.x0),
                            pixels(box.y1 - 0.25 * label.font), label.text);
    }
  }

  const Marks& marks_;
  int dimension_;
  double scale_ = 1;
  OnPaper centre_;
  std::string drawn_;
  std::vector<Label> labels_;
  Labels taken_{paper_width, paper_height};
};

}  // namespace

OnPaper projected(const Triple<double>& p, int dimension) {
  if (dimension == 2) return {p[0], p[1]};
  const double into = turn_cos * p[1] - turn_sin * p[0];
  return {turn_cos * p[0] + turn_sin * p[1], tilt_cos * p[2] + tilt_sin * into};
}

std::vector<std::string> pictures_of(const Joint& joint, const std::vector<Sample>& poses) {
  std::vector<Marks> marks;
  for (const Sample& pose : poses) marks.push_back(marks_of(joint, pose));
  double extent = 0;
  for (const Marks& m : marks) {
    const Extent e = Drawing(m, joint.dimension).mechanism();
    extent = std::max({extent, e.x1 - e.x0, e.y1 - e.y0});
  }
  if (extent < 1e-9) extent = 1;
  const Lengths lengths{direction_share * extent, axis_share * extent, outline_share * extent};
  double scale = HUGE_VAL;
  for (const Marks& m : marks) {
    const Extent e = Drawing(m, joint.dimension).all(lengths);
    scale = std::min({scale, (paper_width - 2 * margin) / (e.x1 - e.x0), (paper_height - 2 * margin) / (e.y1 - e.y0)});
  }
  std::vector<std::string> pictures;
  for (const Marks& m : marks) pictures.push_back(Drawing(m, joint.dimension).svg(scale, lengths));
  return pictures;
}

}  // namespace cdot::derive
