// Joints that hold by less than the error of their load.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "runtime/text/files.hpp"
#include "tests/runtime/tool/followed_advice.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::near_break_test {
namespace {

// A rod of 1 kg and 1 m falls from level about its end. There w^2 = 3 g / l at the lowest point, and the pin carries
// m g + m w^2 l / 2 = 2.5 m g = 24.525 N.
Ran rod_on_a_pin(const TemporaryFolder& folder, double strength, const std::string& options) {
  const std::string file = (folder / "rod.toml").string();
  text::write_file(file, fmt::format("duration = 1\nstep = 0.01\n[[body]]\nname = \"rod\"\nmass = 1\n"
                                     "shape = {{ rod = 1 }}\nposition = [0.5, 0]\n[[joint]]\nname = \"pin\"\n"
                                     "type = \"revolute\"\nbodies = [\"world\", \"rod\"]\nat = [0, 0]\n"
                                     "breaking = {}\n",
                                     strength));
  return simulated(file, options);
}

constexpr double most = 2.5 * 9.81;  // [N]

TEST(NearBreak, IsToldWhereTheErrorOfTheLoadDecides) {
  const TemporaryFolder folder;
  const auto told = [&](double strength, const std::string& options) {
    return std::string(rod_on_a_pin(folder, strength, options).summary["decision_warning"]);
  };
  for (const std::string steps : {"--integrator rattle", "--integrator implicit", "--integrator rk4"}) {
    const std::string warning = told(1.0005 * most, steps);
    EXPECT_EQ(warning.find("joint \"pin\" is within 0."), 0u) << steps << ": " << warning;
    EXPECT_EQ(told(1.1 * most, steps), "") << steps;
  }
  EXPECT_NE(told(1.0005 * most, "--integrator dop853 --local-error 1e-6"), "");
  EXPECT_EQ(told(1.0005 * most, "--integrator dop853 --local-error 1e-9"), "");
}

// As a share of the strength: 1 - 1 / 1.005, and less than 0.02 % that the load of the last step lacks to the largest.
TEST(NearBreak, TellsHowFarTheLoadIsFromTheStrength) {
  const TemporaryFolder folder;
  const Ran ran = rod_on_a_pin(folder, 1.005 * most, "--integrator dop853 --local-error 1e-6");
  const std::string warning = ran.summary["decision_warning"];
  const std::string within = "is within ";
  ASSERT_NE(warning.find(within), warning.npos) << warning;
  const double percent = std::stod(warning.substr(warning.find(within) + within.size()));
  EXPECT_NEAR(percent, 100 * (1 - 1 / 1.005), 0.02) << warning;
}

TEST(NearBreak, IsNotToldOfWhatBreaks) {
  const TemporaryFolder folder;
  const Ran ran = rod_on_a_pin(folder, 0.99 * most, "--integrator rattle");
  EXPECT_EQ(ran.summary["decision_warning"], "");
  EXPECT_EQ(ran.summary["broken_joints"].size(), 1u);
}

TEST(NearBreak, ComesWithAFixThatWasTried) {
  const TemporaryFolder folder;
  const Ran ran = rod_on_a_pin(folder, 1.0005 * most, "--integrator rattle");
  const std::string options = ran.summary["advice"]["options"];
  EXPECT_TRUE(rod_on_a_pin(folder, 1.0005 * most, "--integrator rattle " + options).silent()) << options;
}

// dop853 and rk4 follow the loads up to 0.001 rad before such a pose; of equal steps some break the pin, others do not.
TEST(NearBreak, TellsAPinThatBreaksWhereLoadsHaveNoBound) {
  const std::string cranks = (source_dir() / "tests/runtime/tool/watch/flat_cranks.toml").string();
  for (const auto& [steps, time] : {std::pair<std::string, std::string>{"0.00009 --integrator rattle", "1.03041"},
                                    {"0.0001 --integrator implicit", "1.0304"},
                                    {"0.0001 --integrator euler", "1.0304"}}) {
    const std::string warning = simulated(cranks, "--step " + steps).summary["decision_warning"];
    const std::string told = "joint \"r1\" breaks by t = " + time + " s, where row 1 of \"q2\" nearly loses rank";
    EXPECT_EQ(warning.find(told), 0u) << steps << ": " << warning;
  }
  EXPECT_EQ(simulated(cranks, "--step 0.001 --integrator rattle").summary["decision_warning"], "");
  EXPECT_EQ(simulated(cranks, "--integrator dop853 --local-error 1e-9").summary["decision_warning"], "");
}

// RK4 locates the break, but its equal steps still decide how near to the pose they look.
TEST(NearBreak, TellsAPinThatBreaksByEqualStepsOfRk4) {
  const std::string linkage = (source_dir() / "tests/runtime/tool/watch/past_a_flat_pose.toml").string();
  const std::string warning = simulated(linkage, "--integrator rk4 --step 0.0005").summary["decision_warning"];
  EXPECT_EQ(warning.find("joint \"foot1\" breaks by t = 0.89"), 0u) << warning;
  EXPECT_EQ(simulated(linkage, "--integrator rk4 --step 0.0001").summary["decision_warning"], "");
  EXPECT_EQ(simulated(linkage, "").summary["decision_warning"], "");
}

}  // namespace
}  // namespace cdot::test::near_break_test
