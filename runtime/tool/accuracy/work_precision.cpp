// A diagram -> SVG.
#include "runtime/tool/accuracy/work_precision.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/text/html.hpp"
#include "runtime/tool/viewer/picture.hpp"

namespace cdot {
namespace {

constexpr double left = 84, top = 72, plot_width = 560, plot_height = 470, bottom = 62;
constexpr double row_height = 21, letter = 7.6;  // of the names at the right
constexpr double least_error = 1e-17;            // an error of 0 is drawn here
constexpr std::size_t least_letters = 27;        // of the frontier's name, in bold
constexpr std::size_t few = 10;                  // up to so many names have leaders to their lines
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
constexpr const char* style = R"(<style>
svg { --ink: #1f2328; --paper: #fff; --band: #fbbf24; font: 15px sans-serif; background: var(--paper); }
@media (prefers-color-scheme: dark) { svg { --ink: #e6edf3; --paper: #0d1117; --band: #b45309; } }
text { fill: var(--ink); }
.title { font-size: 19px; font-weight: bold; }
.small { font-size: 13px; }
.strong { font-weight: bold; }
.frame { fill: none; stroke: var(--ink); }
.grid { stroke: var(--ink); stroke-width: .5; opacity: .25; }
.limit { stroke: var(--ink); stroke-dasharray: 6 4; }
.lead { fill: none; stroke-dasharray: 1 3; }
.curve { fill: none; stroke-width: 2; stroke-linejoin: round; }
.dot { opacity: .3; }
.frontier { fill: none; stroke: var(--band); stroke-width: 14; stroke-linejoin: round; stroke-linecap: round; opacity: .7; }
.ring { fill: none; stroke: var(--ink); stroke-width: 1.6; }
</style>
)";

struct Spot {
  double x, y;
};

// Decades of one axis, from `from` to `to` in the picture.
struct Axis {
  int first = 0, last = 1;
  double from = 0, to = 1;
  double at(double value) const { return from + (to - from) * (std::log10(value) - first) / (last - first); }
  double decade(int exponent) const { return from + (to - from) * (exponent - first) / (last - first); }
  bool has(double value) const {
    return value > 0 && std::log10(value) >= std::min(first, last) && std::log10(value) <= std::max(first, last);
  }
};

// The decades of all values; value(point) gives one.
template <class F>
std::pair<int, int> decades(const std::vector<CostedError>& points, F value) {
  if (points.empty()) return {0, 1};
  double least = value(points.front()), most = least;
  for (const CostedError& point : points) least = std::min(least, value(point)), most = std::max(most, value(point));
  const int first = static_cast<int>(std::floor(std::log10(least)));
  return {first, std::max(first + 1, static_cast<int>(std::ceil(std::log10(most))))};
}

double error_shown(const CostedError& point) { return std::max(point.error, least_error); }
double microseconds(const CostedError& point) { return 1e6 * point.cost; }

std::string power(double x, double y, const char* anchor, int decade) {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">10<tspan dy=\"-6\" font-size=\"11\">{}</tspan>"
      "</text>\n",
      x, y, anchor, decade);
}

std::string ring(const Spot& at) {
  return fmt::format("<circle class=\"ring\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"8\"/>\n", at.x, at.y);
}

std::string mark(const DiagramSeries& series, const Spot& at, const std::string& note) {
  const std::string title = note.empty() ? "" : fmt::format("<title>{}</title>", text::html_escaped(note));
  return fmt::format("<path d=\"{}\" transform=\"translate({:.1f} {:.1f})\" stroke=\"{}\" fill=\"{}\">{}</path>\n",
                     markers[static_cast<std::size_t>(series.marker) % std::size(markers)], at.x, at.y, series.colour,
                     series.hollow ? "var(--paper)" : series.colour, title);
}

class Drawing {
 public:
  explicit Drawing(const Diagram& diagram) : diagram_(diagram) {
    for (const DiagramSeries& series : diagram.series)
      all_.insert(all_.end(), series.points.begin(), series.points.end());
    const auto [finest, coarsest] = decades(all_, error_shown);
    const auto [cheapest, most_expensive] = decades(all_, microseconds);
    x_ = {coarsest, finest, left, left + plot_width};
    y_ = {cheapest, most_expensive, top + plot_height, top};
    std::size_t longest = 0;
    for (const DiagramSeries& series : diagram.series) longest = std::max(longest, series.name.size());
    width_ = left + plot_width + 74 + letter * static_cast<double>(std::max(longest, least_letters));
    height_ = top + std::max(plot_height + bottom, row_height * static_cast<double>(diagram.series.size()) + 70);
  }

  std::string svg() const {
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\">\n{2}"
               "<text class=\"title\" x=\"{3}\" y=\"30\">{4}</text>\n<text class=\"small\" x=\"{3}\" "
               "y=\"54\">{5}</text>\n",
               width_, height_, style, left, text::html_escaped(diagram_.title),
               text::html_escaped(diagram_.subtitle)) +
           grid() + resolution() + frontier() + curves() + names() + "</svg>\n";
  }

 private:
  std::string grid() const {
    std::string svg = fmt::format("<rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n", left, top,
                                  plot_width, plot_height);
    const int every = x_.first - x_.last > 12 ? 2 : 1;
    for (int decade = x_.first; decade >= x_.last; --decade) {
      svg += fmt::format("<path class=\"grid\" d=\"M{:.1f} {}v{}\"/>\n", x_.decade(decade), top, plot_height);
      if ((x_.first - decade) % every == 0) svg += power(x_.decade(decade), top + plot_height + 22, "middle", decade);
    }
    for (int decade = y_.first; decade <= y_.last; ++decade) {
      svg += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}h{}\"/>\n", left, y_.decade(decade), plot_width);
      svg += power(left - 10, y_.decade(decade) + 5, "end", decade);
    }
    return svg +
           fmt::format(
               "<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}: more accurate to the right</text>\n"
               "<text transform=\"translate(26 {:.0f}) rotate(-90)\" text-anchor=\"middle\">CPU time per simulated "
               "second [us]</text>\n",
               left + plot_width / 2, top + plot_height + 48, text::html_escaped(diagram_.error_label),
               top + plot_height / 2);
  }

