// Mechanisms that floats or steps do not resolve: limits, and told as such.
#include <gtest/gtest.h>

#include "runtime/tool/scene/scene.hpp"
#include "tests/torture/draw/generate.hpp"
#include "tests/torture/invariants.hpp"

namespace cdot::torture {
namespace {

// Springs do work on the round-off of poses. In floats that is more than these slow bodies have; in doubles it is not.
TEST(Torture, SpringsAtTheRoundOffOfFloatsAreLimits) {
  Asked asked;
  asked.swept = 0x16658b400;
  Wish wish{.steps = 30};
  wish.integrator = Integrator::implicit;
  Scene scene = generate(*asked.swept, wish).scene;
  EXPECT_TRUE(scene.single);
  EXPECT_EQ(judge(scene, asked).what, "steps by sweeps: no step resolves the force of an effect");
  scene.single = false;
  EXPECT_EQ(judge(scene, asked).outcome, Outcome::held);
}

// A coordinate has no direction at its pole, and about it the World resolves an end by as much as it turns.
TEST(Torture, AnEndThatPassesItsPoleIsALimit) {
  const Scene scene = read_scene(CDOT_FOUND "/limited/end_that_passes_its_pole.toml");
  EXPECT_TRUE(scene.single);
  Asked asked;
  asked.bits = false;
  EXPECT_EQ(judge(scene, asked).what, "the direction of an end turns in a step");
}

}  // namespace
}  // namespace cdot::torture
