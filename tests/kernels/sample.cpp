#include "tests/kernels/sample.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace cdot {
namespace {

class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}
  // Not std::uniform_real_distribution, whose numbers differ from library to library.
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967296.0);
  }
  std::vector<double> many(std::size_t count, double low, double high) {
    std::vector<double> numbers(count);
    for (double& x : numbers) x = between(low, high);
    return numbers;
  }

 private:
  std::mt19937 generator_;
};

std::vector<double> random_parameters(const AnyBlock& block, Random& random) {
  std::vector<double> p;
  for (const ParameterInfo& info : block.parameters) {
    if (info.kind == ParameterKind::unit || info.kind == ParameterKind::frame) {
      const double angle = random.between(-3, 3);
      p.insert(p.end(), {std::cos(angle), std::sin(angle)});
    } else {
      const bool scalar = info.kind == ParameterKind::scalar;
      for (const double x :
           random.many(static_cast<std::size_t>(info.size), scalar ? 0.5 : -1, scalar ? 1.5 : 1)) {
        p.push_back(x);
      }
    }
  }
  return p;
}

void set_angle(double* pose, double angle) {
  pose[2] = std::cos(angle), pose[3] = std::sin(angle), pose[4] = angle;
}

void set_all(std::vector<double>& numbers, double value) {
  std::fill(numbers.begin(), numbers.end(), value);
}

}  // namespace

Inputs random_inputs(const AnyBlock& block, std::uint32_t seed) {
  Random random(seed);
  const auto n = static_cast<std::size_t>(block.bodies),
             rows = static_cast<std::size_t>(block.rows);
  Inputs in;
  in.q = random.many(5 * n, -2, 2);
  for (std::size_t b = 0; b < n; ++b) set_angle(&in.q[5 * b], random.between(-7, 7));
  in.v = random.many(3 * n, -1, 1);
  in.m = random.many(2 * n, 0.3, 3);
  in.p = random_parameters(block, random);
  in.lambda = random.many(rows, -1, 1);
  in.rhs = random.many(rows, -1, 1);
  in.time = {random.between(0, 2)};
  if (block.immovable >= 0) {
    const auto body = static_cast<std::size_t>(block.immovable);
    std::fill_n(&in.v[3 * body], 3, 0.0);
    std::fill_n(&in.m[2 * body], 2, 0.0);
  }
  return in;
}

std::vector<SingularInputs> singular_inputs(const AnyBlock& block, std::uint32_t seed) {
  const Inputs in = random_inputs(block, seed);
  std::vector<SingularInputs> all(6, {"", in});
  all[0].name = "every centre of mass in one place, all parameters zero";
  set_all(all[0].inputs.p, 0);
  for (std::size_t i = 0; i < in.q.size(); ++i) {
    if (i % 5 < 2) all[0].inputs.q[i] = 0.25;
  }
  all[1].name = "all parameters zero";
  set_all(all[1].inputs.p, 0);
  all[2].name = "everything at the origin, unturned, all parameters zero";
  set_all(all[2].inputs.p, 0);
  for (std::size_t i = 0; i < in.q.size(); ++i) all[2].inputs.q[i] = i % 5 == 2 ? 1 : 0;
  all[3].name = "every body in one pose, all points in one place";
  for (std::size_t i = 0; i < in.q.size(); ++i) all[3].inputs.q[i] = in.q[i % 5];
  for (const ParameterInfo& info : block.parameters) {
    if (info.kind == ParameterKind::point) {
      std::fill_n(&all[3].inputs.p[static_cast<std::size_t>(info.offset)], 2, 0.0);
    }
  }
  all[4].name = "every body immovable";
  set_all(all[4].inputs.m, 0);
  all[5].name = "distances whose squares underflow";
  for (std::size_t i = 0; i < in.q.size(); ++i) {
    if (i % 5 < 2) all[5].inputs.q[i] *= 1e-200;
  }
  for (double& x : all[5].inputs.p) x *= 1e-200;
  return all;
}

void move(Inputs& in, std::size_t column, double step) {
  double* pose = &in.q[5 * (column / 3)];
  if (column % 3 == 2) {
    set_angle(pose, pose[4] + step);
  } else {
    pose[column % 3] += step;
  }
}

}  // namespace cdot
