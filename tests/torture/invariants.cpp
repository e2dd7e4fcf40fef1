#include "tests/torture/invariants.hpp"

#include <fmt/format.h>
#include <thread>

#include <cdot/balance.hpp>

#include "runtime/tool/run/frame.hpp"
#include "tests/torture/draw/scene_text.hpp"
#include "tests/torture/ends.hpp"
#include "tests/torture/excuses.hpp"
#include "tests/torture/observer.hpp"
#include "tests/torture/pushes.hpp"
#include "tests/torture/trial.hpp"

namespace cdot::torture {
namespace {

constexpr int dear = 300;  // evaluations of an island's accelerations in a step, on average

template <class T>
constexpr double start_tolerance = std::is_same_v<T, double> ? 1e-9 : 1e-4;
// The World tells of a start beyond it that it could not project: no law keeps its energy.
template <class T>
constexpr double velocity_tolerance = std::is_same_v<T, double> ? 1e-6 : 1e-3;
// The largest C after a step with Newton, as a share of the row's size.
template <class T>
constexpr double held_tolerance = std::is_same_v<T, double> ? 1e-10 : 1e-4;
// With one-sided rows Runge-Kutta steps end just after an event: C up to this share of the row's size.
template <class T>
constexpr double just_passed = std::is_same_v<T, double> ? 3e-9 : 3e-4;

template <class S>
class Trial {
 public:
  Trial(const Scene& scene, const Asked& asked)
      : scene_(&scene), asked_(&asked), steps_(steps_of(scene)), operations_(operations_of(scene)) {}

  Verdict run();
  // The largest rotation of a row in one step.
  double most_turned();

 private:
  using T = typename S::Scalar;
  BasicWorld<S> started() const;
  BasicWorld<S> before_step() const;
  void push(BasicWorld<S>& world, int k) const;
  StepResult step(BasicWorld<S>& world, int k) const;
  double length_of_step(int k) const { return asked_->varying ? share_of_step(k) * scene_->step : scene_->step; }
  Verdict watch(BasicWorld<S>& world);
  std::optional<Verdict> look(BasicWorld<S>& world, int k);
  // The reason why methods may fail on this mechanism now; nullptr if there is none.
  const char* excuse(BasicWorld<S>& world) const;
  double velocity_off(BasicWorld<S>& world) const;
  Gap gap_now(BasicWorld<S>& world) const;
  double passed_share(BasicWorld<S>& world) const;
  std::optional<Verdict> look_at_joints(BasicWorld<S>& world, const Gap& gap, int k) const;
  std::optional<Verdict> look_at_momentum(const Motion& now, BasicWorld<S>& world, double gap, int k);
  std::optional<Verdict> look_at_energy(double energy, int k) const;
  std::optional<Verdict> look_at_balance(const Balance& balance, int k) const;
  Verdict bits() const;

  // The error of sweeps is of first order in the step for every method.
  bool sweeps_only() const { return scene_->settings.solver == Solver::iterative && order_of(scene_->settings) > 1; }

