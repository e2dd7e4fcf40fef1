// The picture of `cdot-run accuracy`: the work-precision diagram. Error against CPU time, both by decades; a colour per
// integrator, a marker per way, hollow in float; the frontier as a broad band under its ringed points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/run_accuracy.hpp"
#include "runtime/viewer_text.hpp"

namespace cdot {
namespace {

constexpr double left = 90, top = 70, plot_width = 620, plot_height = 560, legend_width = 330;
constexpr double least_error = 1e-17;           // where an error of 0 is drawn
constexpr int hues[] = {215, 300, 35, 150, 0};  // by Integrator
constexpr const char* markers[] = {
    "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z",  // circle
    "M-3.6 -3.6h7.2v7.2h-7.2z",             // square
    "M0 -5.2L5.2 0L0 5.2L-5.2 0z",          // diamond
    "M0 -5L4.6 3.4H-4.6z",                  // triangles
    "M0 5L4.6 -3.4H-4.6z",
    "M5 0L-3.4 4.6V-4.6z",
    "M-5 0L3.4 4.6V-4.6z",
    "M-1.5 -5h3v3.5h3.5v3h-3.5v3.5h-3v-3.5h-3.5v-3h3.5z",      // plus
    "M0 -5L1.5 -1.5L5 0L1.5 1.5L0 5L-1.5 1.5L-5 0L-1.5 -1.5z"  // star
};

// The ways of one integrator differ in lightness, from the first to the last of `count`.
std::string colour_of(std::size_t family, int index, int count) {
  return fmt::format("hsl({} 75% {}%)", hues[family], count < 2 ? 50 : 38 + 28 * index / (count - 1));
}

// Decades of one axis.
struct Axis {
  int first = 0, last = 1;
  double begin = 0, length = 1;  // in the picture; a negative length runs upwards
  double at(double value) const { return begin + length * (std::log10(value) - first) / (last - first); }
};

Axis axis_over(double least, double most, double begin, double length) {
  Axis axis{static_cast<int>(std::floor(std::log10(least))), static_cast<int>(std::ceil(std::log10(most))), begin,
            length};
  if (axis.last == axis.first) ++axis.last;
  return axis;
}

class Diagram {
 public:
  explicit Diagram(const AccuracyReport& report) : report_(report) {
    double cheapest = 1e-6, dearest = 1e-6, best = 1, worst = 1;
    for (std::size_t k = 0; k < report.answers.size(); ++k) {
      const double cost = report.costs[k].cost, error = error_of(k);
      cheapest = k == 0 ? cost : std::min(cheapest, cost);
      dearest = k == 0 ? cost : std::max(dearest, cost);
      best = k == 0 ? error : std::min(best, error);
      worst = k == 0 ? error : std::max(worst, error);
    }
    x_ = axis_over(1e6 * cheapest, 1e6 * dearest, left, plot_width);
    y_ = axis_over(best, worst, top + plot_height, -plot_height);
  }

  std::string grid() const {
    std::string svg = fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", left, top,
                                  plot_width, plot_height);
    for (int decade = x_.first; decade <= x_.last; ++decade) {
      const double x = x_.at(std::pow(10.0, decade));
      svg += fmt::format("<path class=\"grid\" d=\"M{0:.1f} {1}v{2}\"/>\n", x, top, plot_height);
      svg += tick(x, top + plot_height + 22, "middle", decade);
    }
    for (int decade = y_.first; decade <= y_.last; ++decade) {
      const double y = y_.at(std::pow(10.0, decade));
      svg += fmt::format("<path class=\"grid\" d=\"M{0} {1:.1f}h{2}\"/>\n", left, y, plot_width);
      if ((decade - y_.first) % (y_.last - y_.first > 16 ? 2 : 1) == 0) svg += tick(left - 10, y + 5, "end", decade);
    }
    svg += fmt::format(
        "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">CPU time per simulated second [us]</text>\n",
        left + plot_width / 2, top + plot_height + 48);
    return svg + fmt::format(
                     "<text transform=\"translate(28 {:.0f}) rotate(-90)\" text-anchor=\"middle\">error in trajectory "
                     "[m, rad]</text>\n",
                     top + plot_height / 2);
  }

  // Below it the reference does not tell errors apart.
  std::string resolution() const {
    const double limit = report_.reference.resolution();
    if (limit < std::pow(10.0, y_.first) || limit > std::pow(10.0, y_.last)) return {};
    const double y = y_.at(limit);
    return fmt::format(
        "<path class=\"limit\" d=\"M{0} {1:.1f}h{2}\"/>\n<text class=\"small\" x=\"{3}\" y=\"{4:.1f}\">the reference "
        "tells no more</text>\n",
        left, y, plot_width, left + 8, y - 6);
  }

  std::string frontier() const {
    std::string path, rings;
    for (const std::size_t k : report_.frontier) {
      const auto [x, y] = place(k);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x, y);
      rings += fmt::format("<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8\"/>\n", x, y);
    }
    if (path.empty()) return {};
    return fmt::format("<path class=\"frontier\" d=\"{}\"/>\n{}", path, rings);
  }

