// The measurement: every setting runs once and is compared with the reference; then the useful ones are timed in
// interleaved rounds.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "runtime/tool/accuracy/frontier.hpp"
#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

constexpr double never = std::numeric_limits<double>::infinity();

double thread_seconds();  // CPU time of this thread

// The largest error over bodies and sample times; infinite if the engine gave up or the state is not finite.
double error_of(const Problem& problem, Run& run);

// The difference between the engine's start and the given one; a large one means another problem.
double start_error(const Problem& problem, const Run& run);

// One knob of one series of one engine.
struct Point {
  const Engine* engine;
  Series series;
  double knob;
  double error = never;
  double probe = 0;             // CPU seconds of the run that gave the error
  std::vector<double> seconds;  // CPU seconds of a whole run, per round; empty if not timed
};

// CPU seconds of a whole run of one mechanism: the median of the rounds, or the probe's time without rounds.
double cost(const Point& point);
// Half the middle half of the rounds, relative to the median.
double spread(const Point& point);

struct Options {
  int rounds = 5;
  double longest = 0.25;    // CPU seconds of a run beyond which a series is not refined further
  double at_least = 0.004;  // CPU seconds per round and point: shorter runs are repeated
  std::string engine;       // only engines whose name contains this
};

// Runs every series from coarse to fine while the error shrinks.
std::vector<Point> probe(const Problem& problem, const Options& options);

// Fills Point::seconds of the points that no other point of the same engine clearly beats. Calls `told` after every
// round.
void time(const Problem& problem, const Options& options, std::vector<Point>& points,
          const std::function<void(int round)>& told);

// The times of fixed arithmetic between any two points, a measure of the machine's noise.
std::vector<double>& metronome();

inline constexpr double noticeable = 0.02;  // a smaller reduction of the error does not count

// The indices of an engine's points by rising cost and falling error: none is as cheap and as accurate (to 2 %).
std::vector<std::size_t> frontier(const std::vector<Point>& points, const std::string& engine);

double median(std::vector<double> values);
double quantile(std::vector<double> values, double q);

}  // namespace cdot::peers
