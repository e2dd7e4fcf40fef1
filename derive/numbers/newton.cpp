#include "derive/numbers/newton.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "derive/numbers/elimination.hpp"

namespace cdot::derive {
namespace {

// The unknowns: bodies; if wanted, also scalars, and vectors and triads in their frames. Directions and orientations
// are rotated, which preserves their length.
class Variables {
 public:
  Variables(const Joint& joint, const Sample& sample, bool only_bodies) : dimension_(joint.dimension) {
    const std::size_t linear = static_cast<std::size_t>(dimension_), turns = dimension_ == 2 ? 1 : 3;
    for (std::size_t b = 0; b < sample.bodies.size(); ++b) {
      for (std::size_t k = 0; k < linear + turns; ++k) {
        add([=, this](Sample& s, double by) { s.bodies[b].move(dimension_, k, by); });
      }
    }
    if (only_bodies) return;
    std::set<std::string> directions;
    for (const Expr leaf : sample.leaves) {
      if (leaf->unit_length) directions.insert(leaf->symbol);
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

double largest(const std::vector<double>& numbers) {
  double most = 0;
  for (const double x : numbers) most = std::max(most, std::isfinite(x) ? std::abs(x) : HUGE_VAL);
  return most;
}

template <class Equations>
Gradients central_differences(const Equations& equations, const Variables& variables, const Sample& sample) {
  constexpr double step = 1e-6;
  Gradients G;
  Sample moved;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const auto beside = [&](double by) {
      moved = sample;
      variables.move(moved, v, by);
      return equations(moved);
    };
    const std::vector<double> above = beside(step), below = beside(-step);
    G.resize(above.size());
    for (std::size_t i = 0; i < G.size(); ++i) G[i].push_back((above[i] - below[i]) / (2 * step));
  }
  return G;
}

// Gauss-Newton with the shortest step, halved while it does not help.
template <class Gradient>
bool descend(const Variables& variables, const Residuals& values, Sample& sample, Gradient gradients) {
  constexpr double reached = 1e-12, round_off_of_sums = 1e-11;  // of equations that depend on each other
  double error = largest(values(sample));
  for (int iteration = 0; iteration < 60 && error > reached; ++iteration) {
    const std::vector<double> step = shortest_step(gradients(), values(sample));
    double fraction = 1;
    for (; fraction > 1e-3; fraction /= 2) {
      Sample moved = sample;
      for (std::size_t i = 0; i < step.size(); ++i) variables.move(moved, i, fraction * step[i]);
      const double moved_error = largest(values(moved));
      if (!(moved_error < error)) continue;
      sample = std::move(moved);
      error = moved_error;
      break;
    }
    if (fraction <= 1e-3) break;
  }
  return error <= round_off_of_sums;
}

}  // namespace

std::vector<double> shortest_step(const Gradients& G, const std::vector<double>& values) {
  const std::size_t n = G.size();
  if (n == 0) return {};
  Gradients K(n, std::vector<double>(n));
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < G[i].size(); ++k) K[i][j] += G[i][k] * G[j][k];
    }
    largest = std::max(largest, K[i][i]);
  }
  for (std::size_t i = 0; i < n; ++i) K[i][i] += 1e-13 * largest;
  // The small diagonal term makes the symmetric positive K regular.
  const std::vector<double> lambda =
      solved(K, values, [](double a, double pivot) { return pivot == 0 ? 0 : a / pivot; });
  std::vector<double> step(G[0].size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < step.size(); ++k) step[k] -= G[i][k] * lambda[i];
  }
  return step;
}

std::vector<const Triad*> triads_of(const Joint& joint, const Sample& sample) {
  std::vector<const Triad*> triads;
  for (const Expr leaf : sample.leaves) {
    const Triad* triad = joint.pool->axis_of(leaf).triad;
    const bool known = std::find(triads.begin(), triads.end(), triad) != triads.end();
    if (sample.triads.contains(triad) && !known) triads.push_back(triad);
  }
  return triads;
}

bool move_to_zero(const Joint& joint, const std::vector<Expr>& equations, Sample& sample,
                  const std::vector<std::vector<Expr>>& J) {
  const Variables variables(joint, sample, !J.empty());
  Numbers numbers(sample);
  const auto values = [&](const Sample& there) {
    numbers.move_to(there);
    return numbers.of(equations);
  };
  return descend(variables, values, sample, [&] {
    if (J.empty()) return central_differences(values, variables, sample);
    Gradients G;
    for (const std::vector<Expr>& row : J) G.push_back(values_at(row, sample));
    return G;
  });
}

bool move_to_zero(const Joint& joint, const Residuals& residuals, Sample& sample, bool only_bodies) {
  const Variables variables(joint, sample, only_bodies);
  return descend(variables, residuals, sample, [&] { return central_differences(residuals, variables, sample); });
}

}  // namespace cdot::derive
