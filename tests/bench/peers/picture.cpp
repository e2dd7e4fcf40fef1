// The work-precision diagram of one problem: a colour and a marker per engine, every setting a dot.
#include <fmt/format.h>

#include "runtime/tool/accuracy/work_precision.hpp"
#include "tests/bench/peers/report.hpp"

namespace cdot::peers {

std::string picture(const Measured& m) {
  Diagram diagram;
  diagram.title = m.problem.title + ": what accuracy costs";
  diagram.subtitle = "every engine's best settings joined by lines, its other settings pale; one thread";
  diagram.error_label = fmt::format("error [{}]", m.problem.measure == Measure::place ? "m" : "rad");
  diagram.margin = noticeable;
  for (const std::string& name : present(m.points)) {
    DiagramSeries series{name, "", static_cast<int>(diagram.series.size()), false, {}, {}};
    for (const Point& point : m.points) {
      if (name != point.engine->name || !(point.error < 1 && point.error > 0)) continue;
      series.colour = point.engine->colour;
      series.points.push_back({point.error, 1e-6 * price(m.problem, point)});
      series.notes.push_back(fmt::format("{}: {}, {}: {:.1e}, {:.3g} us", name, point.series.name, knob_text(point),
                                         point.error, price(m.problem, point)));
    }
    if (!series.points.empty()) diagram.series.push_back(series);
  }
  return work_precision_svg(diagram);
}

}  // namespace cdot::peers
