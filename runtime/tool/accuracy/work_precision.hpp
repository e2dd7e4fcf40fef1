// The work-precision diagram: error to the right, ever smaller, CPU time upwards, both by decades. Plain data in, SVG
// out; `cdot-run accuracy` and the comparison with other engines draw the same one.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/accuracy/frontier.hpp"

namespace cdot {

// One method or engine: all that was measured of it are pale dots, what of it nothing else of it beats is its line.
struct DiagramSeries {
  std::string name, colour;  // the colour as CSS has it
  int marker = 0;            // 0, 1, 2, …: circle, square, diamond, …
  bool hollow = false;
  std::vector<CostedError> points;
  std::vector<std::string> notes;  // of each point, where somebody points at it
};

struct Diagram {
  std::string title, subtitle;
  std::string error_label;  // "error in trajectory [m, rad]"
  double resolution = 0;    // errors below it are not told apart: a line says so
  double margin = 0;        // an error smaller by less than this share is no gain
  std::vector<DiagramSeries> series;
};

// The frontier of all series lies under them, broad, its points ringed.
std::string work_precision_svg(const Diagram& diagram);

}  // namespace cdot
