// Typical mechanisms for the direct solver, used by its tests and its benchmark.
#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include <cdot/world.hpp>

namespace cdot::test {

// A bar from one point to another.
struct Bar {
  double x0, y0, x1, y1;
  double length() const { return std::hypot(x1 - x0, y1 - y0); }
};

inline int add_bar(World<double>& world, const Bar& bar, double mass = 1) {
  const double l = bar.length();
  return world.add_body({.x = (bar.x0 + bar.x1) / 2,
                         .y = (bar.y0 + bar.y1) / 2,
                         .angle = std::atan2(bar.y1 - bar.y0, bar.x1 - bar.x0),
                         .mass = mass,
                         .inertia = mass * l * l / 12});
}

// Pins two bodies together at a point of the world.
inline int pin(World<double>& world, int a, int b, double x, double y) {
  const auto q = world.pose(a);
  const double dx = x - q.x, dy = y - q.y;
  return world.add_joint({"revolute", {a, b}, {{"pa", {q.c * dx + q.s * dy, q.c * dy - q.s * dx}}}, {}});
}

// A zigzag of `links` links that hangs from the ground.
inline void add_zigzag(World<double>& world, int links) {
  int before = world.ground();
  double x = 0, y = 0;
  for (int i = 0; i < links; ++i) {
    const double angle = i % 2 ? 0.5 : -0.4;
    const Bar bar{x, y, x + 0.2 * std::cos(angle), y + 0.2 * std::sin(angle)};
    const int link = add_bar(world, bar, 1 + 0.1 * (i % 3));
    pin(world, before, link, x, y);
    x = bar.x1, y = bar.y1;
    before = link;
  }
}

inline void add_slider_crank(World<double>& world) {
  const double angle = 0.7, x = 0.15 * std::cos(angle), y = 0.15 * std::sin(angle);
  const double end = x + std::sqrt(0.4 * 0.4 - y * y);
  const int crank = add_bar(world, {0, 0, x, y}), rod = add_bar(world, {x, y, end, 0}, 0.5);
  const int slider = world.add_body({.x = end, .mass = 0.3, .inertia = 1e-3});
  pin(world, world.ground(), crank, 0, 0);
  pin(world, crank, rod, x, y);
  pin(world, rod, slider, end, 0);
  world.add_joint({"prismatic", {slider, world.ground()}, {{"pa", {0, 0}}, {"pb", {0, 0}}, {"t", {0, 1}}}, {}});
}

inline void add_four_bar(World<double>& world) {
  const Bar crank{0, 0, 0.2, 0.4}, coupler{0.2, 0.4, 1.1, 0.9}, rocker{1.1, 0.9, 1.2, 0};
  const int a = add_bar(world, crank), b = add_bar(world, coupler), c = add_bar(world, rocker);
  pin(world, world.ground(), a, 0, 0);
  pin(world, a, b, 0.2, 0.4);
  pin(world, b, c, 1.1, 0.9);
  pin(world, c, world.ground(), 1.2, 0);
}

// n x n rotating squares, each hinged to its neighbours at its corners: all close together. Of 2 (2 n (n - 1)) + 2 rows
// all but (n - 2)^2 are independent; flat at phi = 0.
inline void add_rotating_squares(World<double>& world, int n, double phi, double rate = 0) {
  const double arm = 0.5, pitch = 2 * arm * std::cos(phi), opening = -2 * arm * std::sin(phi) * rate;
  std::vector<int> unit;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double sign = (i + j) % 2 ? -1 : 1;
      unit.push_back(world.add_body({.x = i * pitch,
                                     .y = j * pitch,
                                     .angle = sign * phi,
                                     .vx = i * opening,
                                     .vy = j * opening,
                                     .w = sign * rate,
                                     .mass = 1,
                                     .inertia = 1.0 / 12}));
    }
  const auto hinge = [&](int a, int b, double x, double y) {
    world.add_joint({"revolute", {a, b}, {{"pa", {arm * x, arm * y}}, {"pb", {-arm * x, -arm * y}}}, {}});
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (i + 1 < n) hinge(unit[j * n + i], unit[j * n + i + 1], 1, 0);
      if (j + 1 < n) hinge(unit[j * n + i], unit[(j + 1) * n + i], 0, 1);
    }
  pin(world, world.ground(), unit[0], 0, 0);
}

