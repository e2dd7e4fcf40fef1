// Runs a compiled scene beside the World: both move alike, to round-off; and lanes of it beside scenes of their own.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <type_traits>

#include <cdot/pack.hpp>
#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

namespace cdot {

template <class S = Planar<double>>
BasicWorld<S> world_of(Scene scene, Integrator integrator) {
  scene.settings.integrator = integrator;
  scene.accuracy = 0;
  settle_drift(scene);
  BasicWorld<S> world = build_world_in<S>(scene);
  if (scene.project) world.project(1e-12);
  return world;
}

template <class Compiled>
constexpr bool is_spatial = requires(typename Compiled::Pose q) {
  q.e0;
};

// Of a pose: places, and the angle or the quaternion.
template <class Compiled, class T>
auto numbers_of(const T& q) {
  if constexpr (is_spatial<Compiled>) return std::array{q.x, q.y, q.z, q.e0, q.e1, q.e2, q.e3};
  else return std::array{q.x, q.y, q.angle};
}

// The largest distance [m], [rad] between the bodies of both.
template <class Compiled, class S>
double distance(const typename Compiled::State& state, const BasicWorld<S>& world) {
  double farthest = 0;
  for (int body = 0, k = 0; body < world.body_count() && k < Compiled::bodies; ++body) {
    if (world.is_static(body)) continue;
    const auto place = numbers_of<Compiled>(world.place(body)), q = numbers_of<Compiled>(state.q[k++]);
    for (std::size_t n = 0; n < q.size(); ++n) {
      if (!std::isfinite(q[n])) return std::numeric_limits<double>::infinity();
      farthest = std::max(farthest, std::abs(place[n] - q[n]));
    }
  }
  return farthest;
}

// reset() sets every byte of a State, so that equal States have equal bytes.
template <class Compiled>
void sets_every_byte() {
  using State = typename Compiled::State;
  alignas(State) unsigned char some[sizeof(State)], others[sizeof(State)];
  std::memset(some, 0x55, sizeof some), std::memset(others, 0xaa, sizeof others);
  Compiled::reset(*reinterpret_cast<State*>(some)), Compiled::reset(*reinterpret_cast<State*>(others));
  for (std::size_t k = 0; k < sizeof some; ++k) ASSERT_EQ(some[k], others[k]) << k << " of " << sizeof some;
}

template <class Compiled>
void runs_as_the_world(const std::string& file, Integrator integrator, double within = 1e-10, double until = 0.7,
                       double step = 0.001) {  // [s]; the four-bar is singular at 0.708 s
  using S = std::conditional_t<is_spatial<Compiled>, Spatial<double>, Planar<double>>;
  auto world = world_of<S>(read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), integrator);
  sets_every_byte<Compiled>();
  typename Compiled::State state;
  Compiled::reset(state);
  double farthest = 0, moved = 0;
  const auto start = state.q[0];
  for (int k = 0; k < static_cast<int>(std::lround(until / step)); ++k) {
    ASSERT_TRUE(world.step(step));
    EXPECT_LT(Compiled::step(state, step), 1e-12) << file;
    farthest = std::max(farthest, distance<Compiled>(state, world));
    const auto from = numbers_of<Compiled>(start), now = numbers_of<Compiled>(state.q[0]);
    for (std::size_t n = 0; n < now.size(); ++n) moved = std::max(moved, std::abs(now[n] - from[n]));
  }
  EXPECT_LT(farthest, within) << file;
  EXPECT_NEAR(Compiled::energy(state), world.energy(), 10 * within) << file;
  EXPECT_TRUE(file.ends_with("cantilever.toml") || moved > 1e-4) << file;
  ::testing::Test::RecordProperty(file, std::to_string(farthest * 1e15));
}

// A copy of the State goes on with the same bits. Returns it at its end.
template <class Scene>
typename Scene::State snapshot_keeps(double step) {
  typename Scene::State state, kept;
  Scene::reset(state);
  for (int k = 0; k < 500; ++k) Scene::step(state, step);
  std::memcpy(&kept, &state, sizeof state);
  for (int k = 0; k < 500; ++k) Scene::step(state, step), Scene::step(kept, step);
  EXPECT_EQ(std::memcmp(&state, &kept, sizeof state), 0);
  return kept;
}

// Whether each row with bounds was at one of them in a run, and off it.
template <class Scene>
struct MetBounds {
  explicit MetBounds(int steps, double step = Scene::default_step) {
    typename Scene::State state;
    Scene::reset(state);
    for (int k = 0; k < steps; ++k) {
      Scene::step(state, step);
      for (int i = 0; i < Scene::bounded; ++i) (state.hold[i] == 0 ? between : at_bound)[i] = true;
    }
  }
  bool at_bound[Scene::bounded] = {}, between[Scene::bounded] = {};
};

// Of the first body about an axis.
template <class Compiled>
auto& spin_in(typename Compiled::State& state) {
  if constexpr (is_spatial<Compiled>) return state.v[0].wz;
  else return state.v[0].w;
}

// Lane k starts with its first body turning k times as fast.
template <template <class> class Compiled, class T = double>
void lanes_are_as_alone() {
  constexpr int lanes = 4;
  using Lanes = Compiled<Pack<T, lanes>>;
  using Alone = Compiled<T>;
  typename Lanes::State together;
  typename Alone::State alone[lanes];
  Lanes::reset(together);
  for (int lane = 0; lane < lanes; ++lane) {
    Alone::reset(alone[lane]);
    spin_in<Alone>(alone[lane]) = T(0.5 * lane);
    spin_in<Lanes>(together).set(lane, T(0.5 * lane));
    Alone::begin(alone[lane]);
  }
  Lanes::begin(together);
  for (int k = 0; k < 300; ++k) {
    Lanes::step(together);
    for (int lane = 0; lane < lanes; ++lane) {
      Alone::step(alone[lane]);
      for (int i = 0; i < Alone::bodies; ++i) {
        const auto q = numbers_of<Lanes>(together.q[i]);
        const auto of_alone = numbers_of<Alone>(alone[lane].q[i]);
        auto of_lane = of_alone;
        for (std::size_t n = 0; n < q.size(); ++n) of_lane[n] = q[n][lane];
        ASSERT_EQ(std::memcmp(&of_lane, &of_alone, sizeof of_lane), 0) << "lane " << lane << ", step " << k;
      }
    }
  }
  const auto q = numbers_of<Lanes>(together.q[0]);
  EXPECT_NE(q.back()[0], q.back()[lanes - 1]);
}

template <class Compiled>
typename Compiled::State state_after(int steps, double step = Compiled::default_step) {
  typename Compiled::State state;
  Compiled::reset(state);
  for (int k = 0; k < steps; ++k) Compiled::step(state, step);
  return state;
}

// solve(b, lambda, d) gives d = M^-1 J^T lambda with K lambda = b: then J d = b, whatever the way to K.
template <class Compiled, class Solve>
void solves_for_rows(const auto& J, double within, Solve solve) {
  double b[Compiled::rows], lambda[Compiled::rows], rate[Compiled::rows];
  for (int row = 0; row < Compiled::rows; ++row) b[row] = 0.2 + 0.1 * ((7 * row) % 11);
  typename Compiled::Velocity d[Compiled::bodies];
  solve(b, lambda, d);
  Compiled::rates(J, d, rate);
  for (int row = 0; row < Compiled::rows; ++row) EXPECT_NEAR(rate[row], b[row], within) << "row " << row;
}

}  // namespace cdot
