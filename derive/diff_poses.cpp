#include "derive/diff_poses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cdot::derive {
namespace {

constexpr int number_of_poses = 12;
constexpr double round_off = 1e-8;

// Every number of a sample that an equation may move: poses, scalars, components of fixed vectors.
std::vector<double*> variables_of(Sample& sample, std::size_t dimension) {
  std::vector<double*> variables;
  const auto take = [&](auto& numbers, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) variables.push_back(&numbers[k]);
  };
  for (Sample::Body& body : sample.bodies) {
    take(body.x, dimension);
    if (dimension == 2) variables.push_back(&body.theta);
    else take(body.e, 4);
  }
  for (auto& [name, value] : sample.scalars) variables.push_back(&value);
  for (auto& [name, value] : sample.local) take(value, dimension);
  for (auto& [triad, e] : sample.triads) take(e, 4);
  return variables;
}

template <class Numbers>
void normalise(Numbers& numbers) {
  double square = 0;
  for (const double x : numbers) square += x * x;
  for (double& x : numbers) x /= std::sqrt(square);
}

// Directions and Euler parameters keep the length 1 while they are moved.
void restore_unit_lengths(Sample& sample) {
  for (const Expr leaf : sample.leaves) {
    const auto found = sample.local.find(leaf->symbol);
    if (!leaf->unit_length || found == sample.local.end()) continue;
    normalise(found->second);
  }
  for (Sample::Body& body : sample.bodies) normalise(body.e);
  for (auto& [triad, e] : sample.triads) normalise(e);
}

std::vector<double> values_of(const Joint& joint, const std::vector<Expr>& expressions,
                              const Sample& sample) {
  Numbers numbers(world_values(joint, sample));
  std::vector<double> values;
  for (const Expr e : expressions) values.push_back(numbers.scalar(e));
  return values;
}

}  // namespace

Poses::Poses(const Joint& joint, std::vector<Expr> expressions) : joint_(&joint) {
  for (int i = 0; i < number_of_poses; ++i) {
    Sample sample = random_sample(joint, expressions, 1000 + static_cast<std::uint64_t>(i));
    // Ratios come with both signs; lengths, masses and what is declared free are positive.
    for (const Parameter& p : joint.parameters) {
      const auto found = sample.scalars.find(p.name);
      if (p.unit == Unit{} && i % 2 == 1 && found != sample.scalars.end()) found->second *= -1;
    }
    samples_.push_back(std::move(sample));
  }
}

bool Poses::satisfy(const std::vector<Expr>& equations, Sample& sample) const {
  // Gauss-Newton with the smallest step: dx = -G^T (G G^T)^-1 e, one equation after the other (Kaczmarz), repeated.
  for (int sweep = 0; sweep < 40; ++sweep) {
    double worst = 0;
    for (const Expr equation : equations) {
      const auto value = [&] { return values_of(*joint_, {equation}, sample)[0]; };
      const double residual = value();
      worst = std::max(worst, std::abs(residual));
      if (std::abs(residual) < 1e-13) continue;
      const std::vector<double*> variables = variables_of(sample, static_cast<std::size_t>(joint_->dimension));
      std::vector<double> gradient;
      double square = 0;
      for (double* x : variables) {
        const double kept = *x, step = 1e-6;
        *x = kept + step;
        const double above = value();
        *x = kept - step;
        const double below = value();
        *x = kept;
        gradient.push_back((above - below) / (2 * step));
        square += gradient.back() * gradient.back();
      }
      if (!(square > 1e-20)) return false;
      for (std::size_t i = 0; i < variables.size(); ++i) *variables[i] -= residual * gradient[i] / square;
      restore_unit_lengths(sample);
    }
    if (worst < 1e-12) return true;
  }
  return false;
}

Poses Poses::where(const std::vector<Expr>& equations) const {
  Poses moved = *this;
  moved.samples_.clear();
  for (Sample sample : samples_) {
    if (satisfy(equations, sample)) moved.samples_.push_back(std::move(sample));
  }
  if (moved.samples_.size() * 2 < samples_.size()) moved.samples_.clear();
  return moved;
}

Poses Poses::first(std::size_t count) const {
  Poses few = *this;
  few.samples_.resize(std::min(count, few.samples_.size()));
  return few;
}

bool Poses::equal(Expr a, Expr b) const {
  if (samples_.empty()) return false;
  return std::all_of(samples_.begin(), samples_.end(), [&](const Sample& sample) {
    const std::vector<double> v = values_of(*joint_, {a, b}, sample);
    return std::abs(v[0] - v[1]) <= round_off * (1 + std::abs(v[0]) + std::abs(v[1]));
  });
}

std::optional<double> Poses::constant_ratio(Expr a, Expr b) const {
  std::optional<double> ratio;
  for (const Sample& sample : samples_) {
    const std::vector<double> v = values_of(*joint_, {a, b}, sample);
    if (std::abs(v[1]) < 1e-6) continue;
    const double k = v[0] / v[1];
    if (ratio && std::abs(k - *ratio) > 1e-7 * (1 + std::abs(k))) return std::nullopt;
    ratio = k;
  }
  return ratio;
}

Poses::Errors Poses::against(const Measure& measured, Expr derived, Expr published) const {
  Errors errors;
  for (const Sample& sample : samples_) {
    const double truth = measured(sample);
    const std::vector<double> v = values_of(*joint_, {derived, published}, sample);
    errors.derived = std::max(errors.derived, std::abs(v[0] - truth) / (1 + std::abs(truth)));
    errors.published = std::max(errors.published, std::abs(v[1] - truth) / (1 + std::abs(truth)));
    ++errors.poses;
  }
  return errors;
}

std::vector<double> measured_row(const Joint& joint, Expr C, const Sample& sample) {
  constexpr double step = 1e-6;
  std::vector<double> row;
  for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
    for (std::size_t k = 0; k < columns_per_body(joint.dimension); ++k) {
      Sample above = sample, below = sample;
      above.bodies[b].move(joint.dimension, k, step);
      below.bodies[b].move(joint.dimension, k, -step);
      row.push_back((values_of(joint, {C}, above)[0] - values_of(joint, {C}, below)[0]) / (2 * step));
    }
  }
  return row;
}

}  // namespace cdot::derive
