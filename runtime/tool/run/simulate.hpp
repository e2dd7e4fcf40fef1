// A scene -> its run: rows and film frames on the way, a verdict at the end.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <cdot/snapshot.hpp>

#include "runtime/state/pace.hpp"
#include "runtime/tool/run/choice.hpp"
#include "runtime/tool/run/error_estimate.hpp"
#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/tool/watch/blow_watch.hpp"
#include "runtime/tool/watch/near_break.hpp"
#include "runtime/tool/watch/parted_blows.hpp"
#include "runtime/tool/watch/rank_watch.hpp"
#include "runtime/tool/watch/turn_watch.hpp"
#include "runtime/tool/watch/worst.hpp"
#include "runtime/tool/watch/worst_step.hpp"

namespace cdot {

struct RunResult;

struct RunOptions {
  std::function<void(const Frame&)> row;  // called with every row of the trajectory
  std::vector<double> row_times;          // empty: after every step
  std::vector<double> film_times;
  std::vector<double> diagnose_times;  // at the first step that ends then or later; before a step that fails, and where
                                       // `look` ends the run
  bool progress = false;               // on stderr
  std::string doing;                   // before the progress: "dop853, local error 1e-06: "
  // Called at the start and after every step with the counts and the balance so far; false ends the run there.
  std::function<bool(const Frame&, const RunResult&)> look;
  // Beyond so many the run is stopped; within a step, an implicit method finishes it then.
  double most_evaluations = std::numeric_limits<double>::infinity();
  bool is_trial = false;  // stopped as soon as it fails or warns, or is on the way far beyond most_evaluations
  // Of a method that chooses its steps: those of an earlier run, to follow, and where to note those of this one.
  const Paces* paced_by = nullptr;
  Paces* paces = nullptr;
  bool estimates_error = true;  // of a trajectory by fixed steps; a search compares runs instead
  double search_work =
      1e8;        // after which the search for a method ends with the best run so far; in units of search/work.hpp
  Snapshot from;  // to continue from; empty: the scene's start
  // When to save RunResult::state: at the first step that ends then or later.
  std::optional<double> save_at;
};

// A fix for a run that was tried (runtime/tool/search/advice.hpp).
struct TriedFix {
  std::string options;             // of `cdot-run simulate`; empty: nothing that was tried is a cure
  double share = 0;                // the method's own share of energies and momenta with these options
  double off = 0;                  // the trajectory's estimated error with them, in shares; 0: no estimate
  double cost = 0;                 // work (search/work.hpp) in units of the run's; 0: that took no step
  long long steps = 0;             // and their price in counts: of steps, or of the intervals of those that a method
  long long evaluations = 0;       // chooses, and of accelerations
  double work = 0;                 // of all trials
  double until = 0;                // [s] up to which the trials ran; 0: like the run
  std::vector<std::string> tried;  // all options tried, in order
};

// The values of a sensor after every step, in its unit.
struct SensorRange {
  double least = std::numeric_limits<double>::infinity(), most = -least, end = 0;
};

struct RunResult {
  std::optional<Choice> choice;  // if the scene asks for an accuracy
  StepCounts counts;             // of integrators on accelerations
  long long solves = 0;          // of others, see Workspace::solves
  long long kinked = 0;          // steps, see Workspace::kinked
  double time = 0;               // at the end [s]
  double start = 0;              // [s]; above 0 if the run continued from a state
  long long steps = 0;
  Snapshot state;  // saved at RunOptions::save_at
  double cpu = 0;  // spent in step() [s]
  double worst_error = 0, worst_error_time = 0;
  std::string worst_joint;
  PassedEnd worst_end;  // the farthest, at worst_end_time
  double worst_end_time = 0;
  double energy_start = 0, energy_end = 0,
         energy_drift = 0;           // [J]; drift: the largest |E - E_start|
  std::string without_energy;        // where energy_end is no number: the effect whose law has none there
  BalanceWatch balance;              // after every step
  std::vector<WorkOfSource> work;    // of the whole run
  std::vector<SensorRange> sensors;  // of the scene
  WorstStep worst_step;
  TrajectoryError error;  // of fixed steps
  std::optional<TriedFix> advice;
  int redundant_rows = 0;
  std::vector<RankLoss> rank_losses;
  std::vector<std::string> broken_joints, notes;
  double first_rescue = -1;  // [s] end of the step that an implicit method first had to finish; below 0: none
  LargestForce at_rescue;    // of a joint, there
  NearBreak near_break;
  BreakAtLoss break_at_loss;
  BlowOnJoint blow;
  TurnedSlip turned_slip;
  YieldingMotor yielding_motor;
  SharpTurn sharp_turn;
  bool may_break = false;          // joints may, by their loads
  double first_undecided = -1;     // [s] end of the step in which a blow was first undecided; below 0: none
  double first_contradicted = -1;  // [s] the same of motors that contradict each other
  bool finite = true, interrupted = false;
  bool stopped = false;                   // by RunOptions::look or most_evaluations
  std::optional<StepResult> failed_step;  // the run ended before it
  std::vector<WorstOfIsland> diagnosis;
  int diagnoses = 0;  // number of times diagnosed
  std::vector<Frame> film;
};

// The World at the start, prepared; projected onto C = 0 if the scene says project.
template <class S>
BasicWorld<S> world_at_start(const Scene& scene, std::string& warnings);

// By the method and steps that the scene names; runtime/tool/search/simulate.hpp runs any scene. `warnings` receives
// warnings in the lines of the scene, such as an inconsistent start.
RunResult run_once(const Scene& scene, const RunOptions& options, std::string& warnings);

// "Tried: `--integrator rattle` keeps its energy to 1e-09 at 0.9 times the cost", or what was tried in vain.
std::string in_words(const TriedFix& advice);

// Why the run failed, with the advice that was tried; empty if it did not.
std::string failure(const Scene& scene, const RunResult& result);

// The scene with the method that ran.
Scene as_run(const Scene& scene, const RunResult& result);

// Concerns about the method that ran; none of its error where the run measured that and reached the accuracy asked for.
std::vector<Concern> concerns_of(const Scene& as_run, const RunResult& result, bool warnings_only);

text::Json rank_losses_json(const Scene& scene, const std::vector<RankLoss>& losses);
std::string summary_text(const Scene& scene, const RunResult& result);
std::string summary_json(const Scene& scene, const RunResult& result);

}  // namespace cdot
