// Candidates for a better method, run one after the other over the same scene.
#include "runtime/tool/search/advice.hpp"

#include <algorithm>
#include <exception>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <optional>
#include <tuple>

#include <cdot/methods.hpp>

#include "runtime/tool/run/balance_report.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/search/simulate.hpp"
#include "runtime/tool/search/work.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot {
namespace {

// Work (search/work.hpp): of all trials, about two seconds; of one; and of one by the run's own method, so that a
// longer run is tried up to an earlier time.
constexpr double most_work = 16e6, most_work_of_a_trial = 4e6, own_work_of_a_trial = 1e6;
constexpr int compared_times = 40;  // of a trial's trajectory with a finer one

// Options of `cdot-run simulate`, and the same change of a scene.
struct Candidate {
  std::string options;
  std::function<void(Scene&)> change;
};

Candidate by_step(double step) {
  return {fmt::format("--step {:.6g}", step),
          [step = std::stod(fmt::format("{:.6g}", step))](Scene& scene) { scene.step = step; }};
}

Candidate by_integrator(const Scene& scene, Integrator integrator, double local_error) {
  std::string options = fmt::format("--integrator {}", name_of(integrators, integrator));
  if (sweeps(scene.settings.solver)) options += " --solver direct";
  if (scene.settings.drift != Drift::projection) options += " --drift projection";
  if (local_error > 0) options += fmt::format(" --local-error {:.0e}", local_error);
  return {options, [=](Scene& changed) {
            changed.settings.integrator = integrator;
            changed.settings.solver = Solver::direct;
            changed.settings.drift = Drift::projection;
            changed.settings.local_error = local_error;
          }};
}

Candidate project() {
  return {"--project", [](Scene& changed) { changed.project = true; }};
}

Candidate both(const Candidate& a, const Candidate& b) {
  return {a.options + " " + b.options, [=](Scene& scene) { a.change(scene), b.change(scene); }};
}

// Only a start that the run has told to be inconsistent changes.
bool may_project(const Scene& scene, const RunOptions& options) {
  if (scene.project || !options.from.empty()) return false;
  std::string told;
  const auto start = [&]<class S>(S) { world_at_start<S>(scene, told); };
  scene.single ? in_space_of<float>(scene, start) : in_space_of<double>(scene, start);
  return !told.empty();
}

// `fails`: the run ended at a step that failed.
std::vector<Candidate> candidates_for(const Scene& scene, bool fails, bool projects) {
  std::vector<Candidate> all;
  const Settings& settings = scene.settings;
  if (scene.on_failure == OnFailure::stop && fails)
    all.push_back({"--on-failure retry", [](Scene& changed) { changed.on_failure = OnFailure::retry; }});
  if (sweeps(settings.solver))
    all.push_back({"--solver direct", [](Scene& changed) { changed.settings.solver = Solver::direct; }});
  if (settings.local_error > 0) {
    for (const double share : {1e-2, 1e-4})
      all.push_back({fmt::format("--local-error {:.0e}", share * settings.local_error), [=](Scene& changed) {
                       changed.settings.local_error = std::stod(fmt::format("{:.0e}", share * settings.local_error));
                     }});
  } else {
    for (const Integrator integrator : {Integrator::rattle, Integrator::implicit})
      if (settings.integrator != integrator) all.push_back(by_integrator(scene, integrator, 0));
    all.push_back(by_step(scene.step / 2));
  }
  for (const double local_error : {1e-6, 1e-9}) all.push_back(by_integrator(scene, Integrator::dop853, local_error));
  if (settings.local_error == 0) all.push_back(by_step(scene.step / 8));
  if (settings.local_error == 0)
    all.push_back(both(by_integrator(scene, Integrator::rattle, 0), by_step(scene.step / 8)));
  if (projects) {
    all.push_back(project());
    all.push_back(both(by_integrator(scene, Integrator::dop853, 1e-6), project()));
  }
  return all;
}

// `reached`: the accuracy so far. A search that did not reach it has tried finer ones.
std::vector<Candidate> finer_accuracies(const Scene& scene, bool reached, bool projects) {
  std::vector<Candidate> all;
  const double asked = scene.accuracy > 0 ? scene.accuracy : default_accuracy;
  if (reached)
    for (const double share : {1e-1, 1e-3})
      all.push_back({fmt::format("--accuracy {:.0e}", share * asked),
                     [=](Scene& changed) { changed.accuracy = std::stod(fmt::format("{:.0e}", share * asked)); }});
  if (projects) all.push_back(project());
  return all;
}

}  // namespace

bool needs_advice(const Scene& scene, const RunResult& result) {
  if (result.counts.contradicted > 0) return false;  // no method cures it
  return !failure(scene, result).empty() || !balance_warning(scene, result).empty() ||
         !trajectory_warning(scene, result).empty() || !decision_warning(scene, result).empty();
}

