// `cdot-run accuracy`: the options of tool/accuracy.
#include <fmt/format.h>

#include "runtime/tool/accuracy/command.hpp"
#include "runtime/tool/commands/options.hpp"

namespace cdot {
namespace {

struct Options {
  SceneOptions scene;
  AccuracyOptions accuracy;
};

void add_options(Line& line, Options& options) {
  AccuracyOptions& accuracy = options.accuracy;
  add_scene(line, options.scene);
  add_until(line, options.scene);
  line.add("--budget", &accuracy.sweep.budget, "CPU time to spend [s]; more allows finer steps")
      .positive()
      .shows_default();
  line.add("--rounds", &accuracy.sweep.rounds, "timings per run, interleaved").positive().shows_default();
  line.add("--levels", &accuracy.sweep.levels, "largest number of steps or local errors per way").positive();
  line.add("--only", &accuracy.only, "only ways with this in their name: direct, rk4, float, compiled");
  line.add("--reference", &accuracy.reference,
           "a reference trajectory from `simulate -o`; without it, two methods compute one");
  line.add("-o,--output", &accuracy.output,
           "write PREFIX.csv, PREFIX.json and PREFIX.svg; default: the scene's name with .accuracy");
  line.add("--resume", &accuracy.resume, "continue an interrupted run of this command");
  line.add("--json", &accuracy.json, "print JSON");
  add_progress(line, options.scene);
}

int run(const Options& options) {
  AccuracyOptions accuracy = options.accuracy;
  accuracy.progress = progress_shown(options.scene);
  const std::vector<Way>& compiled = compiled_ways();
  accuracy.sweep.ways.insert(accuracy.sweep.ways.end(), compiled.begin(), compiled.end());
  const AccuracyOutcome outcome = measure_accuracy(scene_of(options.scene), accuracy);
  if (!outcome.finished) return stopped;
  fmt::print("{}", outcome.out);
  return outcome.answered ? well : answer_is_no;
}

}  // namespace

Run accuracy_command(Line& line) { return command_line::with_options<Options>(line, add_options, run); }

}  // namespace cdot
