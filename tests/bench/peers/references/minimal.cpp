// Each kind of problem in minimal coordinates: chains by the spins of their links (Kane), loops of one degree of
// freedom by the crank's angle (Lagrange), the free body by its constant angular momentum.
#include <Eigen/Dense>
#include <stdexcept>

#include "tests/bench/peers/geometry.hpp"
#include "tests/bench/peers/references/extrapolate.hpp"
#include "tests/bench/peers/references/jet.hpp"
#include "tests/bench/peers/references/route.hpp"

namespace cdot::peers {
namespace {

using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Real3 = Eigen::Matrix<Real, 3, 1>;
using Real33 = Eigen::Matrix<Real, 3, 3>;
using Turn = Eigen::Quaternion<Real>;

Real3 real(const Vec3& a) { return {a[0], a[1], a[2]}; }
Vec3 rounded(const Real3& a) { return {double(a[0]), double(a[1]), double(a[2])}; }
Turn real(const Quaternion& q) { return Turn(q[0], q[1], q[2], q[3]).normalized(); }
Quaternion rounded(const Turn& q) { return {double(q.w()), double(q.x()), double(q.y()), double(q.z())}; }
Turn rate(const Turn& q, const Real3& w) { return Turn(0, w[0] / 2, w[1] / 2, w[2] / 2) * q; }
Turn turn_in(const Vector& y, Eigen::Index at) { return {y[at], y[at + 1], y[at + 2], y[at + 3]}; }
void put(Vector& y, Eigen::Index at, const Turn& q) { y.segment<4>(at) << q.w(), q.x(), q.y(), q.z(); }

Trajectory integrate(const Problem& problem, Vector y, const Slope& slope, Real tolerance,
                     const std::function<std::vector<State>(const Vector&)>& states) {
  Trajectory all;
  Real now = 0;
  for (const double t : problem.times) {
    y = extrapolate(slope, y, Real(t) - now, tolerance);
    now = t;
    all.push_back(states(y));
  }
  return all;
}

// --- a chain on ball joints, link k hanging from link k - 1 and the first from the world ---
// In the plane ball joints equal pins: a planar motion stays planar.

class Chain {
 public:
  explicit Chain(const Problem& problem) : problem_(problem), n_(int(problem.bodies.size())) {
    for (int k = 0; k < n_; ++k) {
      in_.push_back(real(local_point(problem, k, problem.joints[std::size_t(k)].anchor)));
      if (k + 1 < n_) out_.push_back(real(local_point(problem, k, problem.joints[std::size_t(k) + 1].anchor)));
    }
  }

  Vector start() const {
    Vector y(7 * n_);
    for (int k = 0; k < n_; ++k) {
      const State& s = problem_.bodies[std::size_t(k)].start;
      put(y, 7 * k, real(s.q));
      y.segment<3>(7 * k + 4) = real(s.w);
    }
    return y;
  }

  // Sum over bodies of (dv/dw_i)^T m (a - g) + (dw/dw_i)^T (I alpha + w x I w) = 0, for every link i.
  Vector slope(const Vector& y) const {
    Matrix M = Matrix::Zero(3 * n_, 3 * n_);
    Vector right = Vector::Zero(3 * n_);
    for (int k = 0; k < n_; ++k) {
      const Body& body = problem_.bodies[std::size_t(k)];
      Real3 rest = -real(problem_.gravity);  // a - g without the alphas
      for (int j = 0; j <= k; ++j) rest += spin(y, j).cross(spin(y, j).cross(reach(y, k, j)));
      for (int i = 0; i <= k; ++i) {
        const Real33 dv = -skew(reach(y, k, i));  // v = w x s
        right.segment<3>(3 * i) -= body.mass * dv.transpose() * rest;
        for (int j = 0; j <= k; ++j) M.block<3, 3>(3 * i, 3 * j) -= body.mass * dv.transpose() * skew(reach(y, k, j));
      }
      const Real33 R = turn(y, k).toRotationMatrix();
      const Real33 I = R * real(body.inertia).asDiagonal() * R.transpose();
      M.block<3, 3>(3 * k, 3 * k) += I;
      right.segment<3>(3 * k) -= spin(y, k).cross(I * spin(y, k));
    }
    const Vector alpha = M.llt().solve(right);
    Vector f(7 * n_);
    for (int k = 0; k < n_; ++k) {
      put(f, 7 * k, rate(turn_in(y, 7 * k), spin(y, k)));
      f.segment<3>(7 * k + 4) = alpha.segment<3>(3 * k);
    }
    return f;
  }

