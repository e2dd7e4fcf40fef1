// `cdot-run accuracy`: CPU time against error, as text, CSV, JSON and a picture.
#pragma once

#include <string>

#include "runtime/tool/accuracy/sweep.hpp"
#include "runtime/tool/run/choice.hpp"

namespace cdot {

struct AccuracyOptions {
  std::string reference;  // a CSV file; empty: computed here
  std::string output;     // <output>.csv, .json, .svg; empty: <scene>.accuracy in the working directory
  std::string only;       // ways whose name contains this; empty: all
  SweepOptions sweep;
  bool resume = false, json = false, progress = false;
};

inline constexpr double noticeable = 0.05;  // a gain in error below this share does not count

// The choice of `cdot-run simulate --accuracy`, by the same search, measured by the reference.
struct Searched {
  Choice choice;
  double error = 0;  // [m, rad]
  double cost = 0;   // CPU seconds per simulated second of the run delivered
};

// All results, ready for output.
struct AccuracyReport {
  Scene scene;
  ReferenceRun reference;
  int ways = 0, rounds = 0;
  std::vector<Point> answers, failures;
  std::vector<CostedError> costs;  // of the answers
  // Indices into the answers, ascending by cost: of all ways, and of those of a World.
  std::vector<std::size_t> frontier, frontier_of_world;
  std::vector<Advice> advice;              // from the ways of a World
  std::vector<Advice> compiled, in_lanes;  // from those of a compiled scene, alone and eight at a time
  std::vector<std::string> left_out;       // reasons why ways were not compiled
  std::vector<Searched> searched;
};
AccuracyReport report_of(const Scene& scene, const SweepOptions& options, const SweepState& state);

std::string reference_text(const AccuracyReport& report);  // how exact the reference is
std::string accuracy_text(const AccuracyReport& report);
std::string accuracy_json(const AccuracyReport& report);
std::string accuracy_csv(const AccuracyReport& report);
std::string accuracy_svg(const AccuracyReport& report);
// "rk4, direct, step 0.0125 s"
std::string knob_text(const AccuracyReport& report, const Point& point);

// The same for `cdot-run simulate`, complete: "--integrator rk4 --solver direct …".
std::string options_text(const AccuracyReport& report, const Point& point);

struct AccuracyOutcome {
  bool finished = false;  // false: interrupted, `out` is empty
  bool answered = false;  // at least one way has an answer
  std::string out;        // for stdout
};
AccuracyOutcome measure_accuracy(const Scene& scene, const AccuracyOptions& options);

}  // namespace cdot
