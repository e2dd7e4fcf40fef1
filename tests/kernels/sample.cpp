#include "tests/kernels/sample.hpp"

#include <Eigen/Geometry>
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

Eigen::Quaterniond random_turn(Random& random) {
  const std::vector<double> e = random.many(4, -1, 1);
  return Eigen::Quaterniond(e[0], e[1], e[2], e[3]).normalized();
}

// The first `numbers` numbers of the axes of a random frame, one axis after the other.
std::vector<double> random_axes(const AnyBlock& block, int numbers, Random& random) {
  if (block.planar()) {
    const double angle = random.between(-3, 3);
    return {std::cos(angle), std::sin(angle)};
  }
  const Eigen::Matrix3d axes = random_turn(random).toRotationMatrix();
  return {axes.data(), axes.data() + numbers};
}

std::vector<double> random_parameters(const AnyBlock& block, Random& random) {
  std::vector<double> p;
  for (const ParameterInfo& info : block.parameters) {
    if (info.kind == ParameterKind::unit || info.kind == ParameterKind::frame) {
      const std::vector<double> axes = random_axes(block, info.size, random);
      p.insert(p.end(), axes.begin(), axes.end());
    } else {
      const bool scalar = info.kind == ParameterKind::scalar;
      for (const double x : random.many(static_cast<std::size_t>(info.size), scalar ? 0.5 : -1, scalar ? 1.5 : 1)) {
        p.push_back(x);
      }
    }
  }
  return p;
}

void set_angle(double* pose, double angle) { pose[2] = std::cos(angle), pose[3] = std::sin(angle), pose[4] = angle; }

void set_orientation(double* pose, const Eigen::Quaterniond& e) {
  cdot::set_orientation(pose, Eigen::Vector4d(e.w(), e.x(), e.y(), e.z()));
}

void set_random_orientation(const AnyBlock& block, double* pose, Random& random) {
  if (block.planar()) {
    set_angle(pose, random.between(-7, 7));
  } else {
    set_orientation(pose, random_turn(random));
  }
}

void unturn(const AnyBlock& block, double* pose) {
  if (block.planar()) {
    set_angle(pose, 0);
  } else {
    set_orientation(pose, Eigen::Quaterniond::Identity());
  }
}

void turn(const AnyBlock& block, double* pose, const Eigen::Vector3d& axis, double angle) {
  if (block.planar()) {
    set_angle(pose, pose[4] + angle);
  } else {
    const Eigen::Quaterniond e(pose[3], pose[4], pose[5], pose[6]);
    set_orientation(pose, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)) * e);
  }
}

// Inverse masses and, in space, positive definite inverse inertia tensors.
std::vector<double> random_masses(const AnyBlock& block, Random& random) {
  std::vector<double> all;
  for (int b = 0; b < block.bodies; ++b) {
    const std::vector<double> m = random.many(block.planar() ? 2 : 4, 0.3, 3);
    all.insert(all.end(), m.begin(), m.begin() + (block.planar() ? 2 : 1));
    if (block.planar()) continue;
    const Eigen::Matrix3d A = random_turn(random).toRotationMatrix();
    const Eigen::Matrix3d I = A * Eigen::Vector3d(m[1], m[2], m[3]).asDiagonal() * A.transpose();
    all.insert(all.end(), {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)});
  }
  return all;
}

void set_all(std::vector<double>& numbers, double value) { std::fill(numbers.begin(), numbers.end(), value); }

}  // namespace

Inputs random_inputs(const AnyBlock& block, std::uint32_t seed) {
  Random random(seed);
  const auto n = static_cast<std::size_t>(block.bodies), rows = static_cast<std::size_t>(block.rows);
  Inputs in;
  in.q = random.many(block.pose() * n, -2, 2);
  for (std::size_t b = 0; b < n; ++b) set_random_orientation(block, &in.q[block.pose() * b], random);
  in.v = random.many(block.width() * n, -1, 1);
  in.m = random_masses(block, random);
  in.m_isotropic = random.many(2 * n, 0.3, 3);
  in.p = random_parameters(block, random);
  in.lambda = random.many(rows, -1, 1);
  in.rhs = random.many(rows, -1, 1);
  in.time = {random.between(0, 2)};
  if (block.immovable >= 0) {
    const auto body = static_cast<std::size_t>(block.immovable);
    std::fill_n(&in.v[block.width() * body], block.width(), 0.0);
    std::fill_n(&in.m[block.mass() * body], block.mass(), 0.0);
    std::fill_n(&in.m_isotropic[2 * body], 2, 0.0);
  }
  return in;
}

