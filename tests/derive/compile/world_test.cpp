// A compiled scene moves as the World does, to round-off.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include <cdot/world.hpp>

#include "runtime/tool/scene/scene.hpp"

#define CDOT_EACH_SCENE(X, method) \
  X(cantilever, method)            \
  X(chain_10, method)              \
  X(compound_pendulum, method)     \
  X(crank_rocker, method)          \
  X(double_pendulum, method)       \
  X(four_bar, method)              \
  X(pulley_ratio1, method)         \
  X(pulley_ratio2, method)         \
  X(simple_pendulum, method)       \
  X(slider_crank, method)

// clang-format off
#include "cantilever_dop853.hpp"
#include "cantilever_euler.hpp"
#include "cantilever_rk4.hpp"
#include "chain_10_dop853.hpp"
#include "chain_10_euler.hpp"
#include "chain_10_rk4.hpp"
#include "compound_pendulum_dop853.hpp"
#include "compound_pendulum_euler.hpp"
#include "compound_pendulum_rk4.hpp"
#include "crank_rocker_dop853.hpp"
#include "crank_rocker_euler.hpp"
#include "crank_rocker_rk4.hpp"
#include "double_pendulum_dop853.hpp"
#include "double_pendulum_euler.hpp"
#include "double_pendulum_rk4.hpp"
#include "four_bar_dop853.hpp"
#include "four_bar_euler.hpp"
#include "four_bar_rk4.hpp"
#include "pulley_ratio1_dop853.hpp"
#include "pulley_ratio1_euler.hpp"
#include "pulley_ratio1_rk4.hpp"
#include "pulley_ratio2_dop853.hpp"
#include "pulley_ratio2_euler.hpp"
#include "pulley_ratio2_rk4.hpp"
#include "simple_pendulum_dop853.hpp"
#include "simple_pendulum_euler.hpp"
#include "simple_pendulum_rk4.hpp"
#include "slider_crank_dop853.hpp"
#include "slider_crank_euler.hpp"
#include "slider_crank_rk4.hpp"
// clang-format on

namespace {

using cdot::Integrator;

constexpr double step = 0.001, until = 0.7;  // [s]; the four-bar is singular at 0.708 s

cdot::World<double> world_of(const std::string& name, Integrator integrator) {
  cdot::Scene scene = cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/specs/scenes/" + name + ".toml");
  scene.settings.integrator = integrator;
  scene.accuracy = 0;
  cdot::settle_drift(scene);
  return cdot::build_world<double>(scene);
}

// The largest distance [m], [rad] between the bodies of both.
template <class Compiled>
double distance(const typename Compiled::State& state, const cdot::World<double>& world) {
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
void runs_as_the_world(const std::string& name, Integrator integrator) {
  auto world = world_of(name, integrator);
  typename Compiled::State state;
  Compiled::reset(state);
  double farthest = 0, moved = 0;
  const double start = state.q[0].y;
  for (int k = 0; k < static_cast<int>(until / step); ++k) {
    ASSERT_TRUE(world.step(step));
    Compiled::step(state, step);
    farthest = std::max(farthest, distance<Compiled>(state, world));
    moved = std::max(moved, std::abs(state.q[0].y - start));
  }
  EXPECT_LT(farthest, 1e-10) << name;
  EXPECT_LT(state.residual, 1e-12) << name;
  EXPECT_NEAR(Compiled::energy(state), world.energy(), 1e-9) << name;
  EXPECT_TRUE(name == "cantilever" || moved > 1e-4) << name;
  ::testing::Test::RecordProperty(name, std::to_string(farthest * 1e15));
}

#define CDOT_RUN(scene, method) runs_as_the_world<cdot::scenes::scene##_##method<double>>(#scene, Integrator::method);

TEST(CompiledScene, MovesByEulerAsTheWorld){CDOT_EACH_SCENE(CDOT_RUN, euler)} TEST(CompiledScene, MovesByRk4AsTheWorld){
    CDOT_EACH_SCENE(CDOT_RUN, rk4)} TEST(CompiledScene, MovesByDop853AsTheWorld) {
  CDOT_EACH_SCENE(CDOT_RUN, dop853)
}

}  // namespace
