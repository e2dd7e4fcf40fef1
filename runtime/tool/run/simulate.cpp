// A scene -> its run.
#include "runtime/tool/run/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/balance/balance.hpp"
#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/balance_report.hpp"
#include "runtime/tool/run/error_estimate.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/requested_frames.hpp"

namespace cdot {
namespace {

// [m], [rad], and per second: error of a start that is not reported, and tolerance of its projection.
template <class T>
constexpr double start_tolerance = std::is_same_v<T, float> ? 1e-4 : 1e-6;
template <class T>
constexpr double start_projected = by_precision<T>(1e-5, 1e-12);

void judge(const Scene& scene, const Frame& frame, RunResult& result) {
  const WorstError& worst = frame.worst;
  if (worst.joint >= 0 && worst.value >= result.worst_error) {
    result.worst_error = worst.value;
    result.worst_error_time = frame.time;
    result.worst_joint = scene.joints[static_cast<std::size_t>(worst.joint)].name;
  }
  if (frame.passed.joint >= 0 && !(frame.passed.by <= result.worst_end.by))
    result.worst_end = frame.passed, result.worst_end_time = frame.time;
  result.finite = finite(frame) && std::isfinite(worst.value);
  result.sensors.resize(frame.sensors.size());
  for (std::size_t k = 0; k < frame.sensors.size(); ++k) {
    SensorRange& range = result.sensors[k];
    range.least = std::min(range.least, frame.sensors[k]), range.most = std::max(range.most, frame.sensors[k]);
    range.end = frame.sensors[k];
  }
  result.energy_drift = std::max(result.energy_drift, std::abs(frame.energy - result.energy_start));
  result.energy_end = frame.energy;
  result.time = frame.time;
}

// As a gas spring shorter than 0 has none; empty if all have one.
template <class S>
std::string effect_without_energy(const WorldData<S>& world) {
  for (const auto& batch : world.batches)
    for (int slot = 0; batch->law && batch->law->energy && slot < static_cast<int>(batch->joint.size()); ++slot)
      if (!std::isfinite(batch->law->energy(*batch, slot))) return std::string(world.sources[batch->source]);
  return {};
}

template <class S>
void finish(const Scene& scene, const BasicWorld<S>& world, RunResult& result) {
  for (std::size_t k = 0; k < scene.joints.size(); ++k) {
    if (world.broken(static_cast<int>(k))) result.broken_joints.push_back(scene.joints[k].name);
  }
  result.redundant_rows = world.redundant_rows();
  result.counts = world.step_counts();
  for (const Note& note : world.notes()) {
    const bool spring = note.joint >= std::ssize(scene.joints);  // springs follow the joints
    const std::string joint = spring ? "a spring" : fmt::format("joint \"{}\"", name_in(scene.joints, note.joint));
    result.notes.push_back(fmt::format("{} {}", joint, note.text));
  }
  result.interrupted = Interrupt::asked();
}

constexpr double same_time = 1e-9;  // of the duration

// Multiples of the scene's step, and the end of the run, at which a method that chooses its steps interpolates.
std::vector<double> ends_of_steps(const Scene& scene) {
  std::vector<double> ends = every(scene.step, scene.duration);
  if (scene.duration - ends.back() >= same_time * scene.duration) ends.push_back(scene.duration);
  return ends;
}

// The times at which steps end, whatever outputs are requested. A run that continues from a state keeps the times of
// the run that saved it.
class Steps {
 public:
  Steps(const Scene& scene, const RunOptions& options) : step_(scene.step), start_(options.from.time()) {
    if (!(start_ < scene.duration * (1 - 1e-12)))
      throw Error(fmt::format("the state is from {:.6g} s, but the run ends at {:.6g} s. Likely fix: a later --until",
                              start_, scene.duration));
    if (scene.settings.local_error > 0) {
      ends_ = ends_of_steps(scene);
      const auto later = std::upper_bound(ends_.begin(), ends_.end(), start_ + same_time * scene.duration);
      first_ = later - ends_.begin() - 1;
      count_ = static_cast<long long>(ends_.size()) - first_ - 1;
      if (std::abs(time(0) - start_) > same_time * scene.duration) ends_[static_cast<std::size_t>(first_)] = start_;
    } else {
      first_ = std::llround(start_ / step_);
      // A World adds its steps up, each sum rounded.
      const double summed = std::numeric_limits<double>::epsilon() * static_cast<double>(first_) * start_;
      if (std::abs(time(0) - start_) > std::max(1e-6 * step_, summed)) first_ = 0, offset_ = start_;
      count_ = static_cast<long long>(std::ceil((scene.duration - time(0)) / step_ * (1 - 1e-12)));
    }
  }
  long long count() const { return count_; }
  // After k steps.
  double time(long long k) const {
    return ends_.empty() ? offset_ + static_cast<double>(first_ + k) * step_
                         : ends_[static_cast<std::size_t>(first_ + k)];
  }
  double length(long long k) const { return ends_.empty() ? step_ : time(k) - time(k - 1); }

