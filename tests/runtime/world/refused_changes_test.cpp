// A running World refuses invalid changes, and every bit of its State stays.
#include "tests/methods.hpp"
#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

TEST(Changes, ThatMakeNoSenseAreRefusedAndChangeNothing) {
  World<double> world(settings(Solver::direct, Drift::projection, -9.81));
  const auto rods = add_chain(world, 2, -0.4);
  const int a = world.add_body({.x = 5, .mass = 1, .inertia = 1}),
            b = world.add_body({.x = 5, .mass = 1, .inertia = 1});
  world.add_joint({"distance", {a, b}, {{"pa", {1, 0}}, {"pb", {0, 0}}, {"l", {1}}}, {}});
  const int motor = add_motor(world, 1, "angle", {.speed = 1, .max_force = 20});
  const int lock = add_limit(world, 0, "angle", {.lower = 0, .upper = 0});
  run(world, 0.02, 0.01);
  const Snapshot whole = world.snapshot();
  const auto refused = [&](auto change, const std::string& why) {
    try {
      change();
      ADD_FAILURE() << "taken: " << why;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
    EXPECT_EQ(world.snapshot().differences(whole), std::vector<std::string>{}) << why;
  };
  refused([&] { world.remove_joint(7); }, "there is no joint number 7");
  refused([&] { world.set_parameters(-1, {}); }, "there is no joint number -1");
  refused([&] { world.set_parameters(2, {{"length", {1}}}); }, "its parameters are");
  refused([&] { world.set_parameters(2, {{"l", {1, 2}}}); }, "takes 1 number, not 2");
  refused([&] { world.set_parameters(2, {{"l", {NAN}}}); }, "is not finite");
  refused([&] { world.set_parameters(2, {{"l", {2}}, {"l", {1}}}); }, "given twice");
  world.set_pose(a, {5, 0, 0}), world.set_pose(b, {6, 0, 0});
  const Snapshot moved = world.snapshot();
  EXPECT_THROW(world.set_parameters(2, {{"l", {0}}}), Error);  // its points coincide: no direction
  EXPECT_EQ(world.snapshot(), moved);
  world.restore(whole);
  refused([&] { set_motor(world, 1, 2, {}); }, "joint number 1 has no effect number 2");
  refused([&] { set_motor(world, 1, 0, {}); }, "joint number 1 has no effect number 0");
  refused([&] { set_motor(world, 0, lock, {}); }, "effect number 1 of joint number 0 is not a motor");
  refused([&] { set_limit(world, 1, motor, {.lower = 0, .upper = 1}); }, "is not a limit");
  refused([&] { set_motor(world, 1, motor, {.speed = NAN}); }, "a motor's speed must be finite");
  refused([&] { set_limit(world, 0, lock, {.lower = 2, .upper = 1}); }, "must not lie above");
}

}  // namespace
}  // namespace cdot::test
