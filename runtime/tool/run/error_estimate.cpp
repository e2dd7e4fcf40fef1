#include "runtime/tool/run/error_estimate.hpp"

#include <algorithm>
#include <cmath>

#include <cdot/rotation.hpp>
#include <cdot/spaces.hpp>

#include "runtime/tool/scene/extent.hpp"

namespace cdot {
namespace {

// A sample costs three steps and going back. A short run has more than 5 % of its steps: fewer samples miss the error
// of a crank that turns fast.
constexpr long long steps_per_sample = 100, fewest_samples = 12;
// Of a finer step. A method that halves a step which it cannot solve would take the same parts of a half.
constexpr int parts = 3;
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
    : scene_(scene),
      share_(1 / (1 - std::pow(1.0 / parts, row_of(scene.settings.integrator).order))),
      spacing_(std::clamp(steps / fewest_samples, 1LL, steps_per_sample)),
      next_(scene.settings.local_error > 0 ? steps + 1 : (spacing_ + 1) / 2),
      sums_(scene.bodies.size()),
      size_(extents_of(scene).of_body) {
  for (const double size : size_) is_point_.push_back(size == 0);
}

template <class S>
bool ErrorEstimate<S>::take_finer_step(BasicWorld<S>& run, double h) {
  for (int k = 0; k < parts; ++k)
    if (!run.step(h / parts)) return false;
  return true;
}

template <class S>
void ErrorEstimate<S>::before_step(BasicWorld<S>& run, long long k, double h) {
  if (k != next_) return;
  run.snapshot_into(start_);
  finer_.clear();
  if (sweeps(scene_.settings.solver)) {
    if (!sweeper_) sweeper_ = build_world_in<S>(with_more_sweeps(scene_));
    sweeper_->restore(start_);
    if (sweeper_->step(h)) finer_ = states_of(*sweeper_, static_cast<int>(sums_.size()));
    return;
  }
  if (take_finer_step(run, h)) finer_ = states_of(run, static_cast<int>(sums_.size()));
  run.restore(start_);
}

template <class S>
void ErrorEstimate<S>::after_step(const Frame& before, const Frame& after, long long k) {
  if (k != next_) return;
  if (!finer_.empty()) {
    add(before, after, static_cast<double>(k - last_));
    last_ = k;
  }
  // Between half and one and a half of the spacing, spread evenly by the golden ratio: no multiple of a period.
  const double turns = 0.6180339887498949 * (error_.samples + 1);
  next_ = k + std::max(1LL, static_cast<long long>(static_cast<double>(spacing_) * (0.5 + turns - std::floor(turns))));
}

template <class S>
void ErrorEstimate<S>::add(const Frame& before, const Frame& after, double steps) {
  if (first_.bodies.empty()) first_ = before;
  const double h = after.time - before.time, scale = share_ * steps;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    const BodyState &from = before.bodies[k], &to = after.bodies[k], &better = finer_[k];
    add_to(sums_[k].position, minus(position(to), position(better)), scale);
    add_to(sums_[k].angle, turn(better, to), scale);
    add_to(sums_[k].velocity, minus(velocity(to), velocity(better)), scale);
    add_to(sums_[k].spin, minus(spin(to), spin(better)), scale);
    speeds_[0] += square(velocity(to)), speeds_[1] += square(spin(to));
    changes_[0] += square(minus(velocity(to), velocity(from))) / (h * h);
    changes_[1] += square(minus(spin(to), spin(from))) / (h * h);
  }
  ++error_.samples;
  const double linear = time_scale(speeds_[0], changes_[0], after.time),
               angular = time_scale(speeds_[1], changes_[1], after.time);
  for (std::size_t k = 0; k < sums_.size(); ++k) judge(after, k, linear, angular);
}

template <class S>
void ErrorEstimate<S>::judge(const Frame& after, std::size_t body, double linear, double angular) {
  double& size = size_[body];
  if (is_point_[body]) size = std::max(size, norm(minus(position(after.bodies[body]), position(first_.bodies[body]))));
  const Sums& sums = sums_[body];
  const double position = norm(sums.position) + linear * norm(sums.velocity);
  const double angle = std::min(half_turn, norm(sums.angle) + angular * norm(sums.spin));
  const double share = std::max(size > 0 ? position / size : 0, angle);
  if (share > error_.share) error_.share = share, error_.time = after.time, error_.body = static_cast<int>(body);
  error_.position = std::max(error_.position, position), error_.angle = std::max(error_.angle, angle);
}

#define CDOT_INSTANTIATE(S) template class ErrorEstimate<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
