// A chain in the plane in minimal coordinates, written by hand for this one mechanism, by a method of order 8. The
// angles of its links are the state, so it has no constraints.
#pragma once

#include <array>
#include <cmath>

#include "runtime/step/runge_kutta_tables.hpp"
#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

namespace flat {

struct Vector {
  double x, y;
};
inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
inline double cross(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }
inline Vector in_plane(const Vec3& a) { return {a[0], a[1]}; }

}  // namespace flat

// Link i reaches from its upper pin by L_i to the next one, by B_i to its centre. With all mass below hung on the lower
// pin, H_i = m_i B_i + L_i sum_{k > i} m_k. Kane's equations for the rates w of the angles:
//   M_ij = L_i . H_j for i < j, M_ii constant; M dw/dt = f,
//   f_i = sum_{j > i} w_j^2 L_i x H_j + sum_{j < i} w_j^2 H_i x L_j + H_i x g
template <int n>
class Chain {
 public:
  using Angles = std::array<double, n>;

  explicit Chain(const Problem& problem)
      : g_(flat::in_plane(problem.gravity)), hook_(flat::in_plane(problem.joints[0].anchor)) {
    double below = 0;
    for (std::size_t i = n; i-- > 0;) {
      const Body& body = problem.bodies[i];
      const Vec3 pin = problem.joints[i].anchor;
      B_[i] = flat::in_plane(body.start.x - pin);
      L_[i] = i + 1 < n ? flat::in_plane(problem.joints[i + 1].anchor - pin) : flat::Vector{0, 0};
      H_[i] = {body.mass * B_[i].x + below * L_[i].x, body.mass * B_[i].y + below * L_[i].y};
      M_[i] = body.inertia[2] + body.mass * flat::dot(B_[i], B_[i]) + below * flat::dot(L_[i], L_[i]);
      below += body.mass;
    }
  }

  void accelerate(const Angles& turned, const Angles& w, Angles& to) const {
    flat::Vector L[n], H[n];
    for (std::size_t i = 0; i < n; ++i) {
      const double c = std::cos(turned[i]), s = std::sin(turned[i]);
      L[i] = {c * L_[i].x - s * L_[i].y, s * L_[i].x + c * L_[i].y};
      H[i] = {c * H_[i].x - s * H_[i].y, s * H_[i].x + c * H_[i].y};
    }
    double K[n][n];  // the lower triangle of M, then its Cholesky factor with reciprocal pivots
    for (std::size_t i = 0; i < n; ++i) {
      to[i] = flat::cross(H[i], g_);
      K[i][i] = M_[i];
      for (std::size_t j = 0; j < i; ++j) {
        K[i][j] = flat::dot(L[j], H[i]);
        const double turning = flat::cross(L[j], H[i]);
        to[j] += w[i] * w[i] * turning;
        to[i] -= w[j] * w[j] * turning;
      }
    }
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t k = 0; k < j; ++k) K[j][j] -= K[j][k] * K[j][k];
      K[j][j] = 1 / std::sqrt(K[j][j]);
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) K[i][j] -= K[i][k] * K[j][k];
        K[i][j] *= K[j][j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) to[i] -= K[i][k] * to[k];
      to[i] *= K[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) to[i] -= K[k][i] * to[k];
      to[i] *= K[i][i];
    }
  }

  State state(const Problem& problem, std::size_t body, const Angles& turned, const Angles& w) const {
    State state;
    double x[4] = {hook_.x, hook_.y, 0, 0};  // place and velocity
    for (std::size_t j = 0; j <= body; ++j) {
      const double c = std::cos(turned[j]), s = std::sin(turned[j]);
      const flat::Vector& reach = j == body ? B_[j] : L_[j];
      const flat::Vector now = {c * reach.x - s * reach.y, s * reach.x + c * reach.y};
      x[0] += now.x, x[1] += now.y, x[2] -= w[j] * now.y, x[3] += w[j] * now.x;
    }
    state.x = {x[0], x[1], 0}, state.v = {x[2], x[3], 0};
    state.q = about_z(turned[body]) * problem.bodies[body].start.q;
    state.w = {0, 0, w[body]};
    return state;
  }

 private:
  flat::Vector g_, hook_;
  flat::Vector L_[n], B_[n], H_[n];  // at the start
  double M_[n];
};

template <int n>
class ChainRun : public SteppedRun {
 public:
  using Angles = typename Chain<n>::Angles;

  ChainRun(const Problem& problem, double h) : SteppedRun(h), problem_(problem), chain_(problem) {
    for (std::size_t i = 0; i < n; ++i) w_[i] = problem.bodies[i].start.w[2];
    chain_.accelerate(turned_, w_, a_[0]);
  }
  void step(double by) override {
    constexpr auto& method = dop853<double>;
    v_[0] = w_;
    for (std::size_t stage = 1; stage <= std::size_t(method.stages); ++stage) {
      Angles turned = turned_, w = w_;
      for (std::size_t k = 0; k < stage; ++k) {
        if (method.a[stage][k] == 0) continue;
        const double part = by * method.a[stage][k];
        for (std::size_t i = 0; i < n; ++i) turned[i] += part * v_[k][i], w[i] += part * a_[k][i];
      }
      if (stage == std::size_t(method.stages)) {
        turned_ = turned, w_ = w;
        chain_.accelerate(turned, w, a_[0]);
      } else {
        v_[stage] = w;
        chain_.accelerate(turned, w, a_[stage]);
      }
    }
  }
  State state(int body) const override { return chain_.state(problem_, std::size_t(body), turned_, w_); }

 private:
  const Problem& problem_;
  Chain<n> chain_;
  Angles turned_{}, w_{};             // since the start
  std::array<Angles, 12> v_{}, a_{};  // slopes by stage; the acceleration of a step's end begins the next one
};

}  // namespace cdot::peers
