// The picture of `cdot-run accuracy`: a hue per integrator, a lightness and a marker per way, hollow in float.
#include <fmt/format.h>

#include "runtime/tool/accuracy/command.hpp"
#include "runtime/tool/accuracy/work_precision.hpp"

namespace cdot {
namespace {

constexpr int hues[] = {215, 300, 35, 150, 0, 180, 60, 255};  // by Integrator

std::size_t family_of(const Way& way) { return static_cast<std::size_t>(way.integrator) % std::size(hues); }

// The ways of one integrator, from the first to the last of `count`.
std::string colour_of(std::size_t family, int index, int count) {
  return fmt::format("hsl({} 75% {}%)", hues[family], count < 2 ? 50 : 38 + 28 * index / (count - 1));
}

// The answers come by way.
std::vector<DiagramSeries> series_of(const AccuracyReport& report) {
  std::vector<DiagramSeries> all;
  std::vector<std::size_t> families;
  int count[std::size(hues)] = {};
  for (std::size_t k = 0; k < report.answers.size(); ++k) {
    const Point& point = report.answers[k];
    const std::size_t family = family_of(point.way);
    if (k == 0 || !(point.way == report.answers[k - 1].way)) {
      all.push_back({name_of(point.way), "", count[family]++, point.way.single, {}, {}});
      families.push_back(family);
    }
    all.back().points.push_back(report.costs[k]);
    all.back().notes.push_back(fmt::format("{}: {:.1e}, {:.3g} us", knob_text(report, point), report.costs[k].error,
                                           1e6 * report.costs[k].cost));
  }
  for (std::size_t k = 0; k < all.size(); ++k)
    all[k].colour = colour_of(families[k], all[k].marker, count[families[k]]);
  return all;
}

}  // namespace

std::string accuracy_svg(const AccuracyReport& report) {
  Diagram diagram;
  diagram.title =
      (report.scene.title.empty() ? report.scene.file : report.scene.title) + ": what accuracy costs in time";
  diagram.subtitle = fmt::format("one thread, {:.6g} s simulated, medians of {} rounds in turns",
                                 report.reference.times.back(), report.rounds);
  diagram.error_label = "error in trajectory [m, rad]";
  diagram.resolution = report.reference.resolution();
  diagram.margin = noticeable;
  diagram.series = series_of(report);
  return work_precision_svg(diagram);
}

}  // namespace cdot
