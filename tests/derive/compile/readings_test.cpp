// Readings of a compiled struct: coordinates of joints with their rates, and reactions.
#include <cmath>
#include <gtest/gtest.h>

#include <cdot/pack.hpp>
#include <cdot/spatial.hpp>

#include "hinges_rk4.hpp"
#include "machine_rk4.hpp"
#include "robot_arm_rk4.hpp"
#include "simple_pendulum_rk4.hpp"
#include "slider_crank_rattle.hpp"
#include "slider_crank_rk4.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "timed_joints_rk4.hpp"

namespace cdot {
namespace {

auto numbers(const planar::Wrench& w) { return std::array{w.force_x, w.force_y, w.torque}; }
auto numbers(const spatial::Wrench& w) {
  return std::array{w.force_x, w.force_y, w.force_z, w.torque_x, w.torque_y, w.torque_z};
}
template <class Compiled>
auto numbers_of_load(const typename Compiled::Velocity& v) {
  if constexpr (is_spatial<Compiled>) return std::array{v.x, v.y, v.z, v.wx, v.wy, v.wz};
  else return std::array{v.x, v.y, v.w};
}

// After 300 steps of 1 ms, by the names and in the order of the scene's joints.
template <class Compiled>
void reads_as_the_world(const std::string& file, Integrator integrator) {
  using S = std::conditional_t<is_spatial<Compiled>, Spatial<double>, Planar<double>>;
  auto world = world_of<S>(read_scene(std::string(CDOT_SOURCE_DIR) + "/" + file), integrator);
  typename Compiled::State state;
  Compiled::reset(state);
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(world.step(0.001));
    Compiled::step(state, 0.001);
  }
  double value[Compiled::coordinates], rate[Compiled::coordinates], largest = 0;
  Compiled::coordinates_of(state, value, rate);
  typename Compiled::Velocity load[Compiled::reactions];
  Compiled::reactions_of(state, load);
  int number = 0;
  ASSERT_EQ(world.joint_count(), Compiled::reactions);
  for (int j = 0; j < world.joint_count(); ++j) {
    for (const CoordinateInfo& coordinate : world.joint_type(j).coordinates) {
      const std::string what = file + ", joint " + std::to_string(j + 1) + ", " + std::string(coordinate.name);
      ASSERT_LT(number, Compiled::coordinates) << what;
      const double off = value[number] - double(world.coordinate(j, coordinate.name));
      const bool winds = is_spatial<Compiled> && coordinate.unit == "rad";  // the World counts whole turns
      EXPECT_NEAR(winds ? std::remainder(off, 2 * std::acos(-1)) : off, 0, 1e-8) << what;
      EXPECT_NEAR(rate[number], world.coordinate_rate(j, coordinate.name), 1e-7) << what;
      largest = std::max(largest, std::abs(rate[number++]));
    }
    if (integrator == Integrator::rattle) continue;  // the World's are the mean of both halves
    const auto right = numbers(world.reaction(j, world.joint_bodies(j).back()));
    const auto found = numbers_of_load<Compiled>(load[j]);
    double size = 1;
    for (const double x : right) size = std::max(size, std::abs(x));
    for (std::size_t c = 0; c < right.size(); ++c)
      EXPECT_NEAR(found[c], right[c], 1e-7 * size) << file << ", joint " << j + 1 << ", column " << c + 1;
  }
  EXPECT_EQ(number, Compiled::coordinates);
  EXPECT_GT(largest, 0.1) << file;
}

TEST(CompiledReadings, AreThoseOfTheWorld) {
  using namespace scenes;
  reads_as_the_world<slider_crank_rk4<double>>("specs/scenes/slider_crank.toml", Integrator::rk4);
  reads_as_the_world<slider_crank_rattle<double>>("specs/scenes/slider_crank.toml", Integrator::rattle);
  reads_as_the_world<hinges_rk4<double>>("tests/derive/compile/scenes/hinges.toml", Integrator::rk4);
  reads_as_the_world<timed_joints_rk4<double>>("tests/derive/compile/scenes/timed_joints.toml", Integrator::rk4);
  reads_as_the_world<machine_rk4<double>>("specs/scenes/machine.toml", Integrator::rk4);
  reads_as_the_world<robot_arm_rk4<double>>("specs/scenes/robot_arm.toml", Integrator::rk4);
}

// A point of mass m on a rod pulls the pin by m (g cos(angle) + l w^2), the angle from straight down.
TEST(CompiledReadings, OfAPendulumAreInClosedForm) {
  using Pendulum = scenes::simple_pendulum_rk4<double>;
  Pendulum::State state;
  Pendulum::reset(state);
  for (int k = 0; k < 400; ++k) Pendulum::step(state, 0.001);
  Pendulum::Velocity load[Pendulum::reactions];
  Pendulum::reactions_of(state, load);
  const Pendulum::Pose& bob = state.q[0];
  const Pendulum::Velocity& v = state.v[0];
  const double l = std::hypot(bob.x, bob.y), speed = std::hypot(v.x, v.y), g = 9.81;
  const double down = -bob.y / l, pull = g * down + speed * speed / l;  // by unit of mass
  const double size = std::hypot(load[0].x, load[0].y), mass = 1;
  EXPECT_NEAR(size, mass * pull, 1e-6 * pull);
  EXPECT_NEAR(load[0].x * bob.x + load[0].y * bob.y, -size * l, 1e-6 * size) << "towards the pin";
}

TEST(CompiledReadings, AreInLanesAsAlone) {
  using Alone = scenes::slider_crank_rk4<double>;
  using Lanes = scenes::slider_crank_rk4<Pack<double, 4>>;
  Alone::State alone;
  Lanes::State together;
  Alone::reset(alone), Lanes::reset(together);
  for (int k = 0; k < 50; ++k) Alone::step(alone), Lanes::step(together);
  double value[Alone::coordinates], rate[Alone::coordinates];
  Pack<double, 4> values[Lanes::coordinates], rates[Lanes::coordinates];
  Alone::coordinates_of(alone, value, rate), Lanes::coordinates_of(together, values, rates);
  for (int k = 0; k < Alone::coordinates; ++k)
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_EQ(values[k][lane], value[k]);
      EXPECT_EQ(rates[k][lane], rate[k]);
    }
}

}  // namespace
}  // namespace cdot
