#include "runtime/tool/run/error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <cdot/rotation.hpp>
#include <cdot/spaces.hpp>

#include "runtime/state/world_data.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

// Three steps as one tell more than four; in shorter runs they are dearer.
constexpr int steps_as_one = 3, steps_as_one_in_short = 4;
// Of a step. The midpoint rule halves a step that it cannot solve, and would take the same parts of a half.
constexpr int parts_of_one = 2, parts_of_halved = 3;
constexpr int more_substeps = 3, more_iterations = 4;
// All samples together cost at most this share of the run's steps, and a few steps more: what they take instead, and
// going back as one more each. The search for a sample goes on in shorter runs too: where a crank passes its dead
// centre, all of a run's error may be made in one step.
constexpr double affordable = 0.05, free_steps = 20, price_of_return = 1;
// Samples by parts are twice as dear, and RK4 asks for few others: in shorter runs they cost at most so many steps and
// a share more. The share is smaller for RK4, whose samples by rates cost next to nothing of theirs.
constexpr double free_parts = 6, free_share = 0.1, free_share_by_rates = 0.05;
// A run of up to some thousand steps has at most this many samples. A longer run has one within some steps. In a run of
// some dozen steps, where they are dearest, there are fewer, and more where one by rates costs no step. In runs of up
// to some dozen steps such a sample is shorter, so that it costs less to make anew.
constexpr long long usual_samples = 7, fewer_samples = 6, some_dozens[] = {40, 140}, by_rates_samples = 14,
                    most_spacing = 700;
// Of the difference that the sample before lets expect: what RATTLE's rounds may leave of C in a step that is taken to
// be compared.
constexpr double hardly = 0.03;
// Of the share that warns: an estimate by longer steps, or by rates, that promises more by the end of the run is made
// anew.
constexpr double doubted = 0.25, doubted_by_rates = 1;
constexpr double half_turn = 3.141592653589793;  // a larger error of an angle has no meaning

using Vector = std::array<double, 3>;

void add_to(Vector& sum, const Vector& a, double scale) {
  for (std::size_t k = 0; k < 3; ++k) sum[k] += scale * a[k];
}
double square(const Vector& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }
double norm(const Vector& a) { return std::sqrt(square(a)); }
Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector position(const BodyState& b) { return {b.x, b.y, b.z}; }
Vector velocity(const BodyState& b) { return {b.vx, b.vy, b.vz}; }
Vector spin(const BodyState& b) { return {b.wx, b.wy, b.wz + b.w}; }

template <class S>
Vector turn(const BodyState& from, const BodyState& to) {
  if (S::dimension == Dimension::planar) return {0, 0, to.angle - from.angle};
  const auto r = spatial::turn_between(orientation_of(from), orientation_of(to));
  return {r.x, r.y, r.z};
}

// The time in which a motion of these sums of squares changes, at most `most`.
double time_scale(double speed, double change, double most) {
  return change > 0 ? std::min(most, std::sqrt(speed / change)) : most;
}

template <class S>
long long divisions(const BasicWorld<S>& world) {
  return world.step_counts().retried + world.step_counts().rejected;
}

// Of samples by parts that cost `share` of the run more.
double budget_of_parts(long long steps, double share) {
  const auto count = static_cast<double>(steps);
  return affordable * count + std::min(free_parts + share * count, free_steps);
}

bool equal_steps(const Scene& scene) { return !(scene.settings.local_error > 0); }

Scene with_more_sweeps(Scene scene) {
  scene.settings.substeps *= more_substeps;
  scene.settings.iterations *= more_iterations;
  return scene;
}

}  // namespace

template <class S>
ErrorEstimate<S>::ErrorEstimate(const Scene& scene, long long steps)
    : scene_(scene),
      steps_(steps),
      warned_(warned_trajectory_share(scene)),
      rates_(steps < some_dozens[1] ? ErrorsByRates<S>::fewest : ErrorsByRates<S>::most),
      size_(extents_of(scene).of_body) {
  is_point_.reserve(size_.size());
  for (const double size : size_) is_point_.push_back(size == 0);
  total_.sums.resize(size_.size()), sample_.resize(size_.size());
  const Settings& settings = scene.settings;
  const bool divides = settings.integrator == Integrator::implicit;  // the midpoint rule does so unseen to long steps
  const bool exact = sizeof(typename S::Scalar) == sizeof(double);   // floats round by more than steps of RK4 err
  const bool tells = exact && settings.integrator == Integrator::rk4 && settings.substeps == 1;
  budget_ = divides ? budget_of_parts(steps, free_share)
            : tells ? budget_of_parts(steps, free_share_by_rates)
                    : affordable * static_cast<double>(steps) + free_steps;
  parts_ = divides ? parts_of_halved : parts_of_one;
  const bool whole = steps >= longest_window() && !divides;
  choose(sweeps(settings.solver)            ? By::more_sweeps
         : tells && steps >= rates_.steps() ? By::own_rates
         : whole                            ? By::longer_steps
                                            : By::shorter_steps);
  // A method that chooses its steps has an estimate of its own.
  next_ = equal_steps(scene) ? std::min((spacing_ + 1) / 2, steps - window_ + 1) : never();
}

