// A force from a table that jumps between steps: its impulse is that of the table, by every method.
#include "tests/hard_cases/trial.hpp"

namespace cdot::hard::table_with_jump {
namespace {

void kick(Trial& t) {
  t.start();
  t.run(1, 0, [] {});
  const auto ask = [&](auto number) { return t.ask([&](const auto& world) { return double(number(world)); }); };
  // 5000 N for 1 ms, -3 N for 0.1 s, 6 N for 0.1 s, over 2 kg; a constant torque beside them.
  t.near("speed [m/s]", ask([](const auto& world) { return world.velocity(0).x; }), 2.65, 1e-9);

  double x = 0, v = 0;
  for (const auto& [a, time] : {std::pair{2500.0, 0.001}, {0.0, 0.2937}, {-1.5, 0.1}, {3.0, 0.1}})
    x += v * time + a / 2 * time * time, v += a * time;
  t.near("way [m]", ask([](const auto& world) { return world.pose(0).x; }), x, 5e-3);
}

const Register planar({"table_with_jump", "planar", all_ways(), kick});
const Register spatial({"table_with_jump", "spatial", all_ways(), kick});

}  // namespace
}  // namespace cdot::hard::table_with_jump
