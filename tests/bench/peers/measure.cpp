// Errors and times of runs.
#include "tests/bench/peers/measure.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <time.h>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {
namespace {

double error_of(const Problem& problem, const State& is, const State& should) {
  const double error = problem.measure == Measure::place ? norm(is.x - should.x) : angle_between(is.q, should.q);
  return std::isfinite(error) ? error : never;
}

// A fixed amount of typical work: a dependent chain of products and sums.
double beat() {
  const double start = thread_seconds();
  volatile double sink = 0;
  double x = 0.3;
  for (int k = 0; k < 200000; ++k) x = 3.7 * x * (1 - x);
  sink = x;
  return (void)sink, thread_seconds() - start;
}

// Repeats whole runs for `at_least` seconds; returns the seconds of one.
double timed(const Problem& problem, const Point& point, double at_least) {
  const int count = int(std::clamp(at_least / point.probe, 1.0, 64.0));
  std::vector<std::unique_ptr<Run>> runs;
  for (int k = 0; k < count; ++k) runs.push_back(point.series.start(point.knob));
  const double start = thread_seconds();
  for (const std::unique_ptr<Run>& run : runs)
    for (const double t : problem.times) run->advance(t);
  return (thread_seconds() - start) / count;
}

// Beaten: another setting of the engine is twice as fast and no less accurate.
bool beaten(const std::vector<Point>& points, const Point& point) {
  return std::any_of(points.begin(), points.end(), [&](const Point& other) {
    return other.engine == point.engine && other.error <= point.error && other.probe < 0.5 * point.probe;
  });
}

constexpr double short_run = 1e-3;  // [s]: an interruption would hide the price of a shorter one
constexpr int short_runs = 5;

// CPU seconds of a run that took `first` the first time: the least of several, if that is short.
double probed(const Problem& problem, const Series& series, double knob, double first) {
  for (int k = 1; k < short_runs && first < short_run; ++k) {
    const std::unique_ptr<Run> run = series.start(knob);
    const double start = thread_seconds();
    error_of(problem, *run);
    first = std::min(first, thread_seconds() - start);
  }
  return first;
}

// Consecutive knobs without progress that end a series: three halvings of a step.
constexpr int most_in_vain = 6;

// True if finer knobs no longer reduce the error.
bool stalled(const std::vector<double>& errors) {
  if (errors.size() < 2 * most_in_vain) return false;
  const double before = *std::min_element(errors.begin(), errors.end() - most_in_vain);
  return std::isfinite(before) && *std::min_element(errors.end() - most_in_vain, errors.end()) > 0.8 * before;
}

// Adds the runs of one series from coarse to fine, until they take too long, no longer reduce the error, or repeatedly
// lose against the engine's earlier settings (large errors do not count yet).
void probe(const Problem& problem, const Options& options, const Engine& engine, const Series& series,
           std::vector<Point>& points) {
  std::vector<double> errors;
  int beaten_before = 0;
  for (const double knob : series.knobs) {
    Point point{&engine, series, knob, never, 0, {}};
    const std::unique_ptr<Run> run = series.start(knob);
    const double start = thread_seconds();
    point.error = error_of(problem, *run);
    point.probe = probed(problem, series, knob, thread_seconds() - start);
    errors.push_back(point.error);
    beaten_before = point.error < 0.03 && beaten(points, point) ? beaten_before + 1 : 0;
    points.push_back(point);
    if (point.probe > options.longest || stalled(errors) || beaten_before == most_in_vain) return;
  }
}

}  // namespace

double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double error_of(const Problem& problem, Run& run) {
  double worst = 0;
  try {
    for (std::size_t k = 0; k < problem.times.size() && worst < never; ++k) {
      run.advance(problem.times[k]);
      for (std::size_t i = 0; i < problem.bodies.size(); ++i)
        worst = std::max(worst, error_of(problem, run.state(int(i)), problem.reference[k][i]));
    }
  } catch (const std::exception&) {
    return never;
  }
  return worst;
}

double start_error(const Problem& problem, const Run& run) {
  double worst = 0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const State s = run.state(int(k)), &t = problem.bodies[k].start;
    worst = std::max({worst, norm(s.x - t.x), angle_between(s.q, t.q), norm(s.v - t.v), norm(s.w - t.w)});
  }
  return worst;
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double at = q * double(values.size() - 1), below = std::floor(at);
  const std::size_t k = std::size_t(below);
  if (k + 1 == values.size()) return values[k];
  return values[k] + (at - below) * (values[k + 1] - values[k]);
}

double cost(const Point& point) {
  return (point.seconds.empty() ? point.probe : median(point.seconds)) / point.engine->lanes;
}

double spread(const Point& point) {
  if (point.seconds.size() < 2) return 0;
  return (quantile(point.seconds, 0.75) - quantile(point.seconds, 0.25)) / 2 / median(point.seconds);
}

std::vector<Point> probe(const Problem& problem, const Options& options) {
  std::vector<Point> points;
  for (const Engine& engine : engines()) {
    if (engine.name.find(options.engine) == std::string::npos) continue;
    for (const Series& series : engine.series(problem)) probe(problem, options, engine, series, points);
  }
  return points;
}

void time(const Problem& problem, const Options& options, std::vector<Point>& points,
          const std::function<void(int round)>& told) {
  std::vector<Point*> worth;
  for (Point& point : points)
    if (point.error < 1 && !beaten(points, point)) worth.push_back(&point);
  for (int round = 0; round < options.rounds; ++round) {
    told(round);
    for (std::size_t k = 0; k < worth.size(); ++k) {
      // Another order in each round, so neighbours change.
      Point& point = *worth[(k * 7919 + std::size_t(round)) % worth.size()];
      metronome().push_back(beat());
      point.seconds.push_back(timed(problem, point, options.at_least));
    }
  }
}

std::vector<double>& metronome() {
  static std::vector<double> beats;
  return beats;
}

std::vector<std::size_t> frontier(const std::vector<Point>& points, const std::string& engine) {
  std::vector<std::size_t> own;
  std::vector<CostedError> costs;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].engine->name != engine || !(points[k].error < never)) continue;
    own.push_back(k);
    costs.push_back({points[k].error, cost(points[k])});
  }
  std::vector<std::size_t> best;
  for (const std::size_t k : frontier_of(costs, 0, noticeable)) best.push_back(own[k]);
  return best;
}

}  // namespace cdot::peers
