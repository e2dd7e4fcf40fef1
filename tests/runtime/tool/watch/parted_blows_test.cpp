// Blows that equal steps take in two parts: where these turn round the slip of a pin whose friction they load, or push
// back a motor of unlimited force, the run tells.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/text/files.hpp"
#include "tests/runtime/tool/followed_advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::parted_blows_test {
namespace {

// An arm of two rods falls from level onto an end at -0.1 rad. The elbow has bent upwards, and then bends down. The
// shoulder only stops.
std::string arm_on_an_end(const std::string& rough_joint) {
  const auto friction_of = [&](const std::string& joint) -> std::string {
    return joint == rough_joint ? "angle.pin_friction = { mu = 0.4, radius = 0.1 }\n" : "";
  };
  return "gravity = [0, -9.81]\nduration = 0.2\n[[body]]\nname = \"arm\"\nmass = 2\nshape = { rod = 1 }\n"
         "position = [0.5, 0]\n[[body]]\nname = \"fore\"\nmass = 5\nshape = { rod = 1 }\nposition = [1.5, 0]\n"
         "[[joint]]\nname = \"shoulder\"\ntype = \"revolute\"\nbodies = [\"world\", \"arm\"]\nat = [0, 0]\n"
         "angle.limit = { lower = -0.1 }\n" +
         friction_of("shoulder") +
         "[[joint]]\nname = \"elbow\"\ntype = \"revolute\"\nbodies = [\"arm\", \"fore\"]\nat = [1, 0]\n" +
         friction_of("elbow");
}

std::string warning_of(const std::string& scene, const std::string& method, double step) {
  const TemporaryFolder folder;
  const std::string file = (folder / "scene.toml").string();
  text::write_file(file, scene);
  return simulated(file, fmt::format("--step {} --integrator {}", step, method)).summary["decision_warning"];
}

TEST(SlipWatch, TellsABlowInTwoParts) {
  for (const double step : {4e-4, 2e-4, 1e-4}) {
    for (const std::string method : {"euler", "implicit"}) {
      const std::string told = warning_of(arm_on_an_end("elbow"), method, step);
      EXPECT_EQ(told.find("a blow by t = 0.1"), 0u) << method << " " << step << ": " << told;
      EXPECT_NE(told.find("turns round the slip of joint \"elbow\""), told.npos) << method << " " << step;
      EXPECT_EQ(warning_of(arm_on_an_end("shoulder"), method, step), "") << method;
    }
    for (const std::string method : {"rattle", "rk4", "dop853"})
      EXPECT_EQ(warning_of(arm_on_an_end("elbow"), method, step), "") << method << " " << step;
  }
}

// dop853 and rk4 locate the blow, and the motor stays.
TEST(YieldWatch, TellsAMotorThatABlowPushesBack) {
  const std::string arm =
      text::read_file((source_dir() / "tests/runtime/tool/search/arms/motor_at_its_end.toml").string());
  for (const double step : {4e-4, 1e-4}) {
    const std::string told = warning_of(arm, "rattle", step);
    EXPECT_EQ(told.find("a motor of unlimited force on joint \"joint1\" goes backwards at 0.3"), 0u)
        << step << ": " << told;
    EXPECT_NE(told.find(" by t = 0.75"), told.npos) << told;
    EXPECT_NE(warning_of(arm, "euler", step).find("goes backwards"), std::string::npos) << step;
    for (const std::string method : {"rk4", "dop853"})
      EXPECT_EQ(warning_of(arm, method, step), "") << method << " " << step;
  }
}

}  // namespace
}  // namespace cdot::test::parted_blows_test