 private:
  double step_, start_, offset_ = 0;
  std::vector<double> ends_;
  long long first_ = 0, count_ = 0;
};

// The times from `start` on.
std::vector<double> from_time(std::vector<double> times, double start, double step) {
  times.erase(times.begin(), std::lower_bound(times.begin(), times.end(), start - 1e-6 * step));
  return times;
}

template <class S>
BasicWorld<S> world_of_run(const Scene& scene, const RunOptions& options, std::string& warnings) {
  if (options.from.empty()) return world_at_start<S>(scene, warnings);
  BasicWorld<S> world = build_world_in<S>(scene);
  try {
    world.restore(options.from);
  } catch (const Error& error) {
    throw Error(fmt::format("the state does not fit {}: {}", scene.file, error.what()));
  }
  return world;
}

// The local error of the steps from `time` on; their lengths follow it.
template <class S>
void allow(WorldData<S>& data, const Paces* paces, double time) {
  const double before = data.settings.local_error, now = paces ? paces->allowed(time) : before;
  if (now == before) return;
  const double longer = std::pow(now / before, 1.0 / row_of(data.settings.integrator).order);
  for (Island<S>& island : data.islands) island.flow.next_step *= typename S::Scalar(longer);
  data.settings.local_error = now;
}

template <class S>
void look(const Scene& scene, BasicWorld<S>& world, RunResult& result) {
  add_diagnosis(diagnose(world, scene.step / scene.settings.substeps), world.time(), result.diagnosis);
  ++result.diagnoses;
}

double evaluations_of(const RunResult& result) {
  return static_cast<double>(result.counts.evaluations + result.solves);
}

// A trial ends that is on the way to so many times its bound, foreseen from this share of it. A start may cost a dozen
// times what follows: of those that were cures, the dearest start foresaw half of that. A trial also ends that has lost
// what fails it, from this share of the time on: a tenth of that is no cure, and energies hardly grow tenfold then.
constexpr double surely_beyond = 3, foreseen_from = 0.1, lost_from = 0.1;

// Errors of joints, contradictions, undecided blows and the trajectory's estimate never shrink.
bool in_vain(const Scene& scene, const RunOptions& options, const RunResult& so_far, const TrajectoryError& error) {
  if (so_far.worst_error > scene.tolerance || so_far.worst_end.by > scene.tolerance) return true;
  if (so_far.counts.undecided > 0 || so_far.counts.contradicted > 0 || error.share > warned_trajectory_share(scene))
    return true;
  const double passed = (so_far.time - so_far.start) / (scene.duration - so_far.start);
  if (passed > lost_from && worst_share(so_far.balance) > scene.energy_tolerance) return true;
  const double spent = evaluations_of(so_far), most = options.most_evaluations;
  return spent > foreseen_from * most && spent > surely_beyond * most * passed;
}

template <class S>
RunResult simulate_in(const Scene& scene, const RunOptions& options, std::string& warnings) {
  RunResult result;
  BasicWorld<S> world = world_of_run<S>(scene, options, warnings);
  world.data().most_evaluations = options.most_evaluations;
  world.data().paced_by = options.paced_by, world.data().paces = options.paces;
  const Steps steps(scene, options);
  result.start = steps.time(0);
  // A state of that time has the lengths of the local error before.
  if (options.paces)
    world.data().settings.local_error = options.paces->allowed(result.start - same_time * scene.duration);
  RequestedFrames<S> requested(scene, options.paced_by, options.paces);
  if (options.row) requested.request(from_time(options.row_times, result.start, scene.step), options.row);
  requested.request(from_time(options.film_times, result.start, scene.step),
                    [&](const Frame& frame) { result.film.push_back(frame); });
  const bool every_step = options.row && options.row_times.empty();
  ProgressLine progress(options.progress);
  const Interrupt interrupt;

  const int bodies = static_cast<int>(scene.bodies.size());
  WorldData<S>& data = world.data();
  Energy energy = energy_of(data, data.one_slot);
  Frame before = frame_of(world, result.start, bodies, energy.sum());
  read_sensors(scene, world, before, before);
  Frame after = before;
  result.energy_start = before.energy;
  auto next_diagnosis = options.diagnose_times.begin();
  result.may_break = !data.bonds.empty();
  RankWatch rank;
  BreakWatch breaks(scene.settings);
  BlowWatch blows;
  SlipWatch slips;
  YieldWatch<S> yields;
  TurnWatch<S> turns;
  const bool leads_stages = works_on_accelerations(scene.settings.integrator) && !(scene.settings.local_error > 0);
  WorstStepWatch<S> worst_step(told_share(scene), steps.count());
  ErrorEstimate<S> error(scene, steps.count());
  const auto fail = [&](const StepResult& step) {
    result.failed_step = step;
    if (options.save_at && result.state.empty()) result.state = world.snapshot();
    if (!options.diagnose_times.empty()) look(scene, world, result);
  };
  for (long long k = 0;; ++k) {
    judge(scene, after, result);
    if (k > 0) rank.look(after.time, world.weakest_row());
    if (k > 0) breaks.look(world, after.time), blows.look(world, after.time), slips.look(world, after.time);
    if (k > 0) yields.look(world, after.time);
    if (leads_stages) turns.look(world, after.time - before.time, after.time);
    if (!result.finite) break;
    if (k == 0) worst_step.begin(world, energy, result.balance);
    else worst_step.look(world, energy, k, bool(options.look), result.balance);
    if (result.first_rescue < 0 && world.step_counts().rescued > 0)
      result.first_rescue = after.time, result.at_rescue = largest_force(world);
    if (result.first_undecided < 0 && world.step_counts().undecided > 0) result.first_undecided = after.time;
    if (result.first_contradicted < 0 && world.step_counts().contradicted > 0) result.first_contradicted = after.time;
    if (every_step) options.row(after);
    if (const StepResult part = requested.after_step(before, after); !part) {
      fail(part);
      break;
    }
    if (k > 0 && options.estimates_error) error.after_step(world, before, after, k);
    if (options.save_at && result.state.empty() && after.time >= *options.save_at * (1 - 1e-12))
      result.state = world.snapshot();
    const auto due =
        std::upper_bound(next_diagnosis, options.diagnose_times.end(), after.time + same_time * scene.duration);
    if (due != next_diagnosis) look(scene, world, result);
    next_diagnosis = due;
    result.counts = world.step_counts(), result.solves = data.solves, result.kinked = data.kinked;
    result.stopped = (options.look && !options.look(after, result)) ||
                     evaluations_of(result) > options.most_evaluations ||
                     (options.is_trial && in_vain(scene, options, result, error.error()));
    if (result.stopped && !options.diagnose_times.empty()) look(scene, world, result);
    if (Interrupt::asked() && options.save_at && result.state.empty()) result.state = world.snapshot();
    if (k == steps.count() || result.stopped || Interrupt::asked()) break;
    requested.before_step(world, after, steps.time(k + 1));
    if (options.estimates_error) error.before_step(world, k + 1, steps.length(k + 1));
    allow(data, options.paces, after.time);
    const double start = cpu_now();
    const StepResult step = world.step(steps.length(k + 1));
    result.cpu += cpu_now() - start;
    if (!step) {
      fail(step);
      break;
    }
    result.steps = k + 1;
    std::swap(before, after);
    energy = energy_of(data, data.one_slot);
    after = frame_of(world, steps.time(k + 1), bodies, energy.sum());
    read_sensors(scene, world, before, after);
    if (progress.due())
      progress.show(fmt::format("{}{:3.0f} %  {:.4g} s of {:.4g} s", options.doing, 100 * after.time / scene.duration,
                                after.time, scene.duration));
  }
  worst_step.tell(result.balance);
  if (result.finite) result.balance.look(world.balance());
  result.work = world.work_by_source();
  if (std::isnan(result.energy_end)) result.without_energy = effect_without_energy(data);
  rank.end();
  result.rank_losses = rank.found();
  result.near_break = breaks.found(world), result.break_at_loss = breaks.at_loss();
  result.blow = blows.found();
  result.sharp_turn = turns.found(), result.turned_slip = slips.found();
  result.yielding_motor = yields.found();
  result.worst_step = worst_step.found();
  error.finish(after, result.steps);
  result.error = error.error();
  finish(scene, world, result);
  return result;
}

// Why the start was not projected onto the joints; empty if it was.
std::string refusal(const Scene& scene, const ProjectResult& result) {
  if (result) return {};
  if (!result.refused)
    return fmt::format(
        "{}: warning: the start could not be projected onto C = 0: joints, or ends of limits and ropes, contradict "
        "each other\n",
        scene.file);
  return fmt::format(
      "{}: warning: the projection of the start was refused: row {} of {} is off by {:.3g} (m or rad, or per s), and "
      "to "
      "close it {} would move by {:.3g} (m, or m/s). The joints of that loop nearly contradict each other; they share "
      "the "
      "error.\n"
      "  fix: correct the anchors, lengths or angles of the loop, or remove one of its joints\n",
      scene.file, result.row + 1, joint_name(scene, result.joint), result.misfit, body_name(scene, result.body),
      result.moved);
}

}  // namespace

template <class S>
BasicWorld<S> world_at_start(const Scene& scene, std::string& warnings) {
  BasicWorld<S> world = build_world_in<S>(scene);
  if (scene.project) warnings += refusal(scene, world.project(start_projected<typename S::Scalar>));
  warnings += inconsistency_report(scene, world, start_tolerance<typename S::Scalar>);
  world.prepare();
  return world;
}

RunResult run_once(const Scene& scene, const RunOptions& options, std::string& warnings) {
  const auto run = [&]<class S>(S) { return simulate_in<S>(scene, options, warnings); };
  return scene.single ? in_space_of<float>(scene, run) : in_space_of<double>(scene, run);
}

#define CDOT_INSTANTIATE(S) template BasicWorld<S> world_at_start(const Scene&, std::string&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
CDOT_FOR_EACH_EXTENDED_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
