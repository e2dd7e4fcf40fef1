// A scene -> its run: rows and film frames on the way, a verdict at the end.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <cdot/snapshot.hpp>

#include "runtime/tool/run/choose_method.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/rank_watch.hpp"
#include "runtime/tool/run/worst.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct RunOptions {
  std::function<void(const Frame&)> row;  // called with every row of the trajectory
  std::vector<double> row_times;          // empty: after every step
  std::vector<double> film_times;
  std::vector<double> diagnose_times;  // at the first step that ends then or later, and before a step that fails
  bool progress = false;               // on stderr
  Snapshot from;                       // to continue from; empty: the scene's start
  // When to save RunResult::state: at the first step that ends then or later.
  std::optional<double> save_at;
};

// A fix for a run that was tried (runtime/tool/run/advice.hpp).
struct TriedFix {
  std::string options;             // of `cdot-run simulate`; empty: nothing that was tried is a cure
  double share = 0;                // the method's own share of energies and momenta with these options
  double cost = 0;                 // CPU time in units of the run's
  double until = 0;                // [s] up to which the trials ran; 0: like the run
  std::vector<std::string> tried;  // all options tried, in order
};

struct RunResult {
  std::optional<Choice> choice;  // if the scene has an accuracy
  StepCounts counts;             // of integrators on accelerations
  double time = 0;               // at the end [s]
  double start = 0;              // [s]; above 0 if the run continued from a state
  long long steps = 0;
  Snapshot state;  // saved at RunOptions::save_at
  double cpu = 0;  // spent in step() [s]
  double worst_error = 0, worst_error_time = 0;
  std::string worst_joint;
  double energy_start = 0, energy_end = 0,
         energy_drift = 0;  // [J]; drift: the largest |E - E_start|
  BalanceWatch balance;     // after every step
  std::optional<TriedFix> advice;
  int redundant_rows = 0;
  std::vector<RankLoss> rank_losses;
  std::vector<std::string> broken_joints, notes;
  bool finite = true, interrupted = false;
  std::optional<StepResult> failed_step;  // the run ended before it
  std::vector<WorstOfIsland> diagnosis;
  int diagnoses = 0;  // number of times diagnosed
  std::vector<Frame> film;
};

// The World at the start, prepared; projected onto C = 0 if the scene says project.
template <class S>
BasicWorld<S> world_at_start(const Scene& scene, std::string& warnings);

// `warnings` receives warnings in the lines of the scene, such as an inconsistent start.
RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings);

// Why the run failed, with the advice that was tried; empty if it did not.
std::string failure(const Scene& scene, const RunResult& result);

text::Json rank_losses_json(const Scene& scene, const std::vector<RankLoss>& losses);
std::string summary_text(const Scene& scene, const RunResult& result);
std::string summary_json(const Scene& scene, const RunResult& result);

}  // namespace cdot