  std::vector<State> states(const Vector& y) const {
    std::vector<State> all;
    const Real3 hook = real(problem_.joints[0].anchor);
    for (int k = 0; k < n_; ++k) {
      Real3 x = hook, v = Real3::Zero();
      for (int j = 0; j <= k; ++j) {
        x += reach(y, k, j);
        v += spin(y, j).cross(reach(y, k, j));
      }
      all.push_back({rounded(x), rounded(turn(y, k)), rounded(v), rounded(spin(y, k))});
    }
    return all;
  }

 private:
  static Real33 skew(const Real3& w) {
    Real33 W;
    W << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return W;
  }
  static Turn turn(const Vector& y, int k) { return turn_in(y, 7 * k).normalized(); }
  static Real3 spin(const Vector& y, int k) { return y.segment<3>(7 * k + 4); }
  // The part of link j in the vector from the hook to the centre of link k.
  Real3 reach(const Vector& y, int k, int j) const {
    const Real3 s = j == k ? Real3(-in_[std::size_t(j)]) : Real3(out_[std::size_t(j)] - in_[std::size_t(j)]);
    return turn(y, j) * s;
  }

  const Problem& problem_;
  int n_;
  std::vector<Real3> in_, out_;  // the joints of each link in its frame
};

// --- one degree of freedom: every body's position and angle as functions of the crank's angle ---

struct Placed {
  Jet x, y, turned;  // turned: since the start
};

struct Point {
  Jet x, y;
};
Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y}; }
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
Point operator*(const Jet& s, const Point& a) { return {s * a.x, s * a.y}; }
Jet dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
Jet cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
using peers::operator*;  // for quaternions; the operator of points hides it
Point perp(const Point& a) { return {0 - a.y, a.x}; }
Point point(const Vec3& a) { return {Jet(a[0]), Jet(a[1])}; }
Point turned(const Jet& angle, const Point& a) { return cos(angle) * a + sin(angle) * perp(a); }

class Mechanism {
 public:
  explicit Mechanism(const Problem& problem)
      : problem_(problem),
        O_(point(problem.joints[0].anchor)),
        A_(point(problem.joints[1].anchor)),
        B_(point(problem.joints[2].anchor)) {}

  std::vector<Placed> places(const Jet& phi) const {
    const Point A = O_ + turned(phi, A_ - O_);
    const bool slides = problem_.joints[3].kind == JointKind::prismatic;
    const Point B = slides ? on_guide(A) : on_circle(A);
    const Jet psi = atan2(cross(B_ - A_, B - A), dot(B_ - A_, B - A));
    const auto carried = [&](std::size_t body, const Point& from, const Point& to, const Jet& turn) {
      const Point c = to + turned(turn, point(problem_.bodies[body].start.x) - from);
      return Placed{c.x, c.y, turn};
    };
    const Point C = point(problem_.joints[3].anchor);
    const Placed last =
        slides ? carried(2, B_, B, Jet(0)) : carried(2, C, C, atan2(cross(B_ - C, B - C), dot(B_ - C, B - C)));
    return {carried(0, O_, O_, phi), carried(1, A_, A, psi), last};
  }