std::vector<SingularInputs> singular_inputs(const AnyBlock& block, std::uint32_t seed) {
  const Inputs in = random_inputs(block, seed);
  const std::size_t pose = block.pose(), dimension = block.planar() ? 2 : 3;
  std::vector<SingularInputs> all(6, {"", in});
  all[0].name = "every centre of mass in one place, all parameters zero";
  set_all(all[0].inputs.p, 0);
  for (std::size_t i = 0; i < in.q.size(); ++i) {
    if (i % pose < dimension) all[0].inputs.q[i] = 0.25;
  }
  all[1].name = "all parameters zero";
  set_all(all[1].inputs.p, 0);
  all[2].name = "everything at the origin, unturned, all parameters zero";
  set_all(all[2].inputs.p, 0);
  set_all(all[2].inputs.q, 0);
  for (std::size_t i = 0; i < in.q.size(); i += pose) unturn(block, &all[2].inputs.q[i]);
  all[3].name = "every body in one pose, all points in one place";
  for (std::size_t i = 0; i < in.q.size(); ++i) all[3].inputs.q[i] = in.q[i % pose];
  for (const ParameterInfo& info : block.parameters) {
    if (info.kind == ParameterKind::point) {
      std::fill_n(&all[3].inputs.p[static_cast<std::size_t>(info.offset)], dimension, 0.0);
    }
  }
  all[4].name = "every body immovable";
  set_all(all[4].inputs.m, 0);
  set_all(all[4].inputs.m_isotropic, 0);
  all[5].name = "distances whose squares underflow";
  for (std::size_t i = 0; i < in.q.size(); ++i) {
    if (i % pose < dimension) all[5].inputs.q[i] *= 1e-200;
  }
  for (double& x : all[5].inputs.p) x *= 1e-200;
  return all;
}

Eigen::Matrix3d inverse_inertia(const double* mass) {
  Eigen::Matrix3d I;
  I << mass[1], mass[4], mass[5], mass[4], mass[2], mass[6], mass[5], mass[6], mass[3];
  return I;
}

void set_orientation(double* pose, const Eigen::Vector4d& parameters) {
  Eigen::Map<Eigen::Vector4d> e(pose + 3);
  e = parameters.normalized();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> A(pose + 7);
  A = Eigen::Quaterniond(e[0], e[1], e[2], e[3]).toRotationMatrix();
}

void move(const AnyBlock& block, Inputs& in, std::size_t column, double step) {
  double* pose = &in.q[block.pose() * (column / block.width())];
  const std::size_t k = column % block.width(), dimension = block.planar() ? 2 : 3;
  if (k < dimension) {
    pose[k] += step;
  } else {
    turn(block, pose, Eigen::Vector3d::Unit(static_cast<Eigen::Index>(k - dimension)), step);
  }
}

Inputs moved_together(const AnyBlock& block, const Inputs& in) {
  const Eigen::Vector3d axis = block.planar() ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, -2, 2) / 3;
  const double angle = 0.7;
  const Eigen::Matrix3d A = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  const Eigen::Index dimension = block.planar() ? 2 : 3;
  const auto turned = [&](double* numbers) {
    Eigen::Map<Eigen::VectorXd> u(numbers, dimension);
    u = (A.topLeftCorner(dimension, dimension) * u).eval();
  };
  Inputs moved = in;
  for (std::size_t b = 0; b < static_cast<std::size_t>(block.bodies); ++b) {
    double* const pose = &moved.q[block.pose() * b];
    turned(pose);
    pose[0] += 3, pose[1] -= 2;
    turn(block, pose, axis, angle);
    turned(&moved.v[block.width() * b]);
    if (block.planar()) continue;
    turned(&moved.v[6 * b + 3]);
    double* const m = &moved.m[7 * b];
    const Eigen::Matrix3d I = A * inverse_inertia(m) * A.transpose();
    const double numbers[] = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
    std::copy(std::begin(numbers), std::end(numbers), m + 1);
  }
  return moved;
}

}  // namespace cdot
