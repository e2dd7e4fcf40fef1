#include "tests/bench/ulp/inputs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cdot::ulp {
namespace {

using Eigen::Vector3d;

class Maker {
 public:
  Maker(const AnyBlock& block, void (*set_defaults)(Inputs&), int digits, std::uint32_t seed)
      : block_(block),
        set_defaults_(set_defaults),
        digits_(digits),
        random_(seed ^ 0x9e3779b9u),
        in(random_inputs(block, seed)) {}

  void satisfy() {
    set_defaults_(in);
    disturb(power(-digits_ / 2.0, -1));
    move_nearly_as_one(power(-digits_ / 2.0, 0));
  }

  void far() {
    const Vector3d shift = power(1, digits_ * 0.6) * direction();
    for (std::size_t b = 0; b < bodies(); ++b) add(position(b), shift);
    satisfy();
  }

  void singular() {
    align_parameters();
    const double near = power(-digits_ / 2.0, -1);
    for (std::size_t b = 1; b < bodies(); ++b) {
      const std::size_t size = block_.pose();
      std::copy_n(&in.q[0], size, &in.q[size * b]);
      if (number(0, 1) < 0.7) turn(b, axis(), std::numbers::pi / 2 * std::floor(number(1, 4)));
    }
    disturb(near);
    if (number(0, 1) < 0.5) set_defaults_(in), disturb(near);
  }

  void equal_anchors() {
    const double length = power(0, 2);
    for (const ParameterInfo& p : block_.parameters) {
      if (p.kind != ParameterKind::point) continue;
      for (int k = 0; k < p.size; ++k) in.p[static_cast<std::size_t>(p.offset + k)] *= length;
    }
    if (const ParameterInfo* const first = first_point_on(0)) {
      for (std::size_t b = 1; b < bodies(); ++b) {
        const ParameterInfo* const other = first_point_on(static_cast<int>(b));
        if (other == nullptr) continue;
        add(position(b), world_point(0, *first) - world_point(b, *other));
      }
    }
    if (number(0, 1) < 0.5) set_defaults_(in);
    disturb(power(-digits_ / 2.0, -1));
  }

  void masses() {
    satisfy();
    const double range = 6;
    for (std::size_t b = 0; b < bodies(); ++b) {
      double* const m = &in.m[block_.mass() * b];
      m[0] *= power(-range, range);
      const double inertia = power(-range, range);
      for (std::size_t k = 1; k < block_.mass(); ++k) m[k] *= inertia;
      in.m_isotropic[2 * b] *= power(-range, range);
      in.m_isotropic[2 * b + 1] *= inertia;
    }
  }

 private:
  std::size_t bodies() const { return static_cast<std::size_t>(block_.bodies); }
  std::size_t dimension() const { return block_.planar() ? 2 : 3; }
  double* position(std::size_t b) { return &in.q[block_.pose() * b]; }

  double number(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  double power(double low, double high) { return std::pow(10.0, number(low, high)); }
  Vector3d direction() {
    const Vector3d v(number(-1, 1), number(-1, 1), block_.planar() ? 0 : number(-1, 1));
    return v.norm() > 0.1 ? v.normalized() : Vector3d::UnitX();
  }
  Vector3d axis() { return Vector3d::Unit(block_.planar() ? 2 : static_cast<Eigen::Index>(random_() % 3)); }
  void add(double* to, const Vector3d& v) const {
    for (std::size_t k = 0; k < dimension(); ++k) to[k] += v[static_cast<Eigen::Index>(k)];
  }
  void turn(std::size_t b, const Vector3d& about, double angle) {
    double* const pose = position(b);
    if (block_.planar()) {
      pose[4] += angle;
      pose[2] = std::cos(pose[4]), pose[3] = std::sin(pose[4]);
    } else {
      const Eigen::Quaterniond e(pose[3], pose[4], pose[5], pose[6]);
      const Eigen::Quaterniond turned = e * Eigen::Quaterniond(Eigen::AngleAxisd(angle, about));
      set_orientation(pose, {turned.w(), turned.x(), turned.y(), turned.z()});
    }
  }

  void disturb(double by) {
    for (std::size_t b = 0; b < bodies(); ++b) {
      add(position(b), by * direction());
      turn(b, block_.planar() ? Vector3d::UnitZ() : direction(), by * number(-1, 1));
    }
  }

  // v = u + w x x about the first body's centre, and a little more.
  void move_nearly_as_one(double more) {
    const std::vector<double> v = in.v;
    const std::size_t width = block_.width();
    const Vector3d w = block_.planar() ? Vector3d(0, 0, v[2]) : Vector3d(v[3], v[4], v[5]);
    for (std::size_t b = 0; b < bodies(); ++b) {
      Vector3d arm = Vector3d::Zero();
      for (std::size_t k = 0; k < dimension(); ++k) {
        arm[static_cast<Eigen::Index>(k)] = position(b)[k] - position(0)[k];
      }
      const Vector3d swept = w.cross(arm);
      for (std::size_t k = 0; k < width; ++k) {
        const double turning = k < dimension() ? swept[static_cast<Eigen::Index>(k)] : 0;
        in.v[width * b + k] = v[k] + turning + more * number(-1, 1);
      }
    }
  }

  // All points alike, all directions along axes.
  void align_parameters() {
    for (const ParameterInfo& p : block_.parameters) {
      double* const numbers = &in.p[static_cast<std::size_t>(p.offset)];
      if (p.kind == ParameterKind::point) {
        std::copy_n(in.p.begin() + first_point_offset(), p.size, numbers);
      } else if (p.kind == ParameterKind::unit) {
        std::fill_n(numbers, p.size, 0.0);
        numbers[random_() % static_cast<unsigned>(p.size)] = 1;
      } else if (p.kind == ParameterKind::frame) {
        std::fill_n(numbers, p.size, 0.0);
        for (int k = 0; k < p.size; k += 4) numbers[k] = 1;
      }
    }
  }
  std::ptrdiff_t first_point_offset() const {
    for (const ParameterInfo& p : block_.parameters) {
      if (p.kind == ParameterKind::point) return p.offset;
    }
    return 0;
  }

  const ParameterInfo* first_point_on(int body) const {
    for (const ParameterInfo& p : block_.parameters) {
      if (p.kind == ParameterKind::point && p.body == body) return &p;
    }
    return nullptr;
  }
  Vector3d world_point(std::size_t b, const ParameterInfo& p) {
    const double* const pose = position(b);
    const double* const r = &in.p[static_cast<std::size_t>(p.offset)];
    if (block_.planar()) {
      return {pose[0] + pose[2] * r[0] - pose[3] * r[1], pose[1] + pose[3] * r[0] + pose[2] * r[1], 0};
    }
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> A(pose + 7);
    return Eigen::Map<const Vector3d>(pose) + A * Eigen::Map<const Vector3d>(r);
  }

  const AnyBlock& block_;
  void (*set_defaults_)(Inputs&);
  double digits_;
  std::mt19937 random_;

 public:
  Inputs in;
};

}  // namespace

Inputs inputs_of(Family family, const AnyBlock& block, void (*set_defaults)(Inputs&), int digits, std::uint32_t seed) {
  Maker maker(block, set_defaults, digits, seed);
  switch (family) {
    case Family::satisfied: maker.satisfy(); break;
    case Family::far: maker.far(); break;
    case Family::singular: maker.singular(); break;
    case Family::equal_anchors: maker.equal_anchors(); break;
    case Family::masses: maker.masses(); break;
    default: break;
  }
  return std::move(maker.in);
}

}  // namespace cdot::ulp
