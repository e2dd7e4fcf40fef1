// Ways and a budget -> measured points: ever finer knobs, cheapest first, then rounds of timing in turns. SweepState
// holds all progress: an interrupted sweep resumes from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/tool/accuracy/frontier.hpp"
#include "runtime/tool/accuracy/reference.hpp"
#include "runtime/tool/compiled/compiled_scenes.hpp"

namespace cdot {
struct Point {
  Way way;
  int level = 0;
  std::string failure;  // why there is no answer: "not finite"; the members below are then void
  Errors errors;
  double explored = 0;         // CPU time of the run that found the errors, in step() [s]
  double looking = 0;          // CPU time to find them [s]
  std::vector<double> rounds;  // CPU seconds per simulated second, one per round of timing

  double cost() const;    // the median round
  double spread() const;  // half the range of the rounds, as a share of the median
};

struct SweepOptions {
  std::vector<Way> ways = all_ways();
  double budget = 60;  // of CPU time [s]
  int rounds = 5;
  int levels = most_levels;                  // at most, per way
  const CompiledScenes* compiled = nullptr;  // of the ways with lanes
};

struct SweepState {
  ReferenceRun reference;
  std::vector<Point> points;  // in the order of exploration
};

struct SweepHooks {
  Stop stop;  // called often: true ends the sweep
  // Called after every change of the state, with CPU time used and planned [s].
  std::function<void(double used, double planned, const std::string& doing)> grown;
};

// False if it was stopped. `state` has a reference, and the points of an interrupted sweep.
bool sweep(const Scene& scene, const SweepOptions& options, SweepState& state, const SweepHooks& hooks);

// The points that are answers, timed, by way in the order of `ways` and by level; and those that fail.
std::vector<Point> answers_of(const SweepState& state, const std::vector<Way>& ways);
std::vector<Point> failures_of(const SweepState& state, const std::vector<Way>& ways);

std::vector<CostedError> costs_of(const std::vector<Point>& answers, const ReferenceRun& reference);

// Identifies the program, and the scene with its reference: points of others are void.
struct Fingerprint {
  std::string program, scene;
  bool operator==(const Fingerprint&) const = default;
};
// Of the running program's file; of the scene's text and all that decides the result.
std::string hash_of_program();
std::string hash_of(const std::string& text);

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state);

// Throws cdot::Error if there is no such file, or if it belongs to another sweep.
SweepState read_state(const std::string& path, const Fingerprint& fingerprint);

}  // namespace cdot
