#include "runtime/tool/run/error_estimate.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/rotation.hpp>
#include <cdot/spaces.hpp>

#include "runtime/tool/run/error_report.hpp"
#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

// Steps taken as one, and parts of one. A method that halves a step which it cannot solve would take the same parts of
// a half.
constexpr int parts = 3;
// A sample costs some steps and going back twice. A run of some hundred steps has this many samples, of three steps or
// of one: fewer miss the error of a crank that turns fast. A longer run has one within some steps.
constexpr long long usual_samples = 7, usual_samples_of_one = 12, most_spacing = 140;
// Of the share that warns: an estimate by longer steps that promises more by the end of the run is made anew.
constexpr double doubted = 0.25;
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

Vector turn(const BodyState& from, const BodyState& to) {
  const auto r = spatial::turn_between(orientation_of(from), orientation_of(to));
  return {r.x, r.y, r.z + to.angle - from.angle};
}

// The time in which a motion of these sums of squares changes, at most `most`.
double time_scale(double speed, double change, double most) {
  return change > 0 ? std::min(most, std::sqrt(speed / change)) : most;
}

Scene with_more_sweeps(Scene scene) {
  scene.settings.substeps *= parts;
  scene.settings.iterations *= 4;
  return scene;
}

}  // namespace

template <class S>
ErrorEstimate<S>::ErrorEstimate(const Scene& scene, long long steps)
    : scene_(scene), steps_(steps), warned_(warned_trajectory_share(scene)), size_(extents_of(scene).of_body) {
  for (const double size : size_) is_point_.push_back(size == 0);
  total_.sums.resize(size_.size());
  // The midpoint rule divides long steps unseen.
  const bool whole = steps >= parts && scene.settings.integrator != Integrator::implicit;
  choose(sweeps(scene.settings.solver) ? By::more_sweeps : whole ? By::longer_steps : By::shorter_steps);
  // A method that chooses its steps has an estimate of its own.
  next_ = scene.settings.local_error > 0 ? steps + 1 : std::min((spacing_ + 1) / 2, steps - window_ + 1);
}

template <class S>
void ErrorEstimate<S>::choose(By by) {
  by_ = by;
  window_ = by == By::longer_steps ? parts : 1;
  const long long samples = by == By::longer_steps ? usual_samples : usual_samples_of_one;
  spacing_ = std::clamp(steps_ / samples, 1LL, most_spacing);
}

// The steps taken instead come first: the World then goes back but once.
template <class S>
void ErrorEstimate<S>::before_step(BasicWorld<S>& run, long long k, double h) {
  if (k != next_) return;
  run.snapshot_into(start_);
  length_ = h;
  const bool by_sweeps = by_ == By::more_sweeps;
  if (by_sweeps && !sweeper_) sweeper_ = build_world_in<S>(with_more_sweeps(scene_));
  if (by_sweeps) sweeper_->restore(start_);
  taken_ = take_instead(by_sweeps ? *sweeper_ : run, by_ == By::shorter_steps ? parts : 1);
  if (!by_sweeps) run.restore(start_);
}

// From the start of the window on.
template <class S>
bool ErrorEstimate<S>::take_instead(BasicWorld<S>& world, int steps) {
  const long long divided = world.step_counts().retried;
  for (int k = 0; k < steps; ++k)
    if (!world.step(window_ * length_ / steps)) return false;
  instead_ = states_of(world, static_cast<int>(total_.sums.size()));
  return by_ != By::longer_steps || world.step_counts().retried == divided;
}

template <class S>
double ErrorEstimate<S>::weight(int steps, long long k) const {
  const double shorter = by_ == By::more_sweeps ? parts : static_cast<double>(steps) / window_;
  const double share = 1 / (1 - std::pow(shorter, -row_of(scene_.settings.integrator).order));
  return share * static_cast<double>(k - last_) / window_;
}

template <class S>
void ErrorEstimate<S>::after_step(BasicWorld<S>& run, const Frame& before, const Frame& after, long long k) {
  if (k != next_ + window_ - 1) return;
  const Total kept = total_;
  if (taken_) add(before, after, weight(by_ == By::shorter_steps ? parts : 1, k));
  const double promised = total_.error.share * static_cast<double>(steps_) / static_cast<double>(k);
  if (by_ == By::longer_steps && (!taken_ || promised > doubted * warned_)) {
    total_ = kept;
    by_ = By::shorter_steps;
    run.snapshot_into(end_);
    run.restore(start_);
    taken_ = take_instead(run, parts * window_);
    if (taken_) add(before, after, weight(parts * window_, k));
    run.restore(end_);
    choose(by_);
  }
  if (taken_) last_ = k;
  // Between half and one and a half of the spacing, spread evenly by the golden ratio: no multiple of a period.
  const double turns = 0.6180339887498949 * (total_.error.samples + 1);
  next_ = k + std::max(1LL, static_cast<long long>(static_cast<double>(spacing_) * (0.5 + turns - std::floor(turns))));
}

template <class S>
void ErrorEstimate<S>::add(const Frame& before, const Frame& after, double scale) {
  if (first_.bodies.empty()) first_ = before;
  const double h = after.time - before.time;
  for (std::size_t k = 0; k < total_.sums.size(); ++k) {
    const BodyState &from = before.bodies[k], &to = after.bodies[k], &other = instead_[k];
    add_to(total_.sums[k].position, minus(position(to), position(other)), scale);
    add_to(total_.sums[k].angle, turn(other, to), scale);
    add_to(total_.sums[k].velocity, minus(velocity(to), velocity(other)), scale);
    add_to(total_.sums[k].spin, minus(spin(to), spin(other)), scale);
    total_.speeds[0] += square(velocity(to)), total_.speeds[1] += square(spin(to));
    total_.changes[0] += square(minus(velocity(to), velocity(from))) / (h * h);
    total_.changes[1] += square(minus(spin(to), spin(from))) / (h * h);
  }
  ++total_.error.samples;
  const double linear = time_scale(total_.speeds[0], total_.changes[0], after.time),
               angular = time_scale(total_.speeds[1], total_.changes[1], after.time);
  for (std::size_t k = 0; k < total_.sums.size(); ++k) judge(after, k, linear, angular);
}

template <class S>
void ErrorEstimate<S>::judge(const Frame& after, std::size_t body, double linear, double angular) {
  double& size = size_[body];
  if (is_point_[body]) size = std::max(size, norm(minus(position(after.bodies[body]), position(first_.bodies[body]))));
  const Sums& sums = total_.sums[body];
  const double position = norm(sums.position) + linear * norm(sums.velocity);
  const double angle = std::min(half_turn, norm(sums.angle) + angular * norm(sums.spin));
  const double share = std::max(size > 0 ? position / size : 0, angle);
  TrajectoryError& error = total_.error;
  if (share > error.share) error.share = share, error.time = after.time, error.body = static_cast<int>(body);
  error.position = std::max(error.position, position), error.angle = std::max(error.angle, angle);
}

#define CDOT_INSTANTIATE(S) template class ErrorEstimate<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