// A trunk of three, a head, and four limbs of three links each.
inline void add_ragdoll(World<double>& world) {
  const int pelvis = add_bar(world, {0, 0, 0, 0.2}), belly = add_bar(world, {0, 0.2, 0, 0.4}),
            chest = add_bar(world, {0, 0.4, 0, 0.6}), head = add_bar(world, {0, 0.6, 0, 0.8});
  pin(world, pelvis, belly, 0, 0.2);
  pin(world, belly, chest, 0, 0.4);
  pin(world, chest, head, 0, 0.6);
  for (double side : {-1.0, 1.0}) {
    for (bool arm : {false, true}) {
      int before = arm ? chest : pelvis;
      double x = 0.05 * side, y = arm ? 0.55 : 0.0;
      for (int i = 0; i < 3; ++i) {
        const Bar bar{x, y, x + 0.15 * side, y - 0.1 * (i + 1)};
        const int link = add_bar(world, bar, 0.5);
        pin(world, before, link, x, y);
        x = bar.x1, y = bar.y1;
        before = link;
      }
    }
  }
}

inline SpatialBodyDefinition block(double x, double y, double z, double mass = 1) {
  SpatialBodyDefinition d;
  d.x = x, d.y = y, d.z = z;
  d.mass = mass;
  d.inertia = {0.1 * mass, 0.2 * mass, 0.25 * mass, 0.01 * mass, 0, 0.02 * mass};
  return d;
}

// Bodies end to end along x, held by `joint` ("spherical", "hinge", "fixed").
inline void add_spatial_chain(SpatialWorld<double>& world, int links, const char* joint) {
  int before = world.ground();
  for (int i = 0; i < links; ++i) {
    const int body = world.add_body(block(i + 0.5, 0.1 * (i % 2), 0.05 * (i % 3)));
    const auto q = world.pose(before);
    const NamedValue at{"pa", {i - q.x, -q.y, -q.z}};
    const double tilt = 0.3 * i;
    const NamedValue axis{"fa", {std::sin(tilt), 0.2, std::cos(tilt)}};
    if (std::string(joint) == "spherical") world.add_joint({joint, {before, body}, {at}, {}});
    else world.add_joint({joint, {before, body}, {at, axis}, {}});
    before = body;
  }
}

// A four-bar of hinges whose axes are parallel, 20 rows, 3 of them redundant; and its planar twin.
inline constexpr double loop_x[] = {0, 0.2, 1.1, 1.2}, loop_y[] = {0, 0.4, 0.9, 0};

inline void add_hinge_loop(SpatialWorld<double>& world) {
  int before = world.ground();
  const auto hinge = [&](int a, int b, int at) {
    const auto q = world.pose(a);
    world.add_joint({"hinge", {a, b}, {{"pa", {loop_x[at] - q.x, loop_y[at] - q.y, -q.z}}, {"fa", {0, 0, 1}}}, {}});
  };
  for (int i = 0; i < 3; ++i) {
    const int bar = world.add_body(block((loop_x[i] + loop_x[i + 1]) / 2, (loop_y[i] + loop_y[i + 1]) / 2, 0.1 * i));
    hinge(before, bar, i);
    before = bar;
  }
  hinge(before, world.ground(), 3);
}

inline void add_planar_hinge_loop(World<double>& world) {
  int before = world.ground();
  for (int i = 0; i < 3; ++i) {
    const int bar = world.add_body({.x = (loop_x[i] + loop_x[i + 1]) / 2,
                                    .y = (loop_y[i] + loop_y[i + 1]) / 2,
                                    .mass = 1,
                                    .inertia = block(0, 0, 0).inertia.zz});
    pin(world, before, bar, loop_x[i], loop_y[i]);
    before = bar;
  }
  pin(world, before, world.ground(), loop_x[3], loop_y[3]);
}

}  // namespace cdot::test
