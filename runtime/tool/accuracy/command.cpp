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

// Of the budget, at most: for the compiler; for each of three methods of a reference; for searches. The sweep has the
// rest, or this much of the budget.
constexpr double compiler_share = 1.0 / 3, reference_share = 1.0 / 9, search_share = 0.1, sweep_share = 0.25;

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

// The methods that `simulate --accuracy` finds for every decade that the sweep reaches.
std::vector<Searched> searched(const AccuracyReport& report, double budget, const Stop& stop) {
  std::vector<Searched> all;
  const double start = cpu_now();
  for (const Advice& advice : report.advice) {
    if (stop() || cpu_now() - start > search_share * budget) break;
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

// The frontier of some ways, with indices into all answers.
std::vector<std::size_t> frontier_in(const AccuracyReport& report, bool (*chosen)(const Way& way)) {
  std::vector<CostedError> costs;
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < report.answers.size(); ++k)
    if (chosen(report.answers[k].way)) costs.push_back(report.costs[k]), numbers.push_back(k);
  std::vector<std::size_t> frontier = frontier_of(costs, report.reference.resolution(), noticeable);
  for (std::size_t& k : frontier) k = numbers[k];
  return frontier;
}

// Warnings about the start of a scene. All ways share them.
std::string warnings_of(const Scene& scene) {
  std::string warnings;
  in_space_of<double>(scene, [&]<class S>(S) { world_at_start<S>(scene, warnings); });
  return warnings;
}

}  // namespace

AccuracyReport report_of(const Scene& scene, const SweepOptions& options, const SweepState& state) {
  AccuracyReport report;
  report.scene = scene;
  report.reference = state.reference;
  report.ways = static_cast<int>(options.ways.size());
  report.rounds = options.rounds;
  report.answers = answers_of(state, options.ways);
  report.failures = failures_of(state, options.ways);
  report.costs = costs_of(report.answers, state.reference);
  report.frontier = frontier_in(report, [](const Way&) { return true; });
  report.frontier_of_world = frontier_in(report, [](const Way& way) { return way.lanes == 0; });
  report.advice = advice_from(report.costs, report.frontier_of_world);
  report.compiled = advice_from(report.costs, frontier_in(report, [](const Way& way) { return way.lanes == 1; }));
  report.in_lanes = advice_from(report.costs, frontier_in(report, [](const Way& way) { return way.lanes > 1; }));
  if (options.compiled) report.left_out = options.compiled->left_out();
  return report;
}

AccuracyOutcome measure_accuracy(const Scene& scene, const AccuracyOptions& options) {
  SweepOptions ways = chosen(options);
  const std::string output = output_of(scene, options), state_path = output + ".state.json";
  const Fingerprint fingerprint = fingerprint_of(scene, options);
  SweepState state;
  if (options.resume) state = read_state(state_path, fingerprint);
  text::print_messages(stderr, warnings_of(scene));

  const double budget = ways.budget, start = cpu_now() + cpu_of_children();
  const auto used = [start] { return cpu_now() + cpu_of_children() - start; };
  const Interrupt interrupt;
  const Stop stop = [] { return Interrupt::asked(); };
  ProgressLine line(options.progress);
  if (state.reference.frames.empty()) {
    line.show(fmt::format("making the reference; in all at most {:.0f} s of CPU time", budget));
    state.reference = options.reference.empty() ? make_reference_run(scene, effort_of(options), stop)
                                                : read_reference_run(options.reference, scene);
    if (stop()) state.reference = {};  // half of one is none
  }
  std::optional<CompiledScenes> compiled;
  if (!stop()) {
    SceneCompiler compiler = scene_compiler_beside_program();
    compiler.cpu = compiler_share * budget;
    compiled.emplace(scene, ways.ways, compiler, [&](const std::string& what) { line.show(what); });
    ways.compiled = &*compiled;
    if (ways.ways.empty()) throw Error("no way is left: " + fmt::format("{}", fmt::join(compiled->left_out(), "; ")));
  }
  ways.budget = std::max((1 - search_share) * budget - used(), sweep_share * budget);
  std::optional<double> first_done;
  const auto grown = [&](double done, double planned, const std::string& doing) {
    if (!first_done) first_done = done;
    if (!line.due()) return;
    write_state(state_path, fingerprint, state);
    const double pace = done > *first_done ? line.elapsed() / (done - *first_done) : 0;
    line.show(fmt::format("{:3.0f} %  about {:.0f} s left  {}", std::min(100.0, 100 * done / planned),
                          std::ceil(pace * std::max(planned - done, 0.0)), doing));
  };
  const bool finished = !stop() && sweep(scene, ways, state, {stop, grown});
  line.clear();
  if (!finished) {
    write_state(state_path, fingerprint, state);
    fmt::print(stderr, "interrupted: {} runs are saved in {}; --resume continues\n", state.points.size(), state_path);
    return {};
  }
  AccuracyReport report = report_of(scene, ways, state);
  report.searched = searched(report, budget, stop);
  write_files(output, report);
  std::remove(state_path.c_str());
  AccuracyOutcome outcome{true, !report.answers.empty(), options.json ? accuracy_json(report) : accuracy_text(report)};
  if (!options.json) outcome.out += fmt::format("\n  written         {0}.csv, {0}.json, {0}.svg\n", output);
  return outcome;
}

}  // namespace cdot