  // Every way with an answer: its line and markers, and a row of the legend.
  std::string ways() const {
    const auto ranges = ranges_by_way();
    std::vector<int> count(std::size(hues), 0), index(std::size(hues), 0);
    for (const auto& range : ranges) ++count[family(range)];
    std::string curves, legend;
    double y = top + 8;
    for (const auto& range : ranges) {
      const std::size_t of = family(range);
      const Look look = {colour_of(of, index[of], count[of]), markers[index[of] % static_cast<int>(std::size(markers))],
                         report_.answers[range.first].way.single};
      ++index[of];
      curves += curve(range, look);
      legend += legend_row(y, look, name_of(report_.answers[range.first].way));
      y += 23;
    }
    return curves + legend + legend_of_frontier(y + 8);
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;  // of answers: from, to
  struct Look {
    std::string colour;
    const char* marker;
    bool hollow;
    std::string at(double x, double y) const {
      return fmt::format("<path d=\"{}\" transform=\"translate({:.1f} {:.1f})\" stroke=\"{}\" fill=\"{}\"/>\n", marker,
                         x, y, colour, hollow ? "var(--paper)" : colour);
    }
  };

  std::size_t family(const Range& range) const {
    return static_cast<std::size_t>(report_.answers[range.first].way.integrator) % std::size(hues);
  }
  std::string curve(const Range& range, const Look& look) const {
    std::string line, marks;
    for (std::size_t k = range.first; k < range.second; ++k) {
      const auto [x, y] = place(k);
      line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? 'M' : 'L', x, y);
      marks += look.at(x, y);
    }
    return fmt::format("<path class=\"curve\" d=\"{}\" stroke=\"{}\"/>\n{}", line, look.colour, marks);
  }
  static std::string legend_row(double y, const Look& look, const std::string& name) {
    const double x = left + plot_width + 24;
    return fmt::format(
        "<path class=\"curve\" d=\"M{:.0f} {:.0f}h28\" stroke=\"{}\"/>{}<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", x,
        y, look.colour, look.at(x + 14, y), x + 38, y + 5, escaped(name));
  }
  static std::string legend_of_frontier(double y) {
    const double x = left + plot_width + 24;
    return fmt::format(
        "<path class=\"frontier\" d=\"M{0:.0f} {1:.0f}h28\"/>\n<circle class=\"ring\" cx=\"{2:.0f}\" cy=\"{1:.0f}\" "
        "r=\"8\"/>\n<text x=\"{3:.0f}\" y=\"{4:.0f}\" class=\"strong\">the frontier: nothing is cheaper</text>\n"
        "<text x=\"{3:.0f}\" y=\"{5:.0f}\" class=\"strong\">and more accurate</text>\n",
        x, y, x + 14, x + 38, y + 5, y + 23);
  }
  double error_of(std::size_t k) const { return std::max(report_.costs[k].error, least_error); }
  std::pair<double, double> place(std::size_t k) const {
    return {x_.at(1e6 * report_.costs[k].cost), y_.at(error_of(k))};
  }
  static std::string tick(double x, double y, const char* anchor, int decade) {
    return fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">10<tspan dy=\"-6\" font-size=\"11\">{}</tspan></text>\n", x,
        y, anchor, decade);
  }
  // The answers come by way.
  std::vector<Range> ranges_by_way() const {
    std::vector<Range> result;
    for (std::size_t k = 0; k < report_.answers.size(); ++k) {
      if (k > 0 && report_.answers[k].way == report_.answers[k - 1].way)
        result.back().second = k + 1;
      else
        result.emplace_back(k, k + 1);
    }
    return result;
  }

  const AccuracyReport& report_;
  Axis x_, y_;
};

}  // namespace

std::string accuracy_svg(const AccuracyReport& report) {
  const Diagram diagram(report);
  const double width = left + plot_width + legend_width, height = top + plot_height + 70;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\">\n", width, height);
  svg += R"(<style>
svg { --ink: #1f2328; --paper: #fff; --band: #fbbf24; font: 14px sans-serif; background: var(--paper); }
@media (prefers-color-scheme: dark) { svg { --ink: #e6edf3; --paper: #0d1117; --band: #b45309; } }
text { fill: var(--ink); }
.title { font-size: 18px; font-weight: bold; }
.small { font-size: 12px; }
.strong { font-weight: bold; }
.frame { fill: none; stroke: var(--ink); }
.grid { stroke: var(--ink); stroke-width: .5; opacity: .25; }
.limit { stroke: var(--ink); stroke-dasharray: 6 4; }
.curve { fill: none; stroke-width: 1.2; opacity: .7; }
.frontier { fill: none; stroke: var(--band); stroke-width: 11; stroke-linejoin: round; stroke-linecap: round; opacity: .75; }
.ring { fill: none; stroke: var(--ink); stroke-width: 1.6; }
</style>
)";
  const std::string title = report.scene.title.empty() ? report.scene.file : report.scene.title;
  svg += fmt::format("<text class=\"title\" x=\"{}\" y=\"30\">{}: what accuracy costs in time</text>\n", left,
                     escaped(title));
  svg += fmt::format(
      "<text class=\"small\" x=\"{}\" y=\"52\">one thread, {:.6g} s simulated, medians of {} rounds in turns</text>\n",
      left, report.reference.times.back(), report.rounds);
  return svg + diagram.grid() + diagram.resolution() + diagram.frontier() + diagram.ways() + "</svg>\n";
}

}  // namespace cdot
