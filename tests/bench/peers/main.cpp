// cdot-peers: the cost of accuracy in Cdot and in today's engines, in one run on one machine.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <stdexcept>

#include "tests/bench/peers/problem.hpp"
#include "tests/bench/peers/report.hpp"

namespace {

using namespace cdot::peers;

// Before the timing: checks that all engines solve the same problem.
void compare_answers(const Measured& m) {
  for (const std::string& name : present(m.points)) {
    const std::vector<std::size_t> best = frontier(m.points, name);
    double start = 0;
    for (const Point& point : m.points)
      if (point.engine->name == name) start = std::max(start, start_error(m.problem, *point.series.start(point.knob)));
    if (best.empty()) {
      fmt::print(stderr, "  {:<14} start off by {:.0e}; no run stays finite\n", name, start);
      continue;
    }
    const Point& finest = m.points[best.back()];
    fmt::print(stderr, "  {:<14} start off by {:.0e}; error down to {:.1e} ({}, {}){}\n", name, start, finest.error,
               finest.series.name, knob_text(finest), finest.error < 1e-2 ? "" : "  DOES NOT CONVERGE");
  }
}

Measured measure(const ProblemRow& row, const Options& options) {
  Measured m{load(row), {}};
  fmt::print(stderr, "{}: comparing answers\n", m.problem.title);
  m.points = probe(m.problem, options);
  compare_answers(m);
  time(m.problem, options, m.points,
       [&](int round) { fmt::print(stderr, "\r  round {} of {}  ", round + 1, options.rounds); });
  fmt::print(stderr, "\n");
  return m;
}

void write_down(const std::string& folder, const std::string& command, const Options& options,
                const std::vector<Measured>& all) {
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  write_report(folder, command, options, all);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The cost of accuracy in Cdot and in today's engines."};
  Options options;
  std::string problem, output;
  app.add_option("--problem", problem, "Only problems whose name contains this");
  app.add_option("--engine", options.engine, "Only engines whose name contains this");
  app.add_option("--rounds", options.rounds, "Interleaved rounds of timing")->capture_default_str();
  app.add_option("--longest", options.longest, "CPU seconds of a run beyond which a series is not refined further")
      ->capture_default_str();
  app.add_option("-o,--output", output, "Folder for README.md, points.csv, frontiers.json and the pictures");
  CLI11_PARSE(app, argc, argv);
  std::string command = "cdot-peers";
  for (int k = 1; k < argc; ++k) command += fmt::format(" {}", argv[k]);
  try {
    std::vector<Measured> all;
    for (const ProblemRow& row : problem_rows()) {
      if (std::string(row.name).find(problem) == std::string::npos) continue;
      all.push_back(measure(row, options));
      write_down(output, command, options, all);
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
