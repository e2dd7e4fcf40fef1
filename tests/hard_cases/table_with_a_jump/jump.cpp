// A motor follows a table whose speed jumps: at full torque to 3 rad/s in 1.5 s, from 2.005 s on to -3 rad/s in 3 s.
#include <algorithm>
#include <cmath>

#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::table_with_a_jump {
namespace {

void follow(Trial& t) {
  constexpr double gain = 2, speed = 3, jump = 2.005, end = 6;  // [rad/s^2], [rad/s], [s], [s]
  t.start();
  double fast = 0;
  const auto rate = [&] { return t.ask([](const auto& world) { return double(world.coordinate_rate(0, "angle")); }); };
  t.run(end, 0, [&] { fast = std::max(fast, std::abs(rate())); });
  const double run_up = speed * speed / gain / 2, there = speed * (jump - speed / gain);
  const double back = speed * (end - jump - 2 * speed / gain);
  t.at_most("faster than the table [rad/s]", fast - speed, 1e-9, 1e-5);
  t.near("speed at the end [rad/s]", rate(), -speed, 1e-9, 1e-5);
  t.near("way [rad]", t.coordinate(0, "angle"), run_up + there - back, gain * (2 * speed / gain) * h);
}

const Register planar({"table_with_a_jump", "planar", all_ways(), follow});
const Register spatial({"table_with_a_jump", "spatial", all_ways(), follow});

}  // namespace
}  // namespace cdot::hard::table_with_a_jump
