// The work-precision diagram of one problem: error to the right, ever smaller, price upwards. Every setting is a dot;
// the frontier of each engine is a line in its colour, and the frontier of all lies under it, broad and pale.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/bench/peers/report.hpp"

namespace cdot::peers {
namespace {

constexpr double left = 84, top = 56, width = 640, height = 420, margin = 150;

std::string power(int exponent) { return fmt::format("10<tspan dy=\"-6\" font-size=\"10\">{}</tspan>", exponent); }

// Decades that hold all points.
struct Axes {
  int coarse = 0, fine = -1;   // exponents of the error, left to right
  int cheap = 10, dear = -10;  // exponents of the price, bottom to top

  double x(double error) const { return left + width * (coarse - std::log10(error)) / double(coarse - fine); }
  double y(double price) const { return top + height * (dear - std::log10(price)) / double(dear - cheap); }
};

bool shown(const Point& point) { return point.error < 1 && point.error > 0; }

Axes axes_of(const Measured& m) {
  Axes axes;
  for (const Point& point : m.points) {
    if (!shown(point)) continue;
    const double decade = std::log10(price(m.problem, point));
    axes.fine = std::min(axes.fine, int(std::floor(std::log10(point.error))));
    axes.cheap = std::min(axes.cheap, int(std::floor(decade)));
    axes.dear = std::max(axes.dear, int(std::ceil(decade)));
  }
  return axes;
}

std::string grid(const Axes& axes) {
  std::string svg;
  for (int e = axes.coarse; e >= axes.fine; --e) {
    const double x = axes.x(std::pow(10.0, e));
    svg += fmt::format("<path d=\"M{:.1f} {}V{}\" class=\"grid\"/>\n", x, top, top + height);
    svg +=
        fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x, top + height + 22, power(e));
  }
  for (int e = axes.cheap; e <= axes.dear; ++e) {
    const double y = axes.y(std::pow(10.0, e));
    svg += fmt::format("<path d=\"M{} {:.1f}H{}\" class=\"grid\"/>\n", left, y, left + width);
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left - 10, y + 5, power(e));
  }
  return svg;
}

std::string line(const Measured& m, const Axes& axes, const std::vector<std::size_t>& points) {
  std::string path;
  for (const std::size_t k : points) {
    if (!shown(m.points[k])) continue;
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", axes.x(m.points[k].error),
                        axes.y(price(m.problem, m.points[k])));
  }
  return path;
}

// What no engine beats.
std::vector<std::size_t> frontier_of_all(const Measured& m) {
  std::vector<std::size_t> candidates, best;
  for (const std::string& name : present(m.points))
    for (const std::size_t k : frontier(m.points, name)) candidates.push_back(k);
  std::sort(candidates.begin(), candidates.end(),
            [&](std::size_t a, std::size_t b) { return cost(m.points[a]) < cost(m.points[b]); });
  for (const std::size_t k : candidates)
    if (best.empty() || m.points[k].error < 0.98 * m.points[best.back()].error) best.push_back(k);
  return best;
}

// Names where the lines end, pushed apart.
std::string labels(const Measured& m, const Axes& axes) {
  struct Label {
    double x, y, at;
    const Engine* engine;
  };
  std::vector<Label> all;
  for (const std::string& name : present(m.points)) {
    const std::vector<std::size_t> best = frontier(m.points, name);
    if (best.empty() || !shown(m.points[best.back()])) continue;
    const Point& last = m.points[best.back()];
    const double y = axes.y(price(m.problem, last));
    all.push_back({axes.x(last.error), y, y, last.engine});
  }
  std::sort(all.begin(), all.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
  std::string svg;
  double above = top - 8;
  for (Label& label : all) {
    label.at = std::max(label.y, above + 17);
    above = label.at;
    const double x = left + width + 14;
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" class=\"lead\"/>\n"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" style=\"fill:{}\" class=\"name\">{}</text>\n",
        label.x + 5, label.y, x - 4, label.at, label.engine->colour, x, label.at + 5, label.engine->colour,
        label.engine->name);
  }
  return svg;
}

}  // namespace

std::string picture(const Measured& m) {
  const Axes axes = axes_of(m);
  const double W = left + width + margin, H = top + height + 64;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\">\n<style>text{{font:13px sans-serif;fill:#444}}.title{{font-size:17px;"
      "font-weight:600;fill:#111}}.name{{font-weight:600}}.grid{{stroke:#e3e3e3;"
      "fill:none}}.lead{{stroke-width:1;stroke-dasharray:1 3;fill:none}}.front{{fill:none;"
      "stroke-width:2.4;stroke-linejoin:round}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      "<text x=\"{2}\" y=\"30\" class=\"title\">{3}: what accuracy costs</text>\n",
      W, H, left, m.problem.title);
  svg += grid(axes);
  svg += fmt::format(
      "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">error [{}], more accurate to the right</text>\n"
      "<text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">µs of CPU per "
      "simulated second</text>\n",
      left + width / 2, H - 14, m.problem.measure == Measure::place ? "m" : "rad", top + height / 2);
  svg += fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"#ffe08a\" stroke-width=\"16\" stroke-linejoin=\"round\" "
      "stroke-linecap=\"round\" opacity=\"0.7\"/>\n",
      line(m, axes, frontier_of_all(m)));
  for (const Point& point : m.points)
    if (shown(point))
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.8\" fill=\"{}\" opacity=\"0.3\"/>\n",
                         axes.x(point.error), axes.y(price(m.problem, point)), point.engine->colour);
  for (const std::string& name : present(m.points)) {
    for (const std::size_t k : frontier(m.points, name)) {
      const Point& point = m.points[k];
      if (!shown(point)) continue;
      svg += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\" fill=\"{}\"><title>{}: {}, {}: {:.1e}, "
          "{:.3g} µs</title></circle>\n",
          axes.x(point.error), axes.y(price(m.problem, point)), point.engine->colour, name, point.series.name,
          knob_text(point), point.error, price(m.problem, point));
    }
    const std::vector<std::size_t> best = frontier(m.points, name);
    if (best.empty()) continue;
    svg += fmt::format("<path d=\"{}\" stroke=\"{}\" class=\"front\"/>\n", line(m, axes, best),
                       m.points[best.front()].engine->colour);
  }
  return svg + labels(m, axes) + "</svg>\n";
}

}  // namespace cdot::peers
