// Rows that repeat each other at the start, but in this pose only: the motion that begins there tells which of them
// hold. Others that held for a moment would hinder it.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::shared_starts_test {
namespace {

struct Way {
  Integrator integrator;
  double local_error, step;
};
constexpr Way ways[] = {{Integrator::rk4, 0, 1e-3},
                        {Integrator::dop853, 1e-5, 0.02},
                        {Integrator::dop853, 1e-10, 0.02},
                        {Integrator::radau5, 1e-8, 0.02}};

std::string name_of(const Way& way) {
  return fmt::format("{} at {:.0e}", row_of(way.integrator).name, way.local_error);
}

// The bodies after 0.2 s.
std::vector<BodyState> run(const std::string& parts, const Way& way) {
  const std::string head = fmt::format("duration = 0.2\nstep = {}\ngravity = [0, -9.81]\n", way.step);
  Scene scene = read_scene(head + parts, "scene.toml");
  scene.settings.integrator = way.integrator, scene.settings.local_error = way.local_error;
  const auto [result, rows] = recorded(scene, 0.2);
  EXPECT_FALSE(result.failed_step) << name_of(way);
  EXPECT_EQ(result.counts.rescued, 0) << name_of(way);
  return rows.back().bodies;
}

double apart(const BodyState& a, const BodyState& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.angle - b.angle)});
}

// A disc on ropes from one place to points in line with it, pulled along them. As it falls, the shortest rope turns it
// most, so the others get slack: it moves as on that rope alone.
TEST(SharedStarts, OfRopesInLineTheShortestHolds) {
  const std::string disc = R"toml([[body]]
name = "disc"
mass = 5
shape = { disc = 0.4 }
position = [1.3, 0]
[[joint]]
type = "push"
bodies = ["disc"]
pa = [0, 0]
F = [2, 0]
)toml";
  const auto rope = [](double at) {
    return fmt::format(
        "[[joint]]\ntype = \"max_distance\"\nbodies = [\"world\", \"disc\"]\npa = [-0.3, 0]\npb = [{}, 0]\n", at);
  };
  for (const Way& way : ways) {
    const BodyState alone = run(disc + rope(0.1), way)[0];
    for (const std::string& ropes : {rope(0.1) + rope(0.5), rope(0.5) + rope(0.1), rope(0.5) + rope(0.1) + rope(0.3)}) {
      const BodyState now = run(disc + ropes, way)[0];
      fmt::print("  {}: {:.1e} apart from the motion on one rope\n", name_of(way), apart(now, alone));
      EXPECT_LT(apart(now, alone), 1e-6) << name_of(way) << '\n' << ropes;
    }
  }
}

// A rod falls about a pin at its end. At the start, friction along the rod acts where the pin holds as well. The rod's
// angle q obeys, for a rod of 1 kg and 1 m whose point at 0.75 m is d = 0.75 cos q - 0.6 deep in a seat of 100 N/m,
//
//   q''/3 = g/2 cos q - 100 d 0.75 sin q.
double angle_of_fall(double duration) {
  constexpr int steps = 20000;
  const double h = duration / steps;
  const auto rate = [](double q) {
    return 3 * (9.81 / 2 * std::cos(q) - 75 * (0.75 * std::cos(q) - 0.6) * std::sin(q));
  };
  double q = 0, v = 0;
  for (int k = 0; k < steps; ++k) {  // leap-frog, of order 2
    v += h / 2 * rate(q), q += h * v, v += h / 2 * rate(q);
  }
  return q;
}

TEST(SharedStarts, FrictionThatRepeatsAPinSlipsAtOnce) {
  const double exact = angle_of_fall(0.2);
  for (const Way& way : ways) {
    const BodyState rod = run(R"toml([[body]]
name = "rod"
mass = 1
shape = { rod = 1 }
position = [0, 0]
[[joint]]
type = "revolute"
bodies = ["world", "rod"]
at = [-0.5, 0]
[[joint]]
type = "press_fit"
bodies = ["rod", "world"]
pa = [0.25, 0]
pb = [0.1, 0]
t = [1, 0]
c = 100
)toml",
                              way)[0];
    fmt::print("  {}: {:.6f} rad, {:.1e} off\n", name_of(way), -rod.angle, -rod.angle - exact);
    EXPECT_NEAR(-rod.angle, exact, 1e-6) << name_of(way);
  }
}

