// Runs a compiled scene beside the World: both move alike, to round-off; and lanes of it beside scenes of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <string>

#include <cdot/pack.hpp>
#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

inline World<double> world_of(Scene scene, Integrator integrator) {
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
void runs_as_the_world(const std::string& file, Integrator integrator, double within = 1e-10, double until = 0.7) {
  constexpr double step = 0.001;  // [s]; the four-bar is singular at 0.708 s
  auto world = world_of(read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), integrator);
  typename Compiled::State state;
  Compiled::reset(state);
  double farthest = 0, moved = 0;
  const auto start = state.q[0];
  for (int k = 0; k < static_cast<int>(until / step); ++k) {
    ASSERT_TRUE(world.step(step));
    EXPECT_LT(Compiled::step(state, step), 1e-12) << file;
    farthest = std::max(farthest, distance<Compiled>(state, world));
    moved = std::max({moved, std::abs(state.q[0].y - start.y), std::abs(state.q[0].angle - start.angle)});
  }
  EXPECT_LT(farthest, within) << file;
  EXPECT_NEAR(Compiled::energy(state), world.energy(), 10 * within) << file;
  EXPECT_TRUE(file.ends_with("cantilever.toml") || moved > 1e-4) << file;
  ::testing::Test::RecordProperty(file, std::to_string(farthest * 1e15));
}

// Lane k starts with its first body turning k times as fast.
template <template <class> class Compiled>
void lanes_are_as_alone() {
  constexpr int lanes = 4;
  using Lanes = Pack<double, lanes>;
  typename Compiled<Lanes>::State together;
  typename Compiled<double>::State alone[lanes];
  Compiled<Lanes>::reset(together);
  for (int lane = 0; lane < lanes; ++lane) {
    Compiled<double>::reset(alone[lane]);
    alone[lane].v[0].w = 0.5 * lane;
    together.v[0].w.set(lane, 0.5 * lane);
    Compiled<double>::begin(alone[lane]);
  }
  Compiled<Lanes>::begin(together);
  for (int k = 0; k < 300; ++k) {
    Compiled<Lanes>::step(together);
    for (int lane = 0; lane < lanes; ++lane) {
      Compiled<double>::step(alone[lane]);
      for (int i = 0; i < Compiled<double>::bodies; ++i) {
        const auto& q = together.q[i];
        const double of_lane[] = {q.x[lane], q.y[lane], q.angle[lane]};
        const double of_alone[] = {alone[lane].q[i].x, alone[lane].q[i].y, alone[lane].q[i].angle};
        ASSERT_EQ(std::memcmp(of_lane, of_alone, sizeof of_lane), 0) << "lane " << lane << ", step " << k;
      }
    }
  }
  EXPECT_NE(together.q[0].angle[0], together.q[0].angle[lanes - 1]);
}

}  // namespace cdot