  const Scene* scene_;
  const Asked* asked_;
  int steps_;
  double operations_;
  Laws laws_;
  RowSizes sizes_;
  Motion start_;
  double independence_ = 1;                     // at the start
  bool in_time_ = false, middle_lost_ = false;  // numbers follow functions of time; bodies are too far away for middle_
  bool starts_beyond_ = false;                  // an end of a limit, or of another effect
  std::vector<typename S::Place> places_;       // of the scene's bodies, before the step
  double start_energy_ = 0, pushes_ = 0, torques_ = 0;
  std::optional<Accounts> accounts_;
  Snapshot middle_, end_;
  int middle_at_ = 0;  // the step after which it was taken
};

// Starts the World like cdot-run.
template <class S>
BasicWorld<S> Trial<S>::started() const {
  BasicWorld<S> world = build_world_in<S>(*scene_);
  if (scene_->project) world.project(by_precision<T>(1e-5, 1e-12));
  world.prepare();
  return world;
}

// The changes before a step.
template <class S>
void Trial<S>::push(BasicWorld<S>& world, int k) const {
  if (asked_->changes) change(world, *scene_, {k, steps_, sizes_.length});
  if (asked_->forces) push_in_time(world, *scene_, {k, steps_, sizes_.length});
}

template <class S>
StepResult Trial<S>::step(BasicWorld<S>& world, int k) const {
  const StepResult result = world.step(length_of_step(k));
  if (asked_->sabotage)
    asked_->sabotage(*scene_, k, [&](int body, double impulse) {
      typename S::Exact::Velocity shove{};
      shove.x = impulse;
      world.apply_impulse(body, shove);
    });
  return result;
}

template <class S>
std::optional<Verdict> Trial<S>::look_at_momentum(const Motion& now, BasicWorld<S>& world, double gap, int k) {
  if (!laws_.momentum()) return {};
  double impulses = 0;
  for (int j = 0; j < world.joint_count(); ++j)
    for (const double lambda : world.impulse(j)) impulses += std::abs(lambda);
  const double rounded = impulses * operations_ * std::numeric_limits<T>::epsilon();
  pushes_ += rounded, torques_ += impulses * gap * sizes_.length + rounded * sizes_.length;
  const double linear = accounts_->momentum_round_off() + pushes_;
  const double angular = accounts_->angular_round_off() + accounts_->angular_order_error() + torques_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double p = std::abs(now.linear[axis] - start_.linear[axis]);
    const double l = std::abs(now.angular[axis] - start_.angular[axis]);
    if (laws_.linear[axis] && !(p <= linear))
      return verdict(Outcome::broken, "momentum", fmt::format("axis {}", "xyz"[axis]), p, linear, k);
    if (laws_.angular[axis] && k > 1 && !sweeps_only() && !(l <= angular))
      return verdict(Outcome::broken, "angular momentum", fmt::format("axis {}", "xyz"[axis]), l, angular, k);
  }
  return {};
}

template <class S>
std::optional<Verdict> Trial<S>::look_at_energy(double energy, int k) const {
  const double bound = accounts_->order_error() + accounts_->round_off_energy(), rise = energy - start_energy_;
  if (k < 2 || sweeps_only()) return {};
  const bool sweeps = scene_->settings.solver == Solver::iterative;
  if (laws_.energy_falls && !(rise <= bound)) return verdict(Outcome::broken, "energy rises", "", rise, bound, k);
  if (laws_.energy_kept && !sweeps && scene_->settings.integrator != Integrator::implicit && !(-rise <= bound))
    return verdict(Outcome::broken, "energy falls", "", -rise, bound, k);
  return {};
}

// Energy less work put in and taken: with sources and sinks too, only the method's own errors are left, of the energy
// and of the work.
template <class S>
std::optional<Verdict> Trial<S>::look_at_balance(const Balance& balance, int k) const {
  const Settings& s = scene_->settings;
  const bool judged = laws_.smooth && s.solver == Solver::direct && s.drift == Drift::projection && !asked_->changes;
  if (k < 2 || !judged) return {};
  const double sums = balance.kinetic + std::abs(balance.potential) + std::abs(balance.put_in) + balance.taken;
  const double rounded =
      accounts_->round_off_energy() + k * operations_ * std::numeric_limits<double>::epsilon() * sums;
  const double bound = 2 * accounts_->order_error() + accounts_->error_of_drives() + rounded, rest = balance.method();
  if (!(rest <= bound)) return verdict(Outcome::broken, "energy without a source", "", rest, bound, k);
  return {};
}

// Relative to the sizes of the rows at the start, or at present if they are larger.
template <class S>
Gap Trial<S>::gap_now(BasicWorld<S>& world) const {
  const double slack = works_on_accelerations(scene_->settings.integrator) ? just_passed<T> : 0;
  const Gap gap = gap_of(world, *scene_, sizes_, slack);
  if (gap.share <= held_tolerance<T>) return gap;
  RowSizes sizes = row_sizes(world);
  for (std::size_t j = 0; j < sizes.of_joint.size(); ++j)
    for (std::size_t r = 0; r < sizes.of_joint[j].size(); ++r)
      sizes.of_joint[j][r].value = std::max(sizes.of_joint[j][r].value, sizes_.of_joint[j][r].value);
  return gap_of(world, *scene_, sizes, slack);
}

template <class S>
double Trial<S>::passed_share(BasicWorld<S>& world) const {
  return torture::passed_share(world, sizes_.length, scene_->step, held_tolerance<T>);
}

template <class S>
BasicWorld<S> Trial<S>::before_step() const {
  BasicWorld<S> before = build_world_in<S>(*scene_);
  for (std::size_t k = 0; k < places_.size(); ++k) before.set_pose(static_cast<int>(k), places_[k]);
  return before;
}

template <class S>
const char* Trial<S>::excuse(BasicWorld<S>& world) const {
  if (starts_beyond_) return "a start beyond an end, which the World tells";
  if (laws_.may_contradict) return "a prescribed motion, or a rolling one, meets what may stop it";
  if (heaviest_over_lightest(*scene_) * double(told_apart<T>) > 1)  // rows of effects as well
    return "masses further apart than pivots are told from round-off";
  BasicWorld<S> start = started();  // joints may have shared an error since, where no row is in doubt any more
  for (BasicWorld<S>* at : {&world, &start})
    if (const char* why = rows_in_doubt(*at, *scene_)) return why;
  const SystemMatrix now = system_matrix(world);
  if (independence(now, 8 * std::numeric_limits<T>::epsilon()) < nearly_lost * independence_)
    return "near a pose where the joints lose a row";
  BasicWorld<S> before = before_step();
  if (turned(system_matrix(before), now, sizes_.length) > turns_round)
    return "a joint's directions turn round within a step";
  return nullptr;
}

template <class S>
std::optional<Verdict> Trial<S>::look_at_joints(BasicWorld<S>& world, const Gap& gap, int k) const {
  if (scene_->settings.drift != Drift::projection || scene_->settings.solver != Solver::direct) return {};
  const double held = held_tolerance<T> + round_off_of_poses(world, sizes_.length);
  const bool apart = !(gap.share <= held);
  const double share = apart ? gap.share : passed_share(world);
  const bool may_pass = !apart && works_on_accelerations(scene_->settings.integrator);
  const double bound = may_pass ? just_passed<T> : held;
  if (share <= bound) return {};
  const char* why = excuse(world);
  if (!why && !apart) {
    BasicWorld<S> before = before_step();
    if (passed_ends_turned(before, world, sizes_.length) > turns_round) why = "the direction of an end turns in a step";
  }
  const std::string of(!apart          ? world.worst_passed_end().effect
                       : gap.joint < 0 ? ""
                                       : scene_->joints[static_cast<std::size_t>(gap.joint)].definition.type);
  return verdict(why ? Outcome::limited : Outcome::broken,
                 why     ? why
                 : apart ? "C"
                         : "an end is passed",
                 of, share, bound, k);
}

template <class S>
std::optional<Verdict> Trial<S>::look(BasicWorld<S>& world, int k) {
  const Frame frame = frame_of(world, world.time(), static_cast<int>(scene_->bodies.size()));
  Frame poses = frame;
  poses.energy = 0;
  if (!finite(poses)) return verdict(Outcome::broken, "finite", "a pose or a velocity is no number", 0, 0, k);
  if (!finite(frame))
    return verdict(Outcome::limited, "an effect has no energy at a pose, which cdot-run tells", "", 0, 0, k);
  const Gap gap = gap_now(world);
  const Motion now = motion_of(world);
  accounts_->step(
      now, spring_rows(world), frame.energy, operations_, world.step_counts().taken, length_of_step(k),
      {speed_left_across(world, *scene_), kicks_of_joints(world, *scene_), in_time_ ? world.balance().put_in : 0});
  if (auto broken = look_at_joints(world, gap, k)) return broken;
  if (auto broken = look_at_momentum(now, world, gap.share, k)) {
    // Impulses of rows that contradict each other, or nearly, cancel to round-off of their size before they are summed.
    if (const char* why = excuse(world)) broken->outcome = Outcome::limited, broken->detail = why;
    return broken;
  }
  if (auto broken = look_at_energy(frame.energy, k)) return broken;
  return look_at_balance(world.balance(), k);
}

template <class S>
Verdict Trial<S>::watch(BasicWorld<S>& world) {
  start_ = motion_of(world);
  start_energy_ = world.energy();
  accounts_.emplace(start_, spring_rows(world), start_energy_,
                    asked_->forces ? under_largest_forces(*scene_, sizes_.length) : *scene_, sizes_.length,
                    std::numeric_limits<T>::epsilon(), speed_left_across(world, *scene_));
  Verdict first;
  BalanceWatch balances;
  for (int k = 1; k <= steps_; ++k) {
    places_.clear();
    for (std::size_t b = 0; b < scene_->bodies.size(); ++b) places_.push_back(world.place(static_cast<int>(b)));
    push(world, k);
    const std::uint64_t before = world.hash();
    if (const StepResult result = step(world, k); !result) {
      if (world.hash() != before && !asked_->sabotage)
        return verdict(Outcome::broken, "the state before a step that failed", name_of(result.problem), 0, 0, k);
      return verdict(Outcome::limited, fmt::format("the World says: {}", name_of(result.problem)), "", 0, 0, k);
    }
    if (middle_at_ == 0 && (k == steps_ / 2 || world.step_counts().events > 0))
      middle_ = world.snapshot(), middle_at_ = k,
      middle_lost_ = loses_arms(motion_of(world), sizes_.length, std::numeric_limits<T>::epsilon());
    if (k == steps_) end_ = world.snapshot();  // before look(): energy() changes numbers that the next step overwrites
    if (auto broken = look(world, k)) {
      if (world.step_counts().rescued > 0 && judged_by_order(broken->what)) {
        broken->outcome = Outcome::limited;
        broken->what = fmt::format("steps were left to the linearly implicit method: {}", broken->what);
      }
      return *broken;
    }
    if (asked_->hurry && rescued_in_vain(world, balances, scene_->energy_tolerance))
      return verdict(Outcome::limited, "left to an implicit method, energy fails, as cdot-run tells", "", 0, 0, k);
    if (world.step_counts().evaluations > dear * (k + 100LL) * scene_->settings.substeps)
      return verdict(Outcome::limited, "steps of Runge-Kutta without end", "", double(world.step_counts().evaluations),
                     0, k);
  }
  return first;
}

// Equal bits: in two threads at once, and from the snapshot after the first event or at half time, through text, in a
// World from the scene's text.
template <class S>
Verdict Trial<S>::bits() const {
  Snapshot twice[2];
  const auto again = [&](Snapshot& state) {
    BasicWorld<S> world = started();
    for (int k = 1; k <= steps_; ++k) push(world, k), step(world, k);
    state = world.snapshot();
  };
  std::thread other([&] { again(twice[1]); });
  again(twice[0]);
  other.join();
  for (const Snapshot& state : twice)
    if (!(state == end_))
      return verdict(Outcome::broken, "bits of a repetition",
                     fmt::format("{}", fmt::join(end_.differences(state), ", ")));
  const Scene copy = copy_of(*scene_);
  BasicWorld<S> world = build_world_in<S>(copy);
  try {
    world.restore(Snapshot::read(middle_.text()));
  } catch (const Error& error) {
    return verdict(middle_lost_ ? Outcome::limited : Outcome::broken, "a state is taken back", error.what());
  }
  for (int k = middle_at_ + 1; k <= steps_; ++k) push(world, k), step(world, k);
  const Snapshot state = world.snapshot();
  if (!(state == end_))
    return verdict(Outcome::broken, "bits from a snapshot",
                   fmt::format("{}", fmt::join(end_.differences(state), ", ")));
  return {};
}

// The largest Cdot, as a share of that by the fastest body along each row. What hardly moves in the whole run is at
// rest.
template <class S>
double Trial<S>::velocity_off(BasicWorld<S>& world) const {
  double speed = 1e-3 / scene_->duration, worst = 0;
  for (const BodyMotion& body : motion_of(world).bodies)
    speed = std::max(speed, norm(body.w) + norm(body.v) / sizes_.length);
  for (const Inconsistency& row : world.inconsistencies(0)) {
    const auto& sizes = sizes_.of_joint[static_cast<std::size_t>(row.joint)];
    if (!row.velocity || sizes.empty()) continue;
    worst = std::max(worst, std::abs(row.value) / (speed * sizes[static_cast<std::size_t>(row.row)].value));
  }
  return worst;
}

template <class S>
Verdict Trial<S>::run() {
  BasicWorld<S> world = started();
  sizes_ = row_sizes(world);
  const Gap gap = gap_of(world, *scene_, sizes_);
  if (!(gap.share <= start_tolerance<T>))
    return verdict(Outcome::refused, "the start is not on the joints", "", gap.share, start_tolerance<T>);
  laws_ = laws_of(*scene_);
  if (asked_->changes || asked_->forces) laws_.forget_what_is_kept();
  const bool may_be_off = scene_->settings.drift != Drift::projection || laws_.may_contradict;
  if (may_be_off && !(velocity_off(world) <= velocity_tolerance<T>))
    laws_.energy_kept = laws_.energy_falls = laws_.smooth = false;
  in_time_ = has_numbers_in_time(*scene_);
  starts_beyond_ = passed_share(world) > held_tolerance<T>;
  independence_ = independence(system_matrix(world), 8 * std::numeric_limits<T>::epsilon());
  middle_ = end_ = world.snapshot();
  Verdict seen = watch(world);
  seen.roughest = accounts_->roughest(), seen.length = sizes_.length, seen.fastest = accounts_->fastest();
  seen.judged_energy = laws_.energy_falls && seen.roughest <= resolved;
  seen.judged_momentum = laws_.momentum();
  if (seen.outcome != Outcome::held || !asked_->bits) return seen;
  const Verdict same = bits();
  return same.outcome == Outcome::held ? seen : same;
}

template <class S>
double Trial<S>::most_turned() {
  BasicWorld<S> world = started();
  sizes_ = row_sizes(world);  // push() needs them, too
  SystemMatrix before = system_matrix(world);
  double most = 0;
  for (int k = 1; k <= steps_; ++k) {
    push(world, k);
    if (!step(world, k)) break;
    SystemMatrix now = system_matrix(world);
    most = std::max(most, turned(before, now, sizes_.length));
    before = std::move(now);
  }
  return most;
}

template <class S>
Verdict judge_in(const Scene& scene, const Asked& asked) {
  try {
    return Trial<S>(scene, asked).run();
  } catch (const SceneError& error) {
    return verdict(Outcome::refused, error.what(), "");
  } catch (const Error& error) {
    return verdict(Outcome::refused, error.what(), "");
  } catch (const std::exception& error) {
    return verdict(Outcome::broken, "exception", error.what());
  }
}

}  // namespace

Verdict judge_once(const Scene& scene, const Asked& asked) {
  return in_space_of(scene, [&](auto space) { return judge_in<decltype(space)>(scene, asked); });
}

double most_turned(const Scene& scene, const Asked& asked) {
  return in_space_of(scene, [&](auto space) { return Trial<decltype(space)>(scene, asked).most_turned(); });
}

int steps_of(const Scene& scene) { return static_cast<int>(std::ceil(scene.duration / scene.step * (1 - 1e-12))); }

}  // namespace cdot::torture
