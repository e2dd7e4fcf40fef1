// The measurement: every setting is first run and compared with the reference; then those worth timing run in
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

// The largest error over bodies and sample times; infinite if the engine gave up or the run is no number.
double error_of(const Problem& problem, Run& run);

// What the engine says of the start, against what it was told: it would else solve another problem.
double start_error(const Problem& problem, const Run& run);

// One knob of one series of one engine.
struct Point {
  const Engine* engine;
  Series series;
  double knob;
  double error = never;
  double probe = 0;             // CPU seconds of the run that gave the error
  std::vector<double> seconds;  // CPU seconds of a whole run, per round; empty if not worth timing
};

// CPU seconds that a whole run takes: the median of the rounds, or the probe's where there are none.
double cost(const Point& point);
// Half the middle half of the rounds, relative to the median.
double spread(const Point& point);

struct Options {
  int rounds = 5;
  double longest = 0.25;    // CPU seconds of a run beyond which a series is not refined further
  double at_least = 0.004;  // CPU seconds per round and point: shorter runs are repeated
  std::string engine;       // only engines whose name contains this
};

// Runs every series from coarse to fine while that helps.
std::vector<Point> probe(const Problem& problem, const Options& options);

// Fills Point::seconds of the points that no other of the same engine beats clearly. `told` hears of every round.
void time(const Problem& problem, const Options& options, std::vector<Point>& points,
          const std::function<void(int round)>& told);

// How long the same fixed arithmetic took, once between any two points: the machine's own noise.
std::vector<double>& metronome();

inline constexpr double noticeable = 0.02;  // an error smaller by less is no gain

// The indices of an engine's points by rising cost and falling error: none is as cheap and as accurate (to 2 %).
std::vector<std::size_t> frontier(const std::vector<Point>& points, const std::string& engine);

double median(std::vector<double> values);
double quantile(std::vector<double> values, double q);

}  // namespace cdot::peers
