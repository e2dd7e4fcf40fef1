// Forces along a length that starts at 0, where it has no direction: those that vanish there start by the motion, the
// others are refused.
#include <cmath>
#include <string>

#include "tests/runtime/effects/generated_effects.hpp"

namespace cdot::test {
namespace {

using effects::ball;
using effects::expect_orders;
using effects::with;

JointDefinition at_the_anchor(World<double>& world, int body, const char* type, std::vector<NamedValue> numbers) {
  JointDefinition joint{type, {world.ground(), body}, {{"pa", {0, 0}}, {"pb", {0, 0}}}, {}};
  joint.parameters.insert(joint.parameters.end(), numbers.begin(), numbers.end());
  return joint;
}

// m y'' = -m g - k y from rest at y = 0: y = -m g/k (1 - cos(w t)), w^2 = k/m.
TEST(LengthZero, ASpringWithoutLengthIsAnOscillator) {
  constexpr double k = 12, g = 9.81, T = 1.5;
  expect_orders("a spring that starts without length", 0.05, 0.3, [&](Integrator integrator, double h) {
    World<double> world(with(integrator, -g));
    const int body = ball(world, 0, 0);
    world.add_joint(at_the_anchor(world, body, "spring", {{"k", {k}}, {"rest", {0}}}));
    effects::advance(world, T, h);
    return std::abs(world.pose(body).y + g / k * (1 - std::cos(std::sqrt(k) * T)));
  });
}

// A slack cord pulls by k (rounding / rest)^4 or so: a jumper falls from the anchor as free bodies do.
TEST(LengthZero, ASlackCordLetsAJumperFall) {
  expect_orders("a jumper before the cord is taut", 0.05, 0.3, [&](Integrator integrator, double h) {
    World<double> world(with(integrator, -9.81));
    const int body = ball(world, 0, 0);
    world.add_joint(at_the_anchor(world, body, "bungee", {{"k", {60}}, {"rest", {20}}}));
    effects::advance(world, 1.0, h);
    return std::abs(world.pose(body).y + 9.81 / 2);
  });
}

std::string refusal(const auto& add) {
  World<double> world;
  const int body = ball(world, 0, 0);
  try {
    add(world, body);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(LengthZero, AForceWithoutADirectionIsRefused) {
  const auto effect = [](World<double>& world, int body) {
    world.add_joint(at_the_anchor(world, body, "spring", {{"k", {100}}, {"rest", {1}}}));
  };
  const auto soft = [](World<double>& world, int body) {
    JointDefinition joint = at_the_anchor(world, body, "distance", {{"l", {1}}});
    joint.soft = Softness{.by_frequency = false, .stiffness = 100};
    world.add_joint(joint);
  };
  const auto rigid = [](World<double>& world, int body) {
    world.add_joint(at_the_anchor(world, body, "distance", {{"l", {0}}}));
  };
  EXPECT_NE(refusal(effect).find("effect `spring` pushes by 100 where its row 1 has no direction"), std::string::npos)
      << refusal(effect);
  EXPECT_NE(refusal(soft).find("a spring 1 away from its rest has no direction"), std::string::npos) << refusal(soft);
  EXPECT_NE(refusal(rigid).find("Hold the points together with a `revolute`"), std::string::npos) << refusal(rigid);
}

}  // namespace
}  // namespace cdot::test