template <class S>
int ErrorEstimate<S>::longest_window() const {
  return steps_ < some_dozens[1] ? steps_as_one_in_short : steps_as_one;
}

template <class S>
double ErrorEstimate<S>::price() const {
  if (by_ == By::own_rates) return price_of_return;
  return (by_ == By::more_sweeps ? more_substeps * more_iterations : steps_instead()) + price_of_return;
}

template <class S>
int ErrorEstimate<S>::steps_instead() const {
  return by_ == By::shorter_steps ? parts_ : 1;
}

template <class S>
void ErrorEstimate<S>::choose(By by) {
  by_ = by;
  window_ = by == By::own_rates ? rates_.steps() : by == By::longer_steps ? longest_window() : by == By::pairs ? 2 : 1;
  if (window_ <= 2 && by != By::more_sweeps) budget_ = std::min(budget_, spent_ + budget_of_parts(steps_, free_share));
  const auto paid = static_cast<long long>(budget_ / price());
  const bool dear = steps_ > some_dozens[0] && steps_ < some_dozens[1];
  const long long usual = dear ? fewer_samples : by == By::own_rates ? by_rates_samples : usual_samples;
  spacing_ = std::max({1LL, std::min(steps_ / usual, most_spacing), steps_ / std::max(1LL, paid)});
}

template <class S>
void ErrorEstimate<S>::find_next(long long k) {
  // Between half and one and a half of the spacing, spread evenly by the golden ratio: no multiple of a period.
  const double turns = 0.6180339887498949 * (total_.error.samples + 1);
  next_ = k + std::max(1LL, static_cast<long long>(static_cast<double>(spacing_) * (0.5 + turns - std::floor(turns))));
  if (spent_ + price() > budget_ || next_ + window_ - 1 > steps_) next_ = never();
}

// The steps taken instead come first: the World then goes back but once.
template <class S>
void ErrorEstimate<S>::before_step(BasicWorld<S>& run, long long k, double h) {
  if (k == 1) watches_ = equal_steps(scene_) && ReleaseWatch<S>::is_needed(run.data());
  if (watches_) releases_.before_step(run.data());
  if (k != next_) return;
  spent_ += price();
  run.snapshot_into(start_);
  length_ = h, taken_ = true;
  if (by_ == By::own_rates) return;
  const bool by_sweeps = by_ == By::more_sweeps;
  if (by_sweeps && !sweeper_) sweeper_ = build_world_in<S>(with_more_sweeps(scene_));
  if (by_sweeps) sweeper_->restore(start_);
  taken_ = take_instead(by_sweeps ? *sweeper_ : run, steps_instead(), error_of_step_ * window_);
  if (!by_sweeps) run.restore(start_);
  while (!taken_ && window_ > 1) take_fewer(run);
}

template <class S>
void ErrorEstimate<S>::take_fewer(BasicWorld<S>& run) {
  choose(window_ > 2 && steps_ < some_dozens[1] ? By::pairs : By::shorter_steps);
  spent_ += price();
  taken_ = take_instead(run, steps_instead());
  run.restore(start_);
}

template <class S>
bool ErrorEstimate<S>::take_instead(BasicWorld<S>& world, int steps, double expected) {
  const long long divided = divisions(world);
  const bool longer = steps < window_;
  const double parts = by_ == By::more_sweeps ? more_substeps : static_cast<double>(steps) / window_;
  share_ = 1 / (1 - std::pow(parts, -row_of(scene_.settings.integrator).order));
  world.data().enough = hardly * expected / std::abs(share_);
  world.data().at_once = longer;
  bool stepped = true;
  for (int k = 0; stepped && k < steps; ++k) stepped = bool(world.step(window_ * length_ / steps));
  world.data().enough = 0, world.data().at_once = false;
  if (!stepped) return false;
  instead_ = states_of(world, static_cast<int>(total_.sums.size()));
  return !longer || divisions(world) == divided;
}

template <class S>
bool ErrorEstimate<S>::accept(const Frame& before, const Frame& after, long long k, double most) {
  if (!taken_) return false;
  kept_ = total_;
  add(before, after, k);
  const double promised = total_.error.share * static_cast<double>(steps_) / static_cast<double>(k);
  if (window_ <= 2 || promised <= most * warned_) return true;
  std::swap(total_, kept_);
  return false;
}

template <class S>
void ErrorEstimate<S>::after_step(BasicWorld<S>& run, const Frame& before, const Frame& after, long long k) {
  if (k == 1) first_ = before;
  if (watches_) releases_.after_step(run.data(), after.time - before.time, after.time);
  if (k < next_) return;
  const bool by_rates = by_ == By::own_rates;
  if (by_rates) taken_ = taken_ && rates_.add(run.data(), static_cast<int>(k - next_), length_);
  if (k <= next_ + 1) firsts_[k - next_] = after.bodies;
  if (k != next_ + window_ - 1) return;
  if (by_rates && taken_) rates_.read(run.data(), sample_);
  else if (taken_) compare(after.bodies);
  bool accepted = accept(before, after, k, by_rates ? doubted_by_rates : doubted);
  if (by_rates && !taken_) {
    take_anew(run, after.bodies, window_ / 2);
    accepted = accept(before, after, k, doubted);
  }
  if (!accepted && window_ > 2) {
    run.snapshot_into(end_);
    run.restore(start_);
    for (taken_ = false; !taken_ && window_ > 1;) take_fewer(run);
    run.restore(end_);
    if (taken_) compare(firsts_[window_ - 1]), add(before, after, k);
  }
  find_next(k);
  if (taken_) last_ = k;
}

