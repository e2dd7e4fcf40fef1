#include "derive/diff_poses.hpp"

#include <algorithm>
#include <cmath>

#include "derive/newton.hpp"

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
    if (dimension == 2)
      variables.push_back(&body.theta);
    else
      take(body.e, 4);
  }
  for (auto& [name, value] : sample.scalars) variables.push_back(&value);
  for (auto& [name, value] : sample.local) {
    if (!name.starts_with("world.") && !name.starts_with("axis_")) take(value, dimension);
  }
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
    if (leaf->unit_length && found != sample.local.end()) normalise(found->second);
  }
  for (Sample::Body& body : sample.bodies) normalise(body.e);
  for (auto& [triad, e] : sample.triads) normalise(e);
}

// What is positive by its nature, and still is: masses, and symbols that an entry declares free.
bool still_positive(const Sample& sample) {
  return std::none_of(sample.leaves.begin(), sample.leaves.end(), [&](Expr leaf) {
    const bool positive = leaf->role == Role::given || leaf->role == Role::inverse_mass;
    const auto found = sample.scalars.find(leaf->symbol);
    return positive && found != sample.scalars.end() && found->second <= 0;
  });
}

double largest(const std::vector<double>& numbers) {
  double most = 0;
  for (const double x : numbers) most = std::max(most, std::isfinite(x) ? std::abs(x) : HUGE_VAL);
  return most;
}

Gradients gradients_of(const Joint& joint, const std::vector<Expr>& equations, Sample& sample) {
  constexpr double step = 1e-6;
  Gradients G(equations.size());
  for (double* x : variables_of(sample, static_cast<std::size_t>(joint.dimension))) {
    const double kept = *x;
    *x = kept + step;
    const std::vector<double> above = values_at(joint, equations, sample);
    *x = kept - step;
    const std::vector<double> below = values_at(joint, equations, sample);
    *x = kept;
    for (std::size_t i = 0; i < G.size(); ++i) G[i].push_back((above[i] - below[i]) / (2 * step));
  }
  return G;
}

}  // namespace

std::vector<double> values_at(const Joint& joint, const std::vector<Expr>& scalars,
                              const Sample& sample) {
  Numbers numbers(world_values(joint, sample));
  std::vector<double> values;
  for (const Expr e : scalars) values.push_back(numbers.scalar(e));
  return values;
}

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

// Gauss-Newton with the shortest step, halved while it does not help.
bool Poses::satisfy(Sample& sample) const {
  constexpr double reached = 1e-12;
  double error = largest(values_at(*joint_, equations_, sample));
  for (int iteration = 0; iteration < 40 && error > reached; ++iteration) {
    const std::vector<double> residual = values_at(*joint_, equations_, sample);
    const std::vector<double> step =
        shortest_step(gradients_of(*joint_, equations_, sample), residual);
    double fraction = 1;
    for (; fraction > 1e-3; fraction /= 2) {
      Sample moved = sample;
      const std::vector<double*> variables =
          variables_of(moved, static_cast<std::size_t>(joint_->dimension));
      for (std::size_t i = 0; i < variables.size(); ++i) *variables[i] += fraction * step[i];
      restore_unit_lengths(moved);
      const double moved_error = largest(values_at(*joint_, equations_, moved));
      if (!(moved_error < error)) continue;
      sample = std::move(moved);
      error = moved_error;
      break;
    }
    if (fraction <= 1e-3) return false;
  }
  return error <= reached && still_positive(sample);
}

Poses Poses::where(const std::vector<Expr>& equations) const {
  Poses moved = *this;
  moved.samples_.clear();
  moved.equations_.insert(moved.equations_.end(), equations.begin(), equations.end());
  for (Sample sample : samples_) {
    if (moved.satisfy(sample)) moved.samples_.push_back(std::move(sample));
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
    const std::vector<double> v = values_at(*joint_, {a, b}, sample);
    return std::abs(v[0] - v[1]) <= round_off * (1 + std::abs(v[0]) + std::abs(v[1]));
  });
}

std::optional<double> Poses::constant_ratio(Expr a, Expr b) const {
  std::optional<double> ratio;
  for (const Sample& sample : samples_) {
    const std::vector<double> v = values_at(*joint_, {a, b}, sample);
    if (std::abs(v[1]) < 1e-6) continue;
    const double k = v[0] / v[1];
    if (ratio && std::abs(k - *ratio) > 1e-7 * (1 + std::abs(k))) return std::nullopt;
    ratio = k;
  }
  return ratio;
}

}  // namespace cdot::derive
