// Runs a compiled scene beside the World: both move alike, to round-off.
#pragma once

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

inline World<double> world_of(const std::string& file, Integrator integrator) {
  Scene scene = read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file);
  scene.settings.integrator = integrator;
  scene.accuracy = 0;
  settle_drift(scene);
  return build_world<double>(scene);
}

// The largest distance [m], [rad] between the bodies of both.
template <class Compiled>
double distance(const typename Compiled::State& state, const World<double>& world) {
  double farthest = 0;
  for (int body = 0, k = 0; body < world.body_count() && k < Compiled::bodies; ++body) {
    if (world.is_static(body)) continue;
    const auto place = world.place(body);
    const auto& q = state.q[k++];
    farthest = std::max({farthest, std::abs(place.x - q.x), std::abs(place.y - q.y), std::abs(place.angle - q.angle)});
    if (!std::isfinite(q.x + q.y + q.angle)) return std::numeric_limits<double>::infinity();
  }
  return farthest;
}

template <class Compiled>
void runs_as_the_world(const std::string& file, Integrator integrator) {
  constexpr double step = 0.001, until = 0.7;  // [s]; the four-bar is singular at 0.708 s
  auto world = world_of(file, integrator);
  typename Compiled::State state;
  Compiled::reset(state);
  double farthest = 0, moved = 0;
  const double start = state.q[0].y;
  for (int k = 0; k < static_cast<int>(until / step); ++k) {
    ASSERT_TRUE(world.step(step));
    EXPECT_LT(Compiled::step(state, step), 1e-12) << file;
    farthest = std::max(farthest, distance<Compiled>(state, world));
    moved = std::max(moved, std::abs(state.q[0].y - start));
  }
  EXPECT_LT(farthest, 1e-10) << file;
  EXPECT_NEAR(Compiled::energy(state), world.energy(), 1e-9) << file;
  EXPECT_TRUE(file.ends_with("cantilever.toml") || moved > 1e-4) << file;
  ::testing::Test::RecordProperty(file, std::to_string(farthest * 1e15));
}

}  // namespace cdot