template <class S>
void ErrorEstimate<S>::take_anew(BasicWorld<S>& run, const std::vector<BodyState>& after, int steps) {
  spent_ += steps + 2 * price_of_return;
  run.snapshot_into(end_);
  run.restore(start_);
  taken_ = take_instead(run, steps);
  run.restore(end_);
  if (taken_) compare(after);
}

template <class S>
void ErrorEstimate<S>::finish(const Frame& last, long long steps) {
  if (total_.error.samples > 0 && steps > last_) add_sums(last, steps);
  if (!releases_.found().empty()) add_releases(last);
}

template <class S>
void ErrorEstimate<S>::compare(const std::vector<BodyState>& after) {
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    const BodyState &to = after[i], &other = instead_[i];
    sample_[i] = {};
    add_to(sample_[i].position, minus(position(to), position(other)), share_);
    add_to(sample_[i].angle, turn<S>(other, to), share_);
    add_to(sample_[i].velocity, minus(velocity(to), velocity(other)), share_);
    add_to(sample_[i].spin, minus(spin(to), spin(other)), share_);
  }
}

template <class S>
void ErrorEstimate<S>::add(const Frame& before, const Frame& after, long long k) {
  const double h = after.time - before.time;
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    const BodyState &from = before.bodies[i], &to = after.bodies[i];
    total_.speeds[0] += square(velocity(to)), total_.speeds[1] += square(spin(to));
    total_.changes[0] += square(minus(velocity(to), velocity(from))) / (h * h);
    total_.changes[1] += square(minus(spin(to), spin(from))) / (h * h);
  }
  ++total_.error.samples, window_of_sample_ = window_;
  add_sums(after, k);
  find_error_of_step();
}

template <class S>
void ErrorEstimate<S>::find_error_of_step() {
  double largest = 0, least_size = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sample_.size(); ++i) {
    largest = std::max(largest, norm(sample_[i].angle));
    if (!(size_[i] > 0)) continue;
    largest = std::max(largest, norm(sample_[i].position) / size_[i]);
    least_size = std::min(least_size, size_[i]);
  }
  error_of_step_ = std::isfinite(least_size) ? largest * least_size / window_ : 0;
}

template <class S>
void ErrorEstimate<S>::add_sums(const Frame& after, long long k) {
  const double scale = static_cast<double>(k - last_) / window_of_sample_;
  const TimeScales scales = time_scales(after);
  for (std::size_t body = 0; body < sample_.size(); ++body) {
    BodyError& sums = total_.sums[body];
    add_to(sums.position, sample_[body].position, scale), add_to(sums.angle, sample_[body].angle, scale);
    add_to(sums.velocity, sample_[body].velocity, scale), add_to(sums.spin, sample_[body].spin, scale);
    judge(after, body, scales);
  }
}

template <class S>
void ErrorEstimate<S>::add_releases(const Frame& last) {
  ++total_.error.samples;
  const TimeScales scales = time_scales(last);
  for (const auto& [time, index, free, error] : releases_.found()) {
    BodyError& sums = total_.sums[static_cast<std::size_t>(index)];
    const double left = last.time - time;
    add_to(sums.position, error.velocity, free ? left : std::min(scales.linear, left));
    add_to(sums.angle, error.spin, free ? left : std::min(scales.angular, left));
  }
  for (const Release& release : releases_.found()) judge(last, static_cast<std::size_t>(release.body), scales);
}

template <class S>
auto ErrorEstimate<S>::time_scales(const Frame& after) const -> TimeScales {
  return {time_scale(total_.speeds[0], total_.changes[0], after.time),
          time_scale(total_.speeds[1], total_.changes[1], after.time)};
}

template <class S>
void ErrorEstimate<S>::judge(const Frame& after, std::size_t body, const TimeScales& scales) {
  double& size = size_[body];
  if (is_point_[body]) size = std::max(size, norm(minus(position(after.bodies[body]), position(first_.bodies[body]))));
  const BodyError& sums = total_.sums[body];
  const double position = norm(sums.position) + scales.linear * norm(sums.velocity);
  const double angle = std::min(half_turn, norm(sums.angle) + scales.angular * norm(sums.spin));
  const double share = std::max(size > 0 ? position / size : 0, angle);
  TrajectoryError& error = total_.error;
  if (share > error.share) error.share = share, error.time = after.time, error.body = static_cast<int>(body);
  error.position = std::max(error.position, position), error.angle = std::max(error.angle, angle);
}

#define CDOT_INSTANTIATE(S) template class ErrorEstimate<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
