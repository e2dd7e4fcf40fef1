// A rod on a spring so stiff that methods for stiff mechanisms are tried first. Equal steps that are longer than its
// oscillation damp that, and agree on its mean.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cdot/methods.hpp>

#include "runtime/tool/run/trajectory.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::oscillations_test {
namespace {

struct Case {
  const char *top, *start, *spring;
  long long most;  // evaluations of the search and the run
};

Scene rod(const Case& c, const char* method) {
  return read_scene(fmt::format(R"({}
{}
[[body]]
name = "rod"
mass = 1
shape = {{ rod = 1 }}
position = [0.5, 0]
{}
[[joint]]
type = "revolute"
bodies = ["world", "rod"]
at = [0, 0]
{}
)",
                                method, c.top, c.start, c.spring),
                    "rod");
}

// Let go with its weight, and kicked: it swings by 0.02 rad and by 6e-4 rad. Stiffer springs move by 1e-6 rad, and
// equal steps are good enough.
TEST(Claims, HoldForOscillationsThatEqualStepsDamp) {
  for (const Case& c : {Case{"duration = 100", "", "angle.spring = { frequency = 8, damping_ratio = 0 }", 1000000},
                        {"duration = 20\ngravity = [0, 0]", "spin = 1\nvelocity = [0, 0.5]",
                         "[[joint]]\ntype = \"torsion_spring\"\nbodies = [\"world\", \"rod\"]\nk = 1e6", 1000000},
                        {"duration = 10\ngravity = [0, 0]", "spin = 1\nvelocity = [0, 0.5]",
                         "angle.spring = { stiffness = 1e6, damping = 0 }", 1000000},
                        {"duration = 10", "", "angle.spring = { stiffness = 1e7, damping = 0 }", 2000}}) {
    const Scene scene = rod(c, "");
    const auto [result, rows] = recorded(scene, 0.093);
    const std::vector<Frame> fine =
        run_of(rod(c, "integrator = \"dop853\"\nlocal_error = 1e-10"), scene.duration, 0.093);
    const Choice& choice = result.choice.value();
    double off = 0;
    ASSERT_EQ(rows.size(), fine.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      off = std::max(off, std::abs(rows[k].bodies[0].angle - fine[k].bodies[0].angle));
    fmt::print("  {}: {}, {} evaluations and {} before, {:.1e} claimed, off by {:.1e}\n", c.spring,
               name_of(integrators, choice.integrator), choice.evaluations, choice.evaluations_before, choice.achieved,
               off);
    EXPECT_TRUE(choice.reached) << c.spring;
    EXPECT_LE(off, choice.achieved) << c.spring;
    EXPECT_LE(choice.evaluations + choice.evaluations_before, c.most) << c.spring;
  }
}

}  // namespace
}  // namespace cdot::test::oscillations_test