namespace {

// Of a run by a candidate.
struct Trial {
  bool cures = false, interrupted = false;
  double share = 0, off = 0, work = 0;
  long long steps = 0, evaluations = 0;
};

// The share by which a run is off whose method chooses its steps, since it estimates none: its distance from a run with
// a hundredth of the local error, at equal times.
double distance_from_finer(Scene scene, RunOptions options, const RunResult& run, Trial& trial) {
  scene.settings.local_error /= 100;
  options.most_evaluations = 2 * options.most_evaluations - static_cast<double>(run.counts.evaluations);
  std::string warnings;
  const RunResult finer = simulate(scene, options, warnings);
  trial.work += work_of(scene, finer);
  if (finer.film.size() != run.film.size()) return std::numeric_limits<double>::infinity();
  scene.accuracy = 0;  // by sizes of mechanisms
  Yardstick yardstick(scene);
  yardstick.see(finer.film);
  double most = 0;
  for (std::size_t k = 0; k < run.film.size(); ++k) most = std::max(most, yardstick.apart(run.film[k], finer.film[k]));
  return most;
}

// Takes `most` work. `off`: the trajectory was, so a cure has to be near the true one.
Trial try_out(const Scene& scene, RunOptions options, double most, bool off) {
  const bool own_steps = off && scene.settings.local_error > 0 && !chooses_method(scene);
  if (own_steps) {
    const std::vector<double> compared = equal_times(scene.duration, compared_times, 1);
    options.film_times.insert(options.film_times.end(), compared.begin(), compared.end());
    std::sort(options.film_times.begin(), options.film_times.end());
  }
  // A finer run costs no less; a search judges its runs itself.
  options.most_evaluations = most / work_of_evaluation(scene) / (own_steps ? 2 : 1);
  options.is_trial = !chooses_method(scene);
  Trial trial;
  try {
    std::string warnings;
    const RunResult result = simulate(scene, options, warnings);
    trial.work = work_of(scene, result);
    trial.steps = result.steps, trial.evaluations = result.counts.evaluations;
    trial.interrupted = result.interrupted;
    if (result.stopped || result.interrupted || needs_advice(scene, result)) return trial;
    trial.share = worst_share(result.balance);
    trial.off = own_steps ? distance_from_finer(scene, options, result, trial) : result.error.share;
    trial.cures =
        !off || (own_steps ? trial.off <= warned_trajectory_share(scene) : result.choice || result.error.samples > 0);
  } catch (const std::exception&) {  // for example a state of another method
  }
  return trial;
}

// With a candidate, up to `until` if that is above 0; nothing if its methods exclude each other.
std::optional<Scene> changed_by(const Candidate& candidate, const Scene& scene, double until) {
  Scene changed = scene;
  candidate.change(changed);
  if (mistake_in_methods(changed.settings)) return {};
  if (until > 0) changed.duration = until;
  const bool changes_step = scene.settings.local_error == 0 && changed.settings.local_error > 0;
  if (changes_step && scene.step_by_options) changed.step = usual_step(changed.duration, true);
  return changed;
}

// By all that candidates change.
bool run_alike(const Scene& a, const Scene& b) {
  const auto key = [](const Scene& scene) {
    const Settings& s = scene.settings;
    return std::tuple(s.integrator, s.solver, s.drift, s.local_error, scene.step, scene.on_failure, scene.accuracy,
                      scene.project);
  };
  return key(a) == key(b);
}

// A picked integrator is named with other options: with these another one might be picked.
std::string named_with(const Scene& scene, const Candidate& candidate) {
  const bool names = candidate.options.find("--integrator") != std::string::npos;
  if (names || scene.why_integrator.empty()) return {};
  return fmt::format(" --integrator {}", name_of(integrators, scene.settings.integrator));
}

}  // namespace

std::optional<TriedFix> find_advice(const Scene& scene, const RunOptions& options, const RunResult& result) {
  // A search in vain that took its whole budget: trials, which get less, would end in vain as well.
  if (result.choice && result.choice->ended_by_budget) return {};
  const bool projects = may_project(scene, options);
  const std::vector<Candidate> candidates = result.choice
                                                ? finer_accuracies(scene, result.choice->reached, projects)
                                                : candidates_for(scene, result.failed_step.has_value(), projects);
  if (candidates.empty()) return {};
  TriedFix advice;
  const double own_work = work_of(scene, result);
  const double share = own_work > own_work_of_a_trial ? own_work_of_a_trial / own_work : 1;
  RunOptions trial_options;
  trial_options.from = options.from;
  // It may have been part of a step, to a frame that was asked for.
  if (result.failed_step) trial_options.film_times = {result.failed_step->time + result.failed_step->length};
  if (share < 1) {
    if (result.failed_step) return advice;  // shorter trials would not reach the step that failed
    advice.until = result.start + share * (result.time - result.start);
    // A cure of what is not yet ill is none.
    Scene begun = scene;
    begun.duration = advice.until;
    if (try_out(begun, trial_options, most_work_of_a_trial, false).cures) return advice;
  }
  const bool off = !trajectory_warning(scene, result).empty() || !trajectory_failure(scene, result).empty();
  std::vector<Scene> run{scene};
  for (const Candidate& candidate : candidates) {
    const std::optional<Scene> changed = changed_by(candidate, scene, advice.until);
    if (!changed || std::ranges::any_of(run, std::bind_front(run_alike, *changed))) continue;
    if (result.blow.joint >= 0 && changed->settings.local_error == 0) continue;  // by equal steps it would be as unsure
    const double most = std::min(most_work - advice.work, most_work_of_a_trial);
    if (!chooses_method(*changed) && work_of_steps(*changed) > most) continue;
    if (!(most > 0)) break;
    run.push_back(*changed);
    const Trial trial = try_out(*changed, trial_options, most, off);
    if (trial.interrupted) break;
    advice.work += trial.work;
    advice.tried.push_back(candidate.options + named_with(scene, candidate));
    if (!trial.cures) continue;
    advice.options = advice.tried.back();
    advice.share = trial.share, advice.off = trial.off;
    advice.steps = trial.steps, advice.evaluations = trial.evaluations;
    if (own_work > 0) advice.cost = trial.work / (share * own_work);
    break;
  }
  return advice;
}

}  // namespace cdot
