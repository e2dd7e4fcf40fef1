// An engine in 100 lines: bodies, any joint of <cdot/planar/...>, the loop of <cdot/kernel.md>. Its main() runs a crank
// that pushes a slider, beside its closed form.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <cdot/planar/line.hpp>
#include <cdot/planar/prismatic.hpp>
#include <cdot/planar/revolute.hpp>

using namespace cdot::planar;
using cdot::RowKind;

struct Body {
  Pose<double> q;
  Velocity<double> v;
  InverseMass<double> m;
};

Body body(double x, double y, double angle, double mass, double inertia) {
  return {
      {x, y, std::cos(angle), std::sin(angle), angle}, {}, {mass > 0 ? 1 / mass : 0, inertia > 0 ? 1 / inertia : 0}};
}

// The loop's view of a joint of any kernel.
struct Joint {
  virtual ~Joint() = default;
  virtual void prepare(double time, double h) = 0;
  virtual void warm_start() = 0;
  virtual void solve() = 0;
};

template <class Kernel>
struct JointOf final : Joint {
  static constexpr int n = Kernel::rows, count = Kernel::bodies;
  Body* bodies[count];
  typename Kernel::template Parameters<double> p;
  typename Kernel::template Jacobian<double> J;
  double F[n * (n + 1) / 2], bias[n], impulse[n] = {};
  Velocity<double> v[count];
  InverseMass<double> m[count];

  void take() {
    for (int i = 0; i < count; ++i) v[i] = bodies[i]->v, m[i] = bodies[i]->m;
  }
  void put() {
    for (int i = 0; i < count; ++i) bodies[i]->v = v[i];
  }
  void prepare(double time, double h) override {
    Pose<double> q[count];
    double C[n], C_t[n], K[n * (n + 1) / 2];
    for (int i = 0; i < count; ++i) q[i] = bodies[i]->q;
    take();
    Kernel::jacobian(q, p, time, C, J);
    Kernel::time_derivative(q, p, time, C_t);
    Kernel::effective_mass(J, m, K);
    Kernel::factor(K, F);
    for (int i = 0; i < n; ++i) bias[i] = C_t[i] + 0.2 / h * C[i];
  }
  void warm_start() override {
    take();
    Kernel::apply(J, m, impulse, v);
    put();
  }
  void solve() override {
    double b[n], lambda[n];
    take();
    Kernel::velocity(J, v, b);
    for (int i = 0; i < n; ++i) b[i] = -(b[i] + bias[i]);
    Kernel::solve(F, b, lambda);
    for (int i = 0; i < n; ++i) {
      const bool bound = Kernel::row_kinds[i] == RowKind::inequality;
      if (bound && impulse[i] + lambda[i] < 0) lambda[i] = -impulse[i];
      impulse[i] += lambda[i];
    }
    Kernel::apply(J, m, lambda, v);
    put();
  }
};

struct Engine {
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::unique_ptr<Joint>> joints;
  double time = 0;

  Body& add(const Body& b) { return *bodies.emplace_back(std::make_unique<Body>(b)); }
  template <class Kernel>
  void join(Body& a, Body& b, const typename Kernel::template Parameters<double>& p) {
    auto joint = std::make_unique<JointOf<Kernel>>();
    joint->bodies[0] = &a, joint->bodies[1] = &b, joint->p = p;
    joints.push_back(std::move(joint));
  }
  void step(double h) {
    for (auto& b : bodies) b->v.y -= b->m.m > 0 ? 9.81 * h : 0;
    for (auto& joint : joints) joint->prepare(time, h);
    for (auto& joint : joints) joint->warm_start();
    for (int sweep = 0; sweep < 30; ++sweep)
      for (auto& joint : joints) joint->solve();
    for (auto& b : bodies)
      *b = {body(b->q.x + h * b->v.x, b->q.y + h * b->v.y, b->q.angle + h * b->v.w, 0, 0).q, b->v, b->m};
    time += h;
  }
};

// A crank of 0.5 m turns at 4 rad/s; a rod of 1.5 m pushes a slider along y = 0.
int main() {
  Engine engine;
  Body &ground = engine.add(body(0, 0, 0, 0, 0)), &crank = engine.add(body(0, 0, 0, 0, 0));
  Body &rod = engine.add(body(1.25, 0, 0, 1, 0.2)), &slider = engine.add(body(2, 0, 0, 2, 0.1));
  crank.v.w = 4;  // without mass forces it turns on
  engine.join<revolute>(crank, rod, {0.5, 0, -0.75, 0});
  engine.join<revolute>(rod, slider, {0.75, 0, 0, 0});
  engine.join<prismatic>(slider, ground, {0, 0, 0, 0, 0, 1, 0});
  double worst = 0;
  for (int k = 0; k < 4000; ++k) {
    engine.step(5e-4);
    const double t = crank.q.angle;
    worst = std::fmax(
        worst, std::fabs(slider.q.x - 0.5 * std::cos(t) - std::sqrt(1.5 * 1.5 - 0.25 * std::sin(t) * std::sin(t))));
  }
  std::printf("the slider is at most %.1e m from its place; crank at %.3f rad\n", worst, crank.q.angle);
  return worst < 2e-3 && std::fabs(crank.q.angle - 8) < 1e-9 ? 0 : 1;
}
