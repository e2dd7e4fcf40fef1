// A measurement -> a page of tables, a CSV, a JSON, and one diagram per problem.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/peers/measure.hpp"

namespace cdot::peers {

struct Measured {
  Problem problem;
  std::vector<Point> points;
};

// Writes README.md, points.csv, frontiers.json and <problem>.svg; `command` repeats the measurement.
void write_report(const std::string& folder, const std::string& command, const Options& options,
                  const std::vector<Measured>& all);

std::string picture(const Measured& measured);

// "1/960 s", or "1e-06".
std::string knob_text(const Point& point);
// Microseconds of CPU per simulated second.
double price(const Problem& problem, const Point& point);
// Names of the engines with a point, in order.
std::vector<std::string> present(const std::vector<Point>& points);

}  // namespace cdot::peers
