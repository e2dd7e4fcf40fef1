// A rhombus of four bars that falls through its flat pose: at exact places it goes straight on, as a parallelogram.
// Where its places are rounded, steps of equal length may turn there into the other branch, and the run tells.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/methods.hpp>

#include "runtime/text/files.hpp"
#include "runtime/tool/run/error_report.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::turn_watch_test {
namespace {

// Cranks of 1 m from (0, 0) and (1, 0) at this angle, and a coupler of 1 m, by places of so many digits.
std::string rhombus(double angle, int digits) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto at = [&](double x, double y) { return fmt::format("[{:.{}g}, {:.{}g}]", x, digits, y, digits); };
  std::string text = "gravity = [0, -9.81]\nduration = 1\n";
  const auto add_bar = [&](const char* name, double x, double y, double turn) {
    text += fmt::format("[[body]]\nname = \"{}\"\nmass = 1\nshape = {{ rod = 1 }}\nposition = {}\nangle = {:.{}g}\n",
                        name, at(x, y), turn, digits);
  };
  add_bar("left", c / 2, s / 2, angle), add_bar("right", 1 + c / 2, s / 2, angle), add_bar("coupler", c + 0.5, s, 0);
  const auto add_pin = [&](const char* a, const char* b, double x, double y) {
    text += fmt::format("[[joint]]\ntype = \"revolute\"\nbodies = [\"{}\", \"{}\"]\nat = {}\n", a, b, at(x, y));
  };
  add_pin("world", "left", 0, 0), add_pin("world", "right", 1, 0);
  add_pin("left", "coupler", c, s), add_pin("coupler", "right", 1 + c, s);
  return text;
}

struct Fall {
  double off;  // of the cranks from each other at the end [rad]
  std::string warning;
};
Fall fall(double angle, int digits, Integrator integrator, double step) {
  const TemporaryFolder folder;
  const std::string file = (folder / "rhombus.toml").string();
  text::write_file(file, rhombus(angle, digits));
  Scene scene = read_scene(file);
  scene.settings.integrator = integrator, scene.settings.local_error = 0, scene.step = step;
  const auto [result, rows] = recorded(scene, scene.duration);
  const auto& bodies = rows.back().bodies;
  return {std::abs(bodies[0].angle - bodies[1].angle), decision_warning(scene, result)};
}

TEST(TurnWatch, TellsOfStepsThatLeaveTheirBranch) {
  int left = 0;
  for (const double angle : {0.7, 1.1, 1.5, 1.9, 2.3})
    for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5})
      for (const double step : {1e-4, 5e-4, 2e-3}) {
        const auto [off, warning] = fall(angle, 10, integrator, step);
        if (off < 1e-3) continue;
        ++left;
        EXPECT_EQ(warning.find("within one step "), 0u)
            << angle << " " << name_of(integrators, integrator) << " " << step;
        EXPECT_NE(warning.find(" nearly loses rank. Two branches of the motion cross in that pose"), warning.npos);
      }
  fmt::print("  {} of 45 runs leave their branch, all told\n", left);
  EXPECT_GT(left, 4);
}

TEST(TurnWatch, IsSilentWhereStepsGoStraightOn) {
  for (const double angle : {0.7, 1.5, 2.3})
    for (const Integrator integrator : {Integrator::rk4, Integrator::dop853, Integrator::radau5})
      for (const double step : {1e-4, 5e-4, 2e-3, 1e-2}) {
        const auto [off, warning] = fall(angle, 17, integrator, step);
        EXPECT_LT(off, 1e-3) << angle << " " << name_of(integrators, integrator) << " " << step;
        EXPECT_EQ(warning, "") << angle << " " << name_of(integrators, integrator) << " " << step;
      }
}

}  // namespace
}  // namespace cdot::test::turn_watch_test
