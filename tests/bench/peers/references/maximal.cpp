// Any problem in maximal coordinates: 13 numbers per body (place, quaternion, velocity, spin). Constraints are defined
// by positions; jets along the motion give their rates. Redundant rows get the multipliers of least norm.
#include <Eigen/Dense>
#include <array>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/references/extrapolate.hpp"
#include "tests/bench/peers/references/jet.hpp"
#include "tests/bench/peers/references/route.hpp"

namespace cdot::peers {
namespace {

using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Real3 = Eigen::Matrix<Real, 3, 1>;
using Real33 = Eigen::Matrix<Real, 3, 3>;

Real33 skew(const Real3& w) {
  Real33 W;
  W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return W;
}

// A body's path to second order in time without acceleration.
struct Path {
  Jet3 x;
  std::array<Jet3, 3> R;  // columns
};

struct Moving {
  Real3 x, v, w;
  Real33 R;
};

Moving moving(const Vector& y, int body) {
  const auto s = y.segment<13>(13 * body);
  const Eigen::Quaternion<Real> q(s[3], s[4], s[5], s[6]);
  return {s.head<3>(), s.segment<3>(7), s.tail<3>(), q.normalized().toRotationMatrix()};
}

Path path(const Moving& m, const Real3& v, const Real3& w) {
  Path p;
  const Real33 W = skew(w), first = W * m.R, second = W * first;
  for (int i = 0; i < 3; ++i) {
    p.x[std::size_t(i)] = {m.x[i], v[i], 0};
    for (int j = 0; j < 3; ++j) p.R[std::size_t(j)][std::size_t(i)] = {m.R(i, j), first(i, j), second(i, j)};
  }
  return p;
}

Path rest() {
  Moving still{Real3::Zero(), Real3::Zero(), Real3::Zero(), Real33::Identity()};
  return path(still, still.v, still.w);
}

// A direction or an arm fixed in a body.
Jet3 turned_with(const Path& p, const Vec3& u) {
  Jet3 sum;
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] + p.R[j][i] * u[j];
  return sum;
}

// Two directions that are perpendicular to u and to each other.
std::array<Vec3, 2> across(const Vec3& u) {
  const Vec3 other = std::fabs(u[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 m = cross(u, other), first = (1 / norm(m)) * m;
  return {first, cross((1 / norm(u)) * u, first)};
}

// The constants of a joint in its bodies' frames.
struct Held {
  Joint joint;
  Vec3 pa, pb, axis_a;
  std::array<Vec3, 2> across_a, across_b;
  std::array<Vec3, 3> frame_a, frame_b;
};

Held hold(const Problem& problem, const Joint& joint) {
  Held h{
      joint, local_point(problem, joint.a, joint.anchor), local_point(problem, joint.b, joint.anchor), {}, {}, {}, {},
      {}};
  if (joint.kind == JointKind::spherical) return h;
  h.axis_a = local_direction(problem, joint.a, joint.axis);
  const std::array<Vec3, 2> m = across(joint.axis);
  for (std::size_t i = 0; i < 2; ++i) {
    h.across_a[i] = local_direction(problem, joint.a, m[i]);
    h.across_b[i] = local_direction(problem, joint.b, m[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 e{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
    h.frame_a[i] = local_direction(problem, joint.a, e);
    h.frame_b[i] = local_direction(problem, joint.b, e);
  }
  return h;
}

// C of a joint along the paths of its bodies.
std::vector<Jet> constraint(const Held& h, const Path& a, const Path& b) {
  const Jet3 d = (b.x + turned_with(b, h.pb)) - (a.x + turned_with(a, h.pa));
  if (h.joint.kind != JointKind::prismatic) {
    std::vector<Jet> rows{d[0], d[1], d[2]};
    if (h.joint.kind == JointKind::revolute)
      for (const Vec3& m : h.across_b) rows.push_back(dot(turned_with(a, h.axis_a), turned_with(b, m)));
    return rows;
  }
  std::vector<Jet> rows;
  for (const Vec3& m : h.across_a) rows.push_back(dot(turned_with(a, m), d));
  for (std::size_t i = 0; i < 3; ++i)
    rows.push_back(dot(turned_with(a, h.frame_a[i]), turned_with(b, h.frame_b[(i + 1) % 3])));
  return rows;
}

class Maximal {
 public:
  explicit Maximal(const Problem& problem) : problem_(problem) {
    for (const Joint& joint : problem.joints) held_.push_back(hold(problem, joint));
  }

  Vector start() const {
    const int n = int(problem_.bodies.size());
    Vector y(13 * n);
    for (int k = 0; k < n; ++k) {
      const State& s = problem_.bodies[std::size_t(k)].start;
      y.segment<13>(13 * k) << s.x[0], s.x[1], s.x[2], s.q[0], s.q[1], s.q[2], s.q[3], s.v[0], s.v[1], s.v[2], s.w[0],
          s.w[1], s.w[2];
    }
    return y;
  }

  Vector slope(const Vector& y) const {
    const int n = int(problem_.bodies.size());
    std::vector<Moving> bodies;
    for (int k = 0; k < n; ++k) bodies.push_back(moving(y, k));
    const Vector a = acceleration(bodies);
    Vector f(13 * n);
    for (int k = 0; k < n; ++k) {
      const Moving& m = bodies[std::size_t(k)];
      const Eigen::Quaternion<Real> q(y[13 * k + 3], y[13 * k + 4], y[13 * k + 5], y[13 * k + 6]);
      const Eigen::Quaternion<Real> qdot = Eigen::Quaternion<Real>(0, m.w[0] / 2, m.w[1] / 2, m.w[2] / 2) * q;
      f.segment<13>(13 * k) << m.v, qdot.w(), qdot.x(), qdot.y(), qdot.z(), a.segment<6>(6 * k);
    }
    return f;
  }

 private:
  // M a = f + J^T lambda, J a = gamma
  Vector acceleration(const std::vector<Moving>& bodies) const {
    const int n = int(bodies.size());
    Matrix weight = Matrix::Zero(6 * n, 6 * n);  // M^-1
    Vector free(6 * n);                          // M^-1 f
    for (int k = 0; k < n; ++k) {
      const Body& body = problem_.bodies[std::size_t(k)];
      const Moving& m = bodies[std::size_t(k)];
      const Real3 I(body.inertia[0], body.inertia[1], body.inertia[2]);
      const Real33 inverse = m.R * I.cwiseInverse().asDiagonal() * m.R.transpose();
      weight.block<3, 3>(6 * k, 6 * k) = Real33::Identity() / Real(body.mass);
      weight.block<3, 3>(6 * k + 3, 6 * k + 3) = inverse;
      const Real3 L = m.R * I.asDiagonal() * (m.R.transpose() * m.w);
      free.segment<3>(6 * k) << problem_.gravity[0], problem_.gravity[1], problem_.gravity[2];
      free.segment<3>(6 * k + 3) = -inverse * m.w.cross(L);
    }
    if (held_.empty()) return free;
    Matrix J;
    Vector gamma;
    linearise(bodies, J, gamma);
    const Matrix K = J * weight * J.transpose();
    Eigen::CompleteOrthogonalDecomposition<Matrix> factors;
    factors.setThreshold(1e-12L);
    factors.compute(K);
    const Vector lambda = factors.solve(gamma - J * free);
    return free + weight * J.transpose() * lambda;
  }

  void linearise(const std::vector<Moving>& bodies, Matrix& J, Vector& gamma) const {
    std::vector<Real> right;
    std::vector<Vector> rows;
    for (const Held& h : held_) {
      const auto along = [&](int unit_body, int unit) {
        const auto way = [&](int body) {
          if (body == world) return rest();
          const Moving& m = bodies[std::size_t(body)];
          if (unit < 0) return path(m, m.v, m.w);
          Eigen::Matrix<Real, 6, 1> e = Eigen::Matrix<Real, 6, 1>::Zero();
          if (body == unit_body) e[unit] = 1;
          return path(m, e.head<3>(), e.tail<3>());
        };
        return constraint(h, way(h.joint.a), way(h.joint.b));
      };
      const std::size_t first = rows.size();
      for (const Jet& C : along(world, -1)) {
        right.push_back(-C.second);
        rows.push_back(Vector::Zero(6 * Eigen::Index(bodies.size())));
      }
      for (const int body : {h.joint.a, h.joint.b}) {
        for (int unit = 0; unit < 6 && body != world; ++unit) {
          const std::vector<Jet> C = along(body, unit);
          for (std::size_t i = 0; i < C.size(); ++i) rows[first + i][6 * body + unit] = C[i].first;
        }
      }
    }
    J.resize(Eigen::Index(rows.size()), 6 * Eigen::Index(bodies.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) J.row(Eigen::Index(i)) = rows[i];
    gamma = Eigen::Map<Vector>(right.data(), Eigen::Index(right.size()));
  }

  const Problem& problem_;
  std::vector<Held> held_;
};

State state_of(const Vector& y, int body) {
  const auto s = y.segment<13>(13 * body);
  const Real length = s.segment<4>(3).norm();
  const auto d = [&](int k) { return double(s[k]); };
  return {{d(0), d(1), d(2)},
          {double(s[3] / length), double(s[4] / length), double(s[5] / length), double(s[6] / length)},
          {d(7), d(8), d(9)},
          {d(10), d(11), d(12)}};
}

}  // namespace

Trajectory maximal(const Problem& problem, long double tolerance) {
  const Maximal model(problem);
  const Slope slope = [&](const Vector& y) { return model.slope(y); };
  Trajectory all;
  Vector y = model.start();
  Real now = 0;
  for (const double t : problem.times) {
    y = extrapolate(slope, y, Real(t) - now, tolerance);
    now = t;
    std::vector<State> states;
    for (int k = 0; k < int(problem.bodies.size()); ++k) states.push_back(state_of(y, k));
    all.push_back(states);
  }
  return all;
}

}  // namespace cdot::peers
