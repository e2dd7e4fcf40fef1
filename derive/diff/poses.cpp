#include "derive/diff/poses.hpp"

#include <algorithm>
#include <cmath>

#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

constexpr int number_of_poses = 12;
constexpr double round_off = 1e-8;

// Masses, and symbols that an entry declares free.
bool is_positive(const Sample& sample) {
  return std::none_of(sample.leaves.begin(), sample.leaves.end(), [&](Expr leaf) {
    const bool positive = (leaf->role == Role::given && leaf->body < 0) || leaf->role == Role::inverse_mass;
    const auto found = sample.scalars.find(leaf->symbol);
    return positive && found != sample.scalars.end() && found->second <= 0;
  });
}

}  // namespace

Poses::Poses(const Joint& joint, std::vector<Expr> expressions) : joint_(&joint) {
  for (int i = 0; i < number_of_poses; ++i) {
    Sample sample = random_sample(joint, expressions, 1000 + static_cast<std::uint64_t>(i));
    // Ratios have both signs; lengths, masses and free symbols are positive.
    for (const Parameter& p : joint.parameters) {
      const auto found = sample.scalars.find(p.name);
      if (p.unit == Unit{} && i % 2 == 1 && found != sample.scalars.end()) found->second *= -1;
    }
    samples_.push_back(std::move(sample));
  }
}

// Equations on rotations also have solutions that differ by pi; from nearly equal orientations Newton avoids them.
Poses Poses::aligned() const {
  if (joint_->dimension == 2) return *this;
  Poses poses = *this;
  Random random(7);
  const auto nearly = [&](EulerParameters<double> e) {
    for (std::size_t k = 0; k < 3; ++k) e = turned_about(k, random.between(-0.3, 0.3), e);
    return e;
  };
  for (Sample& sample : poses.samples_) {
    const EulerParameters<double> first = sample.bodies[0].e;
    for (Sample::Body& body : sample.bodies) body.e = nearly(first);
    const std::vector<const Triad*> triads = triads_of(*joint_, sample);
    for (const Triad* triad : triads) sample.triads.at(triad) = nearly(sample.triads.at(triads[0]));
  }
  return poses;
}

// A free symbol stays positive, unless the entry's assumptions forbid it.
Poses Poses::where(const std::vector<Expr>& equations) const {
  Poses moved = *this;
  moved.samples_.clear();
  moved.equations_.insert(moved.equations_.end(), equations.begin(), equations.end());
  std::vector<Sample> others;
  for (Sample sample : samples_) {
    const bool positive = is_positive(sample);
    if (!move_to_zero(*joint_, moved.equations_, sample)) continue;
    (is_positive(sample) || !positive ? moved.samples_ : others).push_back(std::move(sample));
  }
  const auto too_few = [&] { return moved.samples_.size() * 2 < samples_.size(); };
  if (too_few() && equations_.empty()) {
    moved.samples_.insert(moved.samples_.end(), others.begin(), others.end());
  }
  if (too_few()) moved.samples_.clear();
  return moved;
}

Poses Poses::first(std::size_t count) const {
  Poses few = *this;
  few.samples_.resize(std::min(count, few.samples_.size()));
  return few;
}

// Doubles decide under equations, since no points modulo a prime are known to satisfy them. They also decide for signs,
// logarithms and angles, which only real numbers have.
bool Poses::equal(Expr a, Expr b) const {
  if (samples_.empty()) return false;
  const Nullity difference = equations_.empty() ? difference_modulo_prime(a, b) : Nullity::unknown;
  if (difference != Nullity::unknown) return difference == Nullity::zero;
  return std::all_of(samples_.begin(), samples_.end(), [&](const Sample& sample) {
    const std::vector<double> v = values_at({a, b}, sample);
    return std::abs(v[0] - v[1]) <= round_off * (1 + std::abs(v[0]) + std::abs(v[1]));
  });
}

std::optional<double> Poses::constant_ratio(Expr a, Expr b) const {
  std::optional<double> ratio;
  for (const Sample& sample : samples_) {
    const std::vector<double> v = values_at({a, b}, sample);
    if (std::abs(v[1]) < 1e-6) continue;
    const double k = v[0] / v[1];
    if (ratio && std::abs(k - *ratio) > 1e-7 * (1 + std::abs(k))) return std::nullopt;
    ratio = k;
  }
  return ratio;
}

}  // namespace cdot::derive
