// The sweep: every way at ever finer knobs, cheapest first, until the budget is spent; then rounds of timing in turns.
// All that it knows is in SweepState, so that it goes on where it was interrupted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/tool/accuracy/frontier.hpp"
#include "runtime/tool/accuracy/reference.hpp"

namespace cdot {
struct Point {
  Way way;
  int level = 0;
  std::string failure;  // why it is no answer: "not finite"; then nothing below says anything
  Errors errors;
  double explored = 0;         // CPU time of the run that found the errors, in step() [s]
  double looking = 0;          // and to find them [s]
  std::vector<double> rounds;  // CPU seconds per simulated second, one per round of timing

  double cost() const;    // the median round
  double spread() const;  // half the range of the rounds, as a share of the median
};

struct SweepOptions {
  std::vector<Way> ways = all_ways();
  double budget = 60;  // of CPU time [s]
  int rounds = 5;
  int levels = most_levels;  // at most, per way
};

struct SweepState {
  ReferenceRun reference;
  std::vector<Point> points;  // in the order in which they were explored
};

struct SweepHooks {
  Stop stop;  // asked often: shall the sweep end here?
  // Called whenever the state has grown; `used` of `planned` seconds of CPU time are spent.
  std::function<void(double used, double planned, const std::string& doing)> grown;
};

// False if it was stopped. `state` has a reference, and what an earlier, interrupted sweep found.
bool sweep(const Scene& scene, const SweepOptions& options, SweepState& state, const SweepHooks& hooks);

// The points that are answers, timed, by way in the order of `ways` and by level; and those that fail.
std::vector<Point> answers_of(const SweepState& state, const std::vector<Way>& ways);
std::vector<Point> failures_of(const SweepState& state, const std::vector<Way>& ways);

std::vector<CostedError> costs_of(const std::vector<Point>& answers, const ReferenceRun& reference);

// What the findings hold for: they are worth nothing for another program, scene or reference.
struct Fingerprint {
  std::string program, scene;
  bool operator==(const Fingerprint&) const = default;
};
// Of the running program's file; of the scene's text, and whatever else decides what is computed.
std::string hash_of_program();
std::string hash_of(const std::string& text);

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state);

// Throws cdot::Error with a sentence about what does not fit, or if there is no such file.
SweepState read_state(const std::string& path, const Fingerprint& fingerprint);

}  // namespace cdot