  std::string resolution() const {
    if (!x_.has(diagram_.resolution)) return {};
    const double x = x_.at(diagram_.resolution);
    return fmt::format(
        "<path class=\"limit\" d=\"M{0:.1f} {1}v{2}\"/>\n<text class=\"small\" transform=\"translate({3:.1f} {4}) "
        "rotate(-90)\">resolution of the reference</text>\n",
        x, top, plot_height, x - 6, top + plot_height - 8);
  }

  std::string frontier() const {
    const std::vector<Spot> spots = spots_of(all_);
    if (spots.empty()) return {};
    std::string svg = fmt::format("<path class=\"frontier\" d=\"{}\"/>\n", path_through(spots));
    for (const Spot& spot : spots) svg += ring(spot);
    return svg;
  }

  std::string curves() const {
    std::string svg;
    for (const DiagramSeries& series : diagram_.series) {
      for (const CostedError& point : series.points)
        svg += fmt::format("<circle class=\"dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"/>\n",
                           spot_of(point).x, spot_of(point).y, series.colour);
      svg += fmt::format("<path class=\"curve\" d=\"{}\" stroke=\"{}\"/>\n", path_through(spots_of(series.points)),
                         series.colour);
      for (const std::size_t k : best_of(series.points))
        svg += mark(series, spot_of(series.points[k]), k < series.notes.size() ? series.notes[k] : "");
    }
    return svg;
  }

  // At the right, at the height of their lines' ends, moved apart.
  std::string names() const {
    struct Name {
      const DiagramSeries* series;
      Spot end;
    };
    std::vector<Name> all;
    for (const DiagramSeries& series : diagram_.series)
      if (!series.points.empty()) all.push_back({&series, spots_of(series.points).back()});
    std::stable_sort(all.begin(), all.end(), [](const Name& a, const Name& b) { return a.end.y < b.end.y; });
    const double x = left + plot_width + 30;
    std::string svg;
    double above = top - row_height / 2;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto below = static_cast<double>(all.size() - k);  // rows still to place, with two of the frontier
      const double y = std::max(std::min(all[k].end.y, height_ - 20 - row_height * (below + 2)), above + row_height);
      if (all.size() <= few)
        svg += fmt::format("<path class=\"lead\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\"/>\n",
                           all[k].end.x + 9, all[k].end.y, x - 4, y, all[k].series->colour);
      svg +=
          fmt::format("<path class=\"curve\" d=\"M{:.0f} {:.1f}h24\" stroke=\"{}\"/>\n", x, y, all[k].series->colour);
      svg += mark(*all[k].series, {x + 12, y}, "");
      svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\">{}</text>\n", x + 34, y + 5,
                         text::html_escaped(all[k].series->name));
      above = y;
    }
    return svg + name_of_frontier(x, above + 1.5 * row_height);
  }

  static std::string name_of_frontier(double x, double y) {
    return fmt::format(
               "<path class=\"frontier\" d=\"M{0:.0f} {1:.1f}h24\"/>\n<text x=\"{2:.0f}\" y=\"{3:.1f}\" "
               "class=\"strong\">the frontier: nothing is</text>\n<text x=\"{2:.0f}\" y=\"{4:.1f}\" "
               "class=\"strong\">cheaper and more accurate</text>\n",
               x, y, x + 34, y + 5, y + 5 + 0.9 * row_height) +
           ring({x + 12, y});
  }

  std::vector<std::size_t> best_of(const std::vector<CostedError>& points) const {
    return frontier_of(points, diagram_.resolution, diagram_.margin);
  }
  std::vector<Spot> spots_of(const std::vector<CostedError>& points) const {
    std::vector<Spot> spots;
    for (const std::size_t k : best_of(points)) spots.push_back(spot_of(points[k]));
    return spots;
  }
  Spot spot_of(const CostedError& point) const { return {x_.at(error_shown(point)), y_.at(microseconds(point))}; }

  const Diagram& diagram_;
  std::vector<CostedError> all_;
  Axis x_, y_;
  double width_ = 0, height_ = 0;
};

}  // namespace

std::string work_precision_svg(const Diagram& diagram) { return Drawing(diagram).svg(); }

}  // namespace cdot
