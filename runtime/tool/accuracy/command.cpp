// A scene and options -> a sweep, its files and its text.
#include "runtime/tool/accuracy/command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>

#include "runtime/text/colour.hpp"
#include "runtime/tool/accuracy/sweep.hpp"
#include "runtime/tool/run/output.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/search/simulate.hpp"

namespace cdot {
namespace {

constexpr double reference_share = 1.0 / 9;  // of the budget, at most, for each of three methods of a reference

Fingerprint fingerprint_of(const Scene& scene, const AccuracyOptions& options) {
  std::string decisive = read_file(scene.file) + fmt::format("\nuntil {}\n", scene.duration);
  if (!options.reference.empty()) decisive += read_file(options.reference);
  return {hash_of_program(), hash_of(decisive)};
}

std::string output_of(const Scene& scene, const AccuracyOptions& options) {
  if (!options.output.empty()) return options.output;
  return std::filesystem::path(scene.file).stem().string() + ".accuracy";
}

Effort effort_of(const AccuracyOptions& options) {
  Effort effort;
  effort.cpu = reference_share * options.sweep.budget;
  return effort;
}

SweepOptions chosen(const AccuracyOptions& options) {
  SweepOptions sweep = options.sweep;
  std::erase_if(sweep.ways, [&](const Way& way) { return name_of(way).find(options.only) == std::string::npos; });
  if (!sweep.ways.empty()) return sweep;
  std::string known;
  for (const Way& way : options.sweep.ways) known += "\n  " + name_of(way);
  throw Error(fmt::format("no way has \"{}\" in its name; known ways:{}", options.only, known));
}

void write_files(const std::string& output, const AccuracyReport& report) {
  write_file(output + ".csv", accuracy_csv(report));
  write_file(output + ".json", accuracy_json(report));
  write_file(output + ".svg", accuracy_svg(report));
}

constexpr double share_of_searches = 0.1;  // of the budget

// The methods that `simulate --accuracy` finds for every decade that the sweep reaches.
std::vector<Searched> searched(const AccuracyReport& report, double budget, const Stop& stop) {
  std::vector<Searched> all;
  const double start = cpu_now();
  for (const Advice& advice : report.advice) {
    if (stop() || cpu_now() - start > share_of_searches * budget) break;
    Scene scene = report.scene;
    scene.accuracy = std::pow(10.0, advice.decade);
    Trajectory trajectory;
    RunOptions options;
    options.row_times = report.reference.times;
    options.row = [&](const Frame& frame) { trajectory.frames.push_back(frame); };
    std::string warnings;
    const RunResult result = simulate(scene, options, warnings);
    if (!result.choice->reached || trajectory.frames.size() != report.reference.frames.size()) continue;
    all.push_back({*result.choice, errors_of(trajectory, report.reference, scene).trajectory(),
                   result.cpu / report.reference.times.back()});
  }
  return all;
}

// Warnings about the start of a scene. All ways share them.
std::string warnings_of(const Scene& scene) {
  std::string warnings;
  in_space_of<double>(scene, [&]<class S>(S) { world_at_start<S>(scene, warnings); });
  return warnings;
}

}  // namespace

AccuracyReport report_of(const Scene& scene, const SweepOptions& options, const SweepState& state) {
  AccuracyReport report{
      scene, state.reference, static_cast<int>(options.ways.size()), options.rounds, {}, {}, {}, {}, {}, {}};
  report.answers = answers_of(state, options.ways);
  report.failures = failures_of(state, options.ways);
  report.costs = costs_of(report.answers, state.reference);
  report.frontier = frontier_of(report.costs, state.reference.resolution(), noticeable);
  report.advice = advice_from(report.costs, report.frontier);
  return report;
}

AccuracyOutcome measure_accuracy(const Scene& scene, const AccuracyOptions& options) {
  const SweepOptions ways = chosen(options);
  const std::string output = output_of(scene, options), state_path = output + ".state.json";
  const Fingerprint fingerprint = fingerprint_of(scene, options);
  SweepState state;
  if (options.resume) state = read_state(state_path, fingerprint);
  text::print_messages(stderr, warnings_of(scene));

  const Interrupt interrupt;
  const Stop stop = [] { return Interrupt::asked(); };
  ProgressLine line(options.progress);
  if (state.reference.frames.empty()) {
    line.show("making the reference");
    state.reference = options.reference.empty() ? make_reference_run(scene, effort_of(options), stop)
                                                : read_reference_run(options.reference, scene);
    if (stop()) state.reference = {};  // half of one is none
  }
  std::optional<double> first_used;
  const auto grown = [&](double used, double planned, const std::string& doing) {
    if (!first_used) first_used = used;
    if (!line.due()) return;
    write_state(state_path, fingerprint, state);
    const double pace = used > *first_used ? line.elapsed() / (used - *first_used) : 0;
    line.show(fmt::format("{:3.0f} %  about {:.0f} s left  {}", std::min(100.0, 100 * used / planned),
                          std::ceil(pace * std::max(planned - used, 0.0)), doing));
  };
  const bool finished = !stop() && sweep(scene, ways, state, {stop, grown});
  line.clear();
  if (!finished) {
    write_state(state_path, fingerprint, state);
    fmt::print(stderr, "interrupted: {} runs are saved in {}; --resume continues\n", state.points.size(), state_path);
    return {};
  }
  AccuracyReport report = report_of(scene, ways, state);
  report.searched = searched(report, ways.budget, stop);
  write_files(output, report);
  std::remove(state_path.c_str());
  AccuracyOutcome outcome{true, !report.answers.empty(), options.json ? accuracy_json(report) : accuracy_text(report)};
  if (!options.json) outcome.out += fmt::format("\n  written         {0}.csv, {0}.json, {0}.svg\n", output);
  return outcome;
}

}  // namespace cdot