  // A phi'' + A' phi'^2 / 2 + V' = 0, with A = sum m |x'|^2 + I theta'^2
  Vector slope(const Vector& y) const {
    const std::vector<Placed> places = this->places(Jet(y[0], 1, 0));
    Real A = 0, half = 0, V = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Body& body = problem_.bodies[k];
      const Placed& p = places[k];
      const Real m = body.mass, I = body.inertia[2];
      A += m * (p.x.first * p.x.first + p.y.first * p.y.first) + I * p.turned.first * p.turned.first;
      half += m * (p.x.first * p.x.second + p.y.first * p.y.second) + I * p.turned.first * p.turned.second;
      V -= m * (problem_.gravity[0] * p.x.first + problem_.gravity[1] * p.y.first);
    }
    Vector f(2);
    f << y[1], -(half * y[1] * y[1] + V) / A;
    return f;
  }

  Vector start() const {
    Vector y(2);
    y << 0, problem_.bodies[0].start.w[2];
    return y;
  }

  std::vector<State> states(const Vector& y) const {
    std::vector<State> all;
    for (const Placed& p : places(Jet(y[0], y[1], 0))) {
      const double turn = double(p.turned.value);
      const Quaternion& q = problem_.bodies[all.size()].start.q;
      all.push_back({{double(p.x.value), double(p.y.value), 0},
                     about_z(turn) * q,
                     {double(p.x.first), double(p.y.first), 0},
                     {0, 0, double(p.turned.first)}});
    }
    return all;
  }

 private:
  // The far end of the rod: on the guide through B, at the rod's length from A.
  Point on_guide(const Point& A) const {
    const Point u = point(problem_.joints[3].axis), d = A - B_;
    const Jet along = dot(d, u), off = cross(u, d);
    const Jet reach = sqrt(dot(B_ - A_, B_ - A_) - off * off);
    const bool ahead = dot(B_ - A_, u).value > 0;
    return B_ + (ahead ? along + reach : along - reach) * u;
  }
  // The far end of the coupler: at the initial distances from A and from the rocker's pin C, on the same side.
  Point on_circle(const Point& A) const {
    const Point C = point(problem_.joints[3].anchor), d = C - A;
    const Jet D = dot(d, d), L = dot(B_ - A_, B_ - A_), r = dot(B_ - C, B_ - C);
    const Jet a = (L - r + D) / (2 * D), h = sqrt(L / D - a * a);
    const bool left = cross(C - A_, B_ - A_).value > 0;
    return A + a * d + (left ? h : 0 - h) * perp(d);
  }

  const Problem& problem_;
  Point O_, A_, B_;
};

// --- the free body: I w = L with constant L ---

Trajectory free_body(const Problem& problem, Real tolerance) {
  const Body& body = problem.bodies.at(0);
  const Turn q = real(body.start.q);
  const Real3 I = real(body.inertia);
  const Real3 L = q * (I.asDiagonal() * (q.conjugate() * real(body.start.w)));
  const auto spin = [=](const Turn& to) -> Real3 {
    return to * (I.cwiseInverse().asDiagonal() * (to.conjugate() * L));
  };
  Vector y(4);
  put(y, 0, q);
  const Slope slope = [&](const Vector& at) {
    Vector f(4);
    put(f, 0, rate(turn_in(at, 0), spin(turn_in(at, 0).normalized())));
    return f;
  };
  return integrate(problem, y, slope, tolerance, [&](const Vector& at) {
    const Turn to = turn_in(at, 0).normalized();
    return std::vector<State>{{body.start.x, rounded(to), {}, rounded(spin(to))}};
  });
}

bool is_chain(const Problem& problem) {
  if (problem.joints.size() != problem.bodies.size()) return false;
  for (int k = 0; k < int(problem.joints.size()); ++k) {
    const Joint& joint = problem.joints[std::size_t(k)];
    if (joint.a != k - 1 || joint.b != k) return false;
  }
  return true;
}

template <class Model>
Trajectory integrate(const Problem& problem, const Model& model, Real tolerance) {
  return integrate(
      problem, model.start(), [&](const Vector& y) { return model.slope(y); }, tolerance,
      [&](const Vector& y) { return model.states(y); });
}

}  // namespace

Trajectory minimal(const Problem& problem, long double tolerance) {
  if (problem.joints.empty()) return free_body(problem, tolerance);
  if (is_chain(problem)) return integrate(problem, Chain(problem), tolerance);
  if (problem.bodies.size() == 3 && problem.joints.size() == 4)
    return integrate(problem, Mechanism(problem), tolerance);
  throw std::runtime_error(problem.name + ": no minimal coordinates for such a problem");
}

}  // namespace cdot::peers
