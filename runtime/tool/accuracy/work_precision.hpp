// Errors and costs -> the work-precision diagram as SVG: error falls to the right, CPU time grows upwards, both by
// decades.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/accuracy/frontier.hpp"

namespace cdot {

// One method or engine. All its points are pale dots; its own frontier is its line.
struct DiagramSeries {
  std::string name, colour;  // the colour as CSS has it
  int marker = 0;            // 0, 1, 2, …: circle, square, diamond, …
  bool hollow = false;
  std::vector<CostedError> points;
  std::vector<std::string> notes;  // of each point, as tooltips
};

struct Diagram {
  std::string title, subtitle;
  std::string error_label;  // "error in trajectory [m, rad]"
  double resolution = 0;    // errors below it count as equal; a line marks it
  double margin = 0;        // a gain in error below this share does not count
  std::vector<DiagramSeries> series;
};

// The frontier of all series is a broad line below them, its points ringed.
std::string work_precision_svg(const Diagram& diagram);

}  // namespace cdot