// A motor turns an arm, which pulls a rod up by friction against its weight and its brake. These share the load as they
// like while all are at rest, and do not once the arm moves: then the pin carries 22 N. It breaks there, at once, so
// that the rod moves as without a pin.
TEST(SharedStarts, APinThatIsTooWeakOnceItMovesBreaksAtOnce) {
  const std::string bodies = R"toml([[body]]
name = "rod"
mass = 1
shape = { rod = 1 }
position = [0.1, 0]
[[body]]
name = "arm"
mass = 5
shape = { rod = 1 }
position = [1.3, 0.3]
[[joint]]
type = "revolute"
bodies = ["world", "arm"]
at = [0.8, 0.3]
angle.motor = { speed = "3 [rad/s] * sin(3*time / 1 [s])" }
[[joint]]
type = "press_fit"
bodies = ["arm", "rod"]
pa = [0.5, 0]
pb = [1.3, 0.3]
t = [1, 0]
c = 50
)toml";
  const auto pin = [](double strength) {
    return fmt::format(
        "[[joint]]\ntype = \"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [-0.4, 0]\nbreaking = {}\n"
        "angle.brake = {{ torque = 1 }}\n",
        strength);
  };
  for (const Way& way : ways) {
    const BodyState free = run(bodies, way)[0], weak = run(bodies + pin(20), way)[0],
                    strong = run(bodies + pin(1e3), way)[0];
    fmt::print("  {}: {:.1e} m apart from the motion without a pin\n", name_of(way), apart(weak, free));
    EXPECT_LT(apart(weak, free), 1e-6) << name_of(way);
    EXPECT_GT(apart(strong, free), 0.1) << name_of(way);
  }
}

// A rod falls and pulls a cart back by a rope, which a force of 8 N tightens. At the start the friction of the rail
// helps the rope to hold the cart, or the rope alone does. Once the rod falls the friction resists: the rope carries 8
// N + 0.1 * 3 kg * g, which is too much, and tears at once.
TEST(SharedStarts, ARopeThatIsTooWeakOnceItPullsTearsAtOnce) {
  const std::string bodies = R"toml([[body]]
name = "rod"
mass = 5
shape = { rod = 1 }
position = [0.1, 0]
[[body]]
name = "cart"
mass = 3
shape = { box = [1, 0.2] }
position = [1.3, 0]
[[joint]]
type = "revolute"
bodies = ["world", "rod"]
at = [-0.4, 0]
[[joint]]
type = "prismatic"
bodies = ["world", "cart"]
at = [1.3, 0]
slide.rail_friction = { mu = 0.1 }
[[joint]]
type = "push"
bodies = ["cart"]
pa = [0, 0]
F = [8, 0]
)toml";
  const auto rope = [](double strength) {
    return fmt::format(
        "[[joint]]\ntype = \"tearing_rope\"\nbodies = [\"rod\", \"cart\"]\npa = [0.4, 0]\n"
        "pb = [0, 0]\nstrength = {}\n",
        strength);
  };
  for (const Way& way : ways) {
    const BodyState free = run(bodies, way)[1], torn = run(bodies + rope(10), way)[1],
                    held = run(bodies + rope(100), way)[1];
    fmt::print("  {}: {:.1e} m apart from the motion without a rope\n", name_of(way), apart(torn, free));
    EXPECT_NEAR(free.x, 1.3 + (8 / 3. - 0.1 * 9.81) * 0.2 * 0.2 / 2, 1e-9) << name_of(way);
    EXPECT_LT(apart(torn, free), 1e-6) << name_of(way);
    EXPECT_LT(held.x, 1.3) << name_of(way);
  }
}

}  // namespace
}  // namespace cdot::test::shared_starts_test
