// What a measurement looks like: a page of tables, a CSV, a JSON, and one picture per problem.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/peers/measure.hpp"

namespace cdot::peers {

struct Measured {
  Problem problem;
  std::vector<Point> points;
};

// Writes README.md, points.csv, frontiers.json and <problem>.svg; `command` is what remakes them.
void write_report(const std::string& folder, const std::string& command, const Options& options,
                  const std::vector<Measured>& all);

std::string picture(const Measured& measured);

// "1/960 s", or "1e-06".
std::string knob_text(const Point& point);
// Microseconds of CPU per simulated second.
double price(const Problem& problem, const Point& point);
// Names of the engines that have a point, in their order.
std::vector<std::string> present(const std::vector<Point>& points);

}  // namespace cdot::peers
