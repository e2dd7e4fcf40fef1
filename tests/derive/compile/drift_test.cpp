// Euler's steps that do not project their ends: as the World does, whose joints open alike.
#include <gtest/gtest.h>

#include "four_bar_baumgarte.hpp"
#include "four_bar_none.hpp"
#include "gyroscope_baumgarte.hpp"
#include "gyroscope_none.hpp"
#include "slider_crank_baumgarte.hpp"
#include "slider_crank_none.hpp"
#include "tailgate_baumgarte.hpp"
#include "tailgate_none.hpp"
#include "tests/derive/compile/beside_world.hpp"
#include "tests/derive/compile/command.hpp"

namespace {

using cdot::Drift;

// The largest |C| of the run.
template <class Compiled>
double opens_as_in_the_world(const std::string& file, Drift drift) {
  using S = std::conditional_t<cdot::is_spatial<Compiled>, cdot::Spatial<double>, cdot::Planar<double>>;
  cdot::Scene scene = cdot::read_scene(std::string(CDOT_SOURCE_DIR) + "/specs/scenes/" + file + ".toml");
  scene.drift = drift;
  auto world = cdot::world_of<S>(scene, cdot::Integrator::euler);
  typename Compiled::State state;
  Compiled::reset(state);
  double farthest = 0, widest = 0;
  for (int k = 0; k < 300; ++k) {
    EXPECT_TRUE(world.step(0.001)) << file;
    const double open = Compiled::step(state, 0.001);
    EXPECT_NEAR(open, world.worst_position_error().value, 1e-10) << file;
    farthest = std::max(farthest, cdot::distance<Compiled>(state, world)), widest = std::max(widest, open);
  }
  EXPECT_LT(farthest, 1e-10) << file;
  return widest;
}

TEST(CompiledDrift, FeedsAShareOfCBackAsTheWorld) {
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::slider_crank_baumgarte<double>>("slider_crank", Drift::baumgarte),
            1e-4);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::tailgate_baumgarte<double>>("tailgate", Drift::baumgarte), 1e-9);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::four_bar_baumgarte<double>>("spatial/four_bar", Drift::baumgarte),
            1e-6);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::gyroscope_baumgarte<double>>("spatial/gyroscope", Drift::baumgarte),
            1e-6);
}

TEST(CompiledDrift, LeavesJointsToDriftAsTheWorld) {
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::slider_crank_none<double>>("slider_crank", Drift::none), 1e-4);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::tailgate_none<double>>("tailgate", Drift::none), 1e-9);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::four_bar_none<double>>("spatial/four_bar", Drift::none), 1e-6);
  EXPECT_GT(opens_as_in_the_world<cdot::scenes::gyroscope_none<double>>("spatial/gyroscope", Drift::none), 1e-6);
}

TEST(CompiledDrift, IsRefusedWhereAStepMustProject) {
  const auto refused = [](const std::string& arguments, const std::string& why) {
    const cdot::ShellResult outcome = cdot::compile(arguments);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.text.find(why), std::string::npos) << outcome.text;
  };
  refused("specs/scenes/slider_crank.toml --integrator rattle --drift none", "projects its end, unless euler");
  refused("specs/scenes/robot_arm.toml --integrator euler --drift baumgarte",
          "wrist.angle.brake: cdot compile knows rows with bounds and joints that break only with projections");
}

}  // namespace
