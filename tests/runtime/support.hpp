// Small worlds for several tests.
#pragma once

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include <cdot/effects.hpp>
#include <cdot/world.hpp>

namespace cdot::test {

inline constexpr double pi = 3.14159265358979323846;

inline Settings settings(Solver solver, Drift drift = Drift::projection, double gravity_y = 0) {
  Settings s;
  s.solver = solver;
  s.drift = drift;
  s.gravity_y = gravity_y;
  return s;
}

// Of a Runge-Kutta method on the earth, by equal steps or with a local error.
inline Settings runge_kutta(Integrator integrator, double local_error = 0) {
  Settings s = settings(Solver::direct, Drift::projection, -9.81);
  s.integrator = integrator;
  s.local_error = local_error;
  return s;
}

template <class T>
int revolute(World<T>& world, int a, int b, double ax, double ay, double bx, double by) {
  return world.add_joint({"revolute", {a, b}, {{"pa", {ax, ay}}, {"pb", {bx, by}}}, {}});
}

template <class T>
int distance(World<T>& world, int a, int b, double length, std::optional<Softness> soft = {}) {
  return world.add_joint({"distance", {a, b}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"l", {length}}}, soft});
}

// A rod of length 1 whose left end is at (x, y), turned by `angle`.
inline BodyDefinition rod(double x, double y, double angle, double mass = 1) {
  BodyDefinition d;
  d.x = x + 0.5 * std::cos(angle);
  d.y = y + 0.5 * std::sin(angle);
  d.angle = angle;
  d.mass = mass;
  d.inertia = mass / 12;
  return d;
}

// Rods of length 1 end to end from the origin; joint i connects rod i to the previous one, joint 0 to the ground.
template <class T>
std::vector<int> add_chain(World<T>& world, int links, double angle, double mass = 1) {
  std::vector<int> rods;
  int before = world.ground();
  for (int i = 0; i < links; ++i) {
    rods.push_back(world.add_body(rod(i * std::cos(angle), i * std::sin(angle), angle, mass)));
    revolute(world, before, rods.back(), i ? 0.5 : 0.0, 0, -0.5, 0);
    before = rods.back();
  }
  return rods;
}

// Some value for every parameter that has no default. A lower end lies below others.
inline std::vector<NamedValue> some_values(const JointType& type) {
  std::vector<NamedValue> values;
  for (const ParameterInfo& info : type.parameters) {
    if (info.has_default) continue;
    std::vector<double> numbers;
    if (info.kind == ParameterKind::scalar) numbers = {info.name == "lower" ? -0.7 : 0.7};
    else if (info.kind == ParameterKind::point) numbers = {0.4, 0.1 * info.offset / 3.0, 0.2};
    else numbers = {0.3, -0.2 + 0.05 * info.offset, 1};
    if (info.size < 3) numbers.resize(static_cast<size_t>(info.size));
    values.push_back({std::string(info.name), numbers});
  }
  return values;
}

template <class S>
void run(BasicWorld<S>& world, double duration, double h) {
  const long steps = std::lround(duration / h);
  for (long i = 0; i < steps; ++i) world.step(h);
}

// The largest change of the energy since the start, in the first quarter of a run and in the other three quarters.
struct EnergyOff {
  double early = 0, late = 0;
};

template <class S>
EnergyOff energy_off(BasicWorld<S>& world, double duration, double h) {
  EnergyOff off;
  const double start = world.energy();
  const long steps = std::lround(duration / h);
  for (long i = 0; i < steps; ++i) {
    world.step(h);
    double& worst = i < steps / 4 ? off.early : off.late;
    worst = std::max(worst, std::abs(world.energy() - start));
  }
  return off;
}

template <class T>
bool finite(const World<T>& world) {
  for (int i = 0; i < world.body_count(); ++i) {
    const auto q = world.pose(i);
    const auto v = world.velocity(i);
    for (T number : {q.x, q.y, q.angle, v.x, v.y, v.w})
      if (!std::isfinite(number)) return false;
  }
  return true;
}

// The largest distance between the same bodies of two worlds.
template <class A, class B>
double apart(const World<A>& one, const World<B>& other) {
  double worst = 0;
  for (int i = 0; i < one.body_count(); ++i) {
    const auto p = one.pose(i);
    const auto q = other.pose(i);
    worst = std::max({worst, std::hypot(double(p.x) - double(q.x), double(p.y) - double(q.y)),
                      std::abs(double(p.angle) - double(q.angle))});
  }
  return worst;
}

}  // namespace cdot::test
