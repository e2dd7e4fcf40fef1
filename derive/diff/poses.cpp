#include "derive/diff/poses.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "derive/numbers/newton.hpp"

namespace cdot::derive {
namespace {

constexpr int number_of_poses = 12;
constexpr double round_off = 1e-8;

// In the order of their names, and not of addresses.
std::vector<const Triad*> triads_of(const Joint& joint, const Sample& sample) {
  std::vector<const Triad*> triads;
  for (const Expr leaf : sample.leaves) {
    const Triad* triad = joint.pool->axis_of(leaf).triad;
    const bool known = std::find(triads.begin(), triads.end(), triad) != triads.end();
    if (sample.triads.contains(triad) && !known) triads.push_back(triad);
  }
  return triads;
}

// All that an equation may move: bodies, scalars, vectors and triads that are fixed somewhere.
// Directions and orientations are turned, so that they keep their length.
class Variables {
 public:
  Variables(const Joint& joint, const Sample& sample) : dimension_(joint.dimension) {
    std::set<std::string> directions;
    for (const Expr leaf : sample.leaves) {
      if (leaf->unit_length) directions.insert(leaf->symbol);
    }
    const std::size_t linear = static_cast<std::size_t>(dimension_), turns = dimension_ == 2 ? 1 : 3;
    for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
      for (std::size_t k = 0; k < linear + turns; ++k) {
        add([=, this](Sample& s, double by) { s.bodies[b].move(dimension_, k, by); });
      }
    }
    // `name = name`: Clang 14 cannot capture a structured binding otherwise.
    for (const auto& [name, value] : sample.scalars) {
      add([name = name](Sample& s, double by) { s.scalars.at(name) += by; });
    }
    for (const auto& [name, value] : sample.local) {
      if (name.starts_with("world.") || name.starts_with("axis_")) continue;
      const bool direction = directions.contains(name);
      for (std::size_t k = 0; k < (direction ? turns : linear); ++k) {
        add([=, this, name = name](Sample& s, double by) {
          Triple<double>& u = s.local.at(name);
          direction ? turn(u, k, by) : void(u[k] += by);
        });
      }
    }
    for (const Triad* triad : triads_of(joint, sample)) {
      for (std::size_t k = 0; k < 3; ++k) {
        add([=](Sample& s, double by) { s.triads.at(triad) = turned_about(k, by, s.triads.at(triad)); });
      }
    }
  }

  std::size_t size() const { return moves_.size(); }
  void move(Sample& sample, std::size_t i, double by) const { moves_[i](sample, by); }

 private:
  void add(std::function<void(Sample&, double)> move) { moves_.push_back(std::move(move)); }

  void turn(Triple<double>& u, std::size_t axis, double by) const {
    const std::size_t i = dimension_ == 2 ? 0 : (axis + 1) % 3, j = dimension_ == 2 ? 1 : (axis + 2) % 3;
    const double x = u[i], y = u[j], c = std::cos(by), s = std::sin(by);
    u[i] = c * x - s * y;
    u[j] = s * x + c * y;
  }

  int dimension_;
  std::vector<std::function<void(Sample&, double)>> moves_;
};

// Masses, and symbols that an entry declares free.
bool is_positive(const Sample& sample) {
  return std::none_of(sample.leaves.begin(), sample.leaves.end(), [&](Expr leaf) {
    const bool positive = (leaf->role == Role::given && leaf->body < 0) || leaf->role == Role::inverse_mass;
    const auto found = sample.scalars.find(leaf->symbol);
    return positive && found != sample.scalars.end() && found->second <= 0;
  });
}

double largest(const std::vector<double>& numbers) {
  double most = 0;
  for (const double x : numbers) most = std::max(most, std::isfinite(x) ? std::abs(x) : HUGE_VAL);
  return most;
}

Gradients gradients_of(const Joint& joint, const std::vector<Expr>& equations, const Variables& variables,
                       const Sample& sample) {
  constexpr double step = 1e-6;
  Gradients G(equations.size());
  for (std::size_t v = 0; v < variables.size(); ++v) {
    Sample moved = sample;
    variables.move(moved, v, step);
    const std::vector<double> above = values_at(joint, equations, moved);
    moved = sample;
    variables.move(moved, v, -step);
    const std::vector<double> below = values_at(joint, equations, moved);
    for (std::size_t i = 0; i < G.size(); ++i) G[i].push_back((above[i] - below[i]) / (2 * step));
  }
  return G;
}

}  // namespace

std::vector<double> values_at(const Joint& joint, const std::vector<Expr>& scalars, const Sample& sample) {
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
  const Variables variables(*joint_, sample);
  double error = largest(values_at(*joint_, equations_, sample));
  for (int iteration = 0; iteration < 60 && error > reached; ++iteration) {
    const std::vector<double> residual = values_at(*joint_, equations_, sample);
    const std::vector<double> step = shortest_step(gradients_of(*joint_, equations_, variables, sample), residual);
    double fraction = 1;
    for (; fraction > 1e-3; fraction /= 2) {
      Sample moved = sample;
      for (std::size_t i = 0; i < step.size(); ++i) variables.move(moved, i, fraction * step[i]);
      const double moved_error = largest(values_at(*joint_, equations_, moved));
      if (!(moved_error < error)) continue;
      sample = std::move(moved);
      error = moved_error;
      break;
    }
    if (fraction <= 1e-3) break;
  }
  constexpr double round_off_of_sums = 1e-11;  // of equations that depend on each other
  return error <= round_off_of_sums;
}

// Rotations vanish also where one turns by pi; from almost the same orientations the next solution
// is that without.
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

// A symbol that an entry declares free stays positive, unless what the entry assumes does not let
// it.
Poses Poses::where(const std::vector<Expr>& equations) const {
  Poses moved = *this;
  moved.samples_.clear();
  moved.equations_.insert(moved.equations_.end(), equations.begin(), equations.end());
  std::vector<Sample> others;
  for (Sample sample : samples_) {
    const bool positive = is_positive(sample);
    if (!moved.satisfy(sample)) continue;
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
