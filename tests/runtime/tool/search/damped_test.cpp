// A light body behind a strong damper: explicit steps are as short as the damper is strong, though nothing oscillates.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tuple>

#include <cdot/methods.hpp>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::damped_test {
namespace {

// A thumb on a hand that swings. Its damper decays at 2e5 1/s for each N m s.
Scene hand_with_thumb(const std::string& joint, const char* method) {
  return read_scene(fmt::format(R"(
duration = 2
gravity = [0, -9.81]
{}
[[body]]
name = "hand"
mass = 0.4
inertia = 1e-3
position = [0.1, 0]
[[body]]
name = "thumb"
mass = 0.01
inertia = 1e-6
position = [0.22, 0]
[[joint]]
type = "revolute"
bodies = ["world", "hand"]
at = [0, 0]
[[joint]]
bodies = ["hand", "thumb"]
at = [0.2, 0]
{}
)",
                                method, joint),
                    "hand");
}
std::string damped(double damping) {
  return fmt::format("type = \"revolute\"\nangle.spring = {{ stiffness = 0.1, damping = {}, rest = 0 }}", damping);
}

// Beside explicit steps, which follow each damper. The strongest one is beside a weld: the thumb's weight of 2 mN m
// turns it by 4e-5 rad.
TEST(DefaultAccuracy, IsReachedCheaplyBehindStrongDampers) {
  for (const auto& [damping, reference, slip] : {std::tuple(0.01, damped(0.01), 0.0), std::tuple(1.0, damped(1), 0.0),
                                                 std::tuple(100.0, std::string("type = \"weld\""), 4e-5)}) {
    const Scene scene = hand_with_thumb(damped(damping), "");
    const auto [result, rows] = recorded(scene, 0.5);
    const std::vector<Frame> fine =
        run_of(hand_with_thumb(reference, "integrator = \"dop853\"\nlocal_error = 1e-9"), 2, 0.5);
    const Choice& choice = result.choice.value();
    double off = 0;
    ASSERT_EQ(rows.size(), fine.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t body = 0; body < rows[k].bodies.size(); ++body) {
        const BodyState &here = rows[k].bodies[body], &there = fine[k].bodies[body];
        off = std::max({off, std::hypot(here.x - there.x, here.y - there.y), std::abs(here.angle - there.angle)});
      }
    fmt::print("  {} N m s: {}, {} evaluations and {} before, {:.1e} claimed, off by {:.1e}\n", damping,
               name_of(integrators, choice.integrator), choice.evaluations, choice.evaluations_before, choice.achieved,
               off);
    EXPECT_TRUE(choice.reached) << damping;
    EXPECT_LE(off, choice.achieved + slip) << damping;
    EXPECT_LE(choice.evaluations + choice.evaluations_before, 30000) << damping;
  }
}

}  // namespace
}  // namespace cdot::test::damped_test
