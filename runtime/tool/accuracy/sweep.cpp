// Explores and times points; writes and reads the state of a sweep.
#include "runtime/tool/accuracy/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/number/hash.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/run/process.hpp"

namespace cdot {
namespace {

constexpr double least_timed = 2e-3;     // [s]: a timing of a point takes at least this long
constexpr int patience = 4;              // levels without progress that end a way
constexpr double progress = 0.9;         // error of progress, as a share of the best so far
constexpr double adaptive_growth = 1.6;  // of the cost per decade of local error; the bound is fourth order

double timed(const Point& point, int rounds) {
  return point.failure.empty() ? rounds * std::max(point.explored, least_timed) : 0;
}

// The progress of one way, and a prediction for its next level.
struct Progress {
  int next_level = 0;
  double predicted = 0;  // CPU time of the next level [s],
  double looking = 0;    // and to find its errors
  bool open = true;
};

Progress progress_of(const Way& way, const SweepState& state, const SweepOptions& options) {
  Progress result;
  double best = std::numeric_limits<double>::infinity();
  int idle = 0;
  for (const Point& point : state.points) {
    if (point.way != way) continue;
    result.next_level = point.level + 1;
    const double growth =
        way.adaptive ? adaptive_growth
                     : static_cast<double>(knob_at(way, point.level + 1).steps) / knob_at(way, point.level).steps;
    result.predicted = growth * point.explored;
    result.looking = growth * point.looking;
    if (!point.failure.empty()) continue;
    const double error = point.errors.trajectory();
    idle = error < progress * best ? 0 : idle + 1;
    best = std::min(best, error);
  }
  result.open = has_level(way, result.next_level) && result.next_level < options.levels && idle < patience &&
                best > state.reference.resolution();
  return result;
}

struct Next {
  Way way;
  Progress progress;
};

Point explored(const Scene& scene, const Next& next, const ReferenceRun& reference, const SweepOptions& options,
               double limit, const Stop& stop, bool& stopped) {
  const Way& way = next.way;
  Point point{way, next.progress.next_level, {}, {}, 0, 0, {}};
  const double start = cpu_now();
  const Stop too_long = [&] {
    stopped = stop && stop();
    return stopped || cpu_now() - start > limit;
  };
  const Knob knob = knob_at(way, point.level);
  const Trajectory trajectory = way.lanes > 0 ? options.compiled->trajectory(way, knob, reference.times, too_long)
                                              : trajectory_of(scene, way, knob, reference.times, too_long, {}, true);
  point.explored = trajectory.cpu;
  point.looking = trajectory.looking;
  const bool whole = trajectory.frames.size() == reference.times.size();
  point.errors = errors_of(trajectory, reference, scene);
  if (!trajectory.finite) point.failure = "not finite";
  else if (!whole) point.failure = "takes too long";
  else if (point.errors.position > size_of(reference))
    point.failure = fmt::format("off by {:.2g} m", point.errors.position);
  else if (point.errors.angle > 1) point.failure = fmt::format("off by {:.2g} rad", point.errors.angle);
  return point;
}

double spent(const SweepState& state, const SweepOptions& options) {
  double sum = 0;
  for (const Point& point : state.points) sum += point.explored + point.looking + timed(point, options.rounds);
  return sum;
}

// The cheapest level left that fits the budget.
std::optional<Next> next_of(const SweepState& state, const SweepOptions& options) {
  std::optional<Next> next;
  for (const Way& way : options.ways) {
    const Progress progress = progress_of(way, state, options);
    if (progress.open && (!next || progress.predicted < next->progress.predicted)) next = {way, progress};
  }
  if (!next) return {};
  const double price = (1 + options.rounds) * next->progress.predicted + next->progress.looking;
  if (spent(state, options) + price > options.budget) return {};
  return next;
}

bool explore(const Scene& scene, const SweepOptions& options, SweepState& state, const SweepHooks& hooks) {
  while (const auto next = next_of(state, options)) {
    const double left = options.budget - spent(state, options);
    bool stopped = false;
    Point point = explored(scene, *next, state.reference, options, left, hooks.stop, stopped);
    if (stopped) return false;
    state.points.push_back(std::move(point));
    if (hooks.grown) hooks.grown(spent(state, options) / (1 + options.rounds), options.budget, name_of(next->way));
  }
  return true;
}

bool time_in_turns(const Scene& scene, const SweepOptions& options, SweepState& state, const SweepHooks& hooks) {
  double exploring = 0, timing = 0, done = 0;
  for (const Point& point : state.points) {
    exploring += point.explored + point.looking;
    timing += timed(point, options.rounds);
    done += timed(point, static_cast<int>(point.rounds.size()));
  }
  const double until = state.reference.times.back();
  for (int round = 0; round < options.rounds; ++round) {
    for (Point& point : state.points) {
      if (!point.failure.empty() || static_cast<int>(point.rounds.size()) > round) continue;
      if (hooks.stop && hooks.stop()) return false;
      bool stopped = false;
      const Stop stop = [&] { return stopped = hooks.stop && hooks.stop(); };
      const Knob knob = knob_at(point.way, point.level);
      const double cpu = point.way.lanes > 0 ? options.compiled->cpu(point.way, knob, state.reference.times, stop)
                                             : cpu_of(scene, point.way, knob, state.reference.times, stop);
      if (stopped) return false;
      point.rounds.push_back(cpu / until);
      done += timed(point, 1);
      if (hooks.grown)
        hooks.grown(exploring + done, exploring + timing,
                    fmt::format("timing, round {} of {}", round + 1, options.rounds));
    }
  }
  return true;
}

std::vector<Point> select(const SweepState& state, const std::vector<Way>& ways, bool failures) {
  std::vector<Point> chosen;
  for (const Way& way : ways)
    for (const Point& point : state.points)
      if (point.way == way && point.failure.empty() != failures) chosen.push_back(point);
  return chosen;
}

}  // namespace

double Point::cost() const {
  if (rounds.empty()) return 0;
  std::vector<double> sorted = rounds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

double Point::spread() const {
  if (rounds.empty()) return 0;
  const auto [least, most] = std::minmax_element(rounds.begin(), rounds.end());
  return (*most - *least) / (2 * cost());
}

bool sweep(const Scene& scene, const SweepOptions& options, SweepState& state, const SweepHooks& hooks) {
  return explore(scene, options, state, hooks) && time_in_turns(scene, options, state, hooks);
}

std::vector<Point> answers_of(const SweepState& state, const std::vector<Way>& ways) {
  return select(state, ways, false);
}
std::vector<Point> failures_of(const SweepState& state, const std::vector<Way>& ways) {
  return select(state, ways, true);
}

std::vector<CostedError> costs_of(const std::vector<Point>& answers, const ReferenceRun& reference) {
  std::vector<CostedError> costs;
  for (const Point& point : answers)
    costs.push_back({std::max(point.errors.trajectory(), reference.resolution()), point.cost()});
  return costs;
}

// --- The file of an interrupted sweep.

// The file has these members; a sweep resumes without the others.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Way, integrator, solver, drift, iterations, single, adaptive, lanes)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Errors, position, angle, C, Cdot, energy)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point, way, level, failure, errors, explored, looking, rounds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BodyState, x, y, angle, vx, vy, w, z, vz, e0, e1, e2, e3, wx, wy, wz)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Frame, time, energy, bodies)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Sensitivity, condition, round_off, slight)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReferenceRun, made_by, settled, times, disagree, sensitivity, verdict, frames)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SweepState, reference, points)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Fingerprint, program, scene)

std::string hash_of(const std::string& text) {
  Hash hash;
  hash.bytes(text.data(), text.size());
  return fmt::format("{:016x}", hash.value);
}

std::string hash_of_program() { return hash_of(read_file("/proc/self/exe")); }

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state) {
  write_file(path, nlohmann::json{{"of", fingerprint}, {"state", state}}.dump() + "\n");
}

SweepState read_state(const std::string& path, const Fingerprint& fingerprint) {
  const std::string text = read_file(path);
  try {
    const auto json = nlohmann::json::parse(text);
    const Fingerprint of = json.at("of");
    if (of.scene != fingerprint.scene)
      throw Error(path + ": the scene, its duration or its reference has changed since: start again without --resume");
    if (of.program != fingerprint.program)
      throw Error(path + ": another build of cdot-run wrote it: start again without --resume");
    return json.at("state");
  } catch (const nlohmann::json::exception&) {
    throw Error(path + ": not the state of an interrupted sweep");
  }
}

}  // namespace cdot
