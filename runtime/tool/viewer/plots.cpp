#include "runtime/tool/viewer/plots.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/text/html.hpp"
#include "runtime/tool/viewer/picture.hpp"

namespace cdot {
namespace {

constexpr double left = 86, plot_width = 620, plot_height = 180, gap = 62, top = 62, letter = 7.4, row = 20;
constexpr std::size_t most_curves = 8;  // of a panel: as many as there are colours
// Okabe and Ito's, told apart by colour-blind people too; dashes tell them apart in grey.
constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#8b6914", "#808080"};
constexpr const char* dashes[] = {"none", "7 3", "2 3", "9 3 2 3", "none", "7 3", "2 3", "9 3 2 3"};
constexpr const char* plot_style = R"(<style>
svg { --ink: #1f2328; --paper: #fff; font: 13px sans-serif; background: var(--paper); }
@media (prefers-color-scheme: dark) { svg { --ink: #e6edf3; --paper: #0d1117; } }
text { fill: var(--ink); }
.title { font-size: 17px; font-weight: bold; }
.frame { fill: none; stroke: var(--ink); }
.grid { stroke: var(--ink); stroke-width: .5; opacity: .25; }
.zero { stroke: var(--ink); stroke-width: 1; opacity: .6; }
.curve { fill: none; stroke-width: 1.8; stroke-linejoin: round; }
</style>
)";

// A linear axis with ticks at 1, 2 or 5 times a power of ten.
struct LinearAxis {
  double least, most, from, to;
  double at(double value) const { return from + (to - from) * (value - least) / (most - least); }
  double tick() const {
    const double rough = (most - least) / 5, decade = std::pow(10, std::floor(std::log10(rough)));
    return decade * (rough <= decade ? 1 : rough <= 2 * decade ? 2 : rough <= 5 * decade ? 5 : 10);
  }
  // f(value) for each tick.
  template <class F>
  void each_tick(F f) const {
    const double d = tick();
    for (double k = std::ceil(least / d - 1e-9); k * d <= most + 1e-9 * d; ++k) f(k == 0 ? 0.0 : k * d);
  }
};

struct Panel {
  std::string unit;
  std::vector<std::size_t> sensors;
};

std::vector<Panel> panels_of(const Scene& scene) {
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < scene.sensors.size(); ++k) {
    const std::string& unit = scene.sensors[k].unit;
    const auto open =
        std::ranges::find_if(panels, [&](const Panel& p) { return p.unit == unit && p.sensors.size() < most_curves; });
    if (open != panels.end()) open->sensors.push_back(k);
    else panels.push_back({unit, {k}});
  }
  return panels;
}

// The range of values with some room; a constant lies in the middle of a range of its own size.
LinearAxis axis_of(const Panel& panel, const std::vector<Frame>& film, double y) {
  double least = film.front().sensors[panel.sensors.front()], most = least;
  for (const Frame& frame : film)
    for (const std::size_t k : panel.sensors)
      least = std::min(least, frame.sensors[k]), most = std::max(most, frame.sensors[k]);
  const double size = std::max(std::fabs(least), std::fabs(most));
  const double room = most - least > 1e-9 * size ? 0.05 * (most - least) : size > 0 ? 0.5 * size : 1;
  return {least - room, most + room, y + plot_height, y};
}

std::string number_text(double value) { return fmt::format("{:.6g}", value); }

std::string axes_svg(const LinearAxis& x, const LinearAxis& y, const std::string& unit) {
  std::string svg;
  x.each_tick([&](double t) {
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"middle\">{}</text>\n",
        x.at(t), y.from, y.to, x.at(t), y.from + 18, number_text(t));
  });
  y.each_tick([&](double v) {
    svg += fmt::format(
        "<path class=\"{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        v == 0 ? "zero" : "grid", x.from, y.at(v), x.to, x.from - 8, y.at(v) + 4, number_text(v));
  });
  return svg + fmt::format(
                   "<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n"
                   "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">time [s]</text>\n"
                   "<text transform=\"translate(18 {:.1f}) rotate(-90)\" text-anchor=\"middle\">[{}]</text>\n",
                   x.from, y.to, plot_width, plot_height, (x.from + x.to) / 2, y.from + 36, (y.from + y.to) / 2,
                   text::html_escaped(unit));
}

std::string curves_svg(const Panel& panel, const Scene& scene, const std::vector<Frame>& film, const LinearAxis& x,
                       const LinearAxis& y) {
  struct Spot {
    double x, y;
  };
  std::string svg;
  for (std::size_t i = 0; i < panel.sensors.size(); ++i) {
    std::vector<Spot> spots;
    for (const Frame& frame : film) spots.push_back({x.at(frame.time), y.at(frame.sensors[panel.sensors[i]])});
    const std::string name = text::html_escaped(scene.sensors[panel.sensors[i]].name);
    const double at = y.to + 12 + row * static_cast<double>(i);
    svg += fmt::format(
        "<path class=\"curve\" stroke=\"{0}\" stroke-dasharray=\"{1}\" d=\"{2}\"><title>{3}</title></path>\n"
        "<path class=\"curve\" stroke=\"{0}\" stroke-dasharray=\"{1}\" d=\"M{4:.1f} {5:.1f}h26\"/>\n"
        "<text x=\"{6:.1f}\" y=\"{7:.1f}\">{3}</text>\n",
        colours[i], dashes[i], path_through(spots), name, x.to + 14, at, x.to + 46, at + 4);
  }
  return svg;
}

}  // namespace

std::string plots_svg(const Scene& scene, const std::vector<Frame>& film) {
  const std::vector<Panel> panels = panels_of(scene);
  std::size_t longest = 0;
  for (const Sensor& sensor : scene.sensors) longest = std::max(longest, sensor.name.size());
  const double width = left + plot_width + 60 + letter * static_cast<double>(longest);
  const double height = top + (plot_height + gap) * static_cast<double>(panels.size());
  const double end = film.back().time, start = film.front().time;
  const LinearAxis x{start, end > start ? end : start + 1, left, left + plot_width};
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n{2}<text class=\"title\" x=\"{3}\" y=\"32\">{4}</text>\n",
      width, height, plot_style, left, text::html_escaped(scene.title));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const LinearAxis y = axis_of(panels[i], film, top + (plot_height + gap) * static_cast<double>(i));
    svg += axes_svg(x, y, panels[i].unit) + curves_svg(panels[i], scene, film, x, y);
  }
  return svg + "</svg>\n";
}

}  // namespace cdot
