// Runs a scene from start to end: rows and film frames on the way, a verdict at the end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <cdot/snapshot.hpp>

#include "runtime/tool/run/choose_method.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/worst.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct RunOptions {
  std::function<void(const Frame&)> row;  // called for every row of the trajectory, if set
  std::vector<double> row_times;          // when; empty: after every step
  std::vector<double> film_times;
  std::vector<double> diagnose_times;  // after the first step that ends then or later, and before one that fails
  bool progress = false;               // on stderr
  Snapshot from;                       // goes on from there; empty: from the scene's start
  // When to keep the state in RunResult::state: after the first step that ends then or later.
  std::optional<double> keep_state;
};

struct RunResult {
  std::optional<Choice> choice;  // of a scene that asks for an accuracy
  StepCounts counts;             // of rk4 and dop853
  double time = 0;               // reached [s]
  double start = 0;              // [s]; above 0 if the run went on from a state
  long long steps = 0;
  Snapshot state;  // the one that was to be kept
  double cpu = 0;  // spent in step() [s]
  double worst_error = 0, worst_error_time = 0;
  std::string worst_joint;
  double energy_start = 0, energy_end = 0,
         energy_drift = 0;  // [J]; drift: the largest |E - E_start|
  int redundant_rows = 0;
  std::vector<std::string> broken_joints, notes;
  bool finite = true, interrupted = false;
  std::optional<StepResult> failed_step;  // the run ends before it
  std::vector<WorstOfIsland> diagnosis;
  int diagnoses = 0;  // of how many times that is
  std::vector<Frame> film;
};

// The world at the start, moved onto its joints if the scene asks for it, and prepared.
template <class S>
BasicWorld<S> world_at_start(const Scene& scene, std::string& warnings);

// `warnings` receives what was odd but not wrong (an inconsistent start), in the lines of the
// scene.
RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings);

// Why the answer is no; empty if the run stayed finite and its joints held.
std::string failure(const Scene& scene, const RunResult& result);

std::string summary_text(const Scene& scene, const RunResult& result);
std::string summary_json(const Scene& scene, const RunResult& result);

}  // namespace cdot
