// A grip whose bound follows a load lets go and holds again between the ends of a step, or the other way round.
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/runtime/tool/support.hpp"

namespace cdot::test::grips_test {
namespace {

constexpr double gravity = 9.81, mu = 0.2, radius = 0.5, torque_of_slip = 0.25;  // m r / 2, for a solid disc of 1 kg

// The disc on level ground to its right, by one step of a second. Its torque is m r (3 mu g + e(t))/2, so that its slip
// s changes by e(t) while it slips ahead, and it goes by mu g; while it rolls it goes by mu g + e/3.
struct Disc {
  double x;
  StepCounts counts;
};
Disc run(const std::string& ground, const std::string& e, double slip, Integrator integrator, double local_error) {
  Scene scene =
      read_scene(fmt::format(R"toml(duration = 1
step = 1
gravity = [0, -{}]
[[body]]
name = "disc"
mass = 1
shape = {{ disc = {} }}
position = [0, {}]
spin = {}
[[joint]]
type = "couple"
bodies = ["disc"]
M = "-{} [N*m] * ({} + {})"
[[joint]]
bodies = ["disc", "world"]
mu = {}
{}
)toml",
                             gravity, radius, radius, -slip / radius, torque_of_slip, 3 * mu * gravity, e, mu, ground),
                 "disc.toml");
  scene.settings.integrator = integrator, scene.settings.local_error = local_error;
  const auto [result, rows] = recorded(scene, 1);
  EXPECT_FALSE(result.failed_step);
  return {rows.back().bodies[0].x, result.counts};
}

constexpr std::pair<Integrator, double> methods[] = {
    {Integrator::dop853, 1e-2}, {Integrator::dop853, 1e-6}, {Integrator::radau5, 1e-6}};

// e = k (t - 0.4)(0.6 - t): it rolls, slips from 0.4 s on, and rolls again from 0.7 s on. Meanwhile it misses the way
// that rolling would have gone, a third of the integral of s.
TEST(Grips, ThatSlipForAWhileAreSeen) {
  constexpr double k = 40, d = 0.2, tau = 0.3;
  const double rolled = mu * gravity / 2 - k * 0.11 / 9;  // the last term is the integral of (1 - t) e / 3
  const double exact = rolled - k / 3 * (d * tau * tau * tau / 6 - tau * tau * tau * tau / 12);
  for (const auto& [integrator, local_error] : methods) {
    const Disc now = run("type = \"rough_line\"\npa = [0, 0]\npb = [0, 0]\nn = [0, 1]\nradius = 0.5",
                         fmt::format("{}*(time / 1 [s] - 0.4)*(0.6 - time / 1 [s])", k), 0, integrator, local_error);
    const std::string name = fmt::format("{} at {:.0e}", row_of(integrator).name, local_error);
    fmt::print("  {}: {:.6f} m, {:.1e} off, {} events\n", name, now.x, now.x - exact, now.counts.events);
    EXPECT_NEAR(now.x, exact, 1e-6) << name;
  }
}

// e = 2 t - 1: it slips at 0.24 m/s, holds from 0.4 s to 0.5 s, and slips on. In a ring its slip has no place.
TEST(Grips, ThatHoldForAWhileAreSeenWithoutAPlace) {
  const double exact = mu * gravity / 2 - 0.017 / 9;  // the integral of (1 - t) e / 3 while it holds
  for (const auto& [integrator, local_error] : methods) {
    const Disc now = run("type = \"disc_in_ring\"\npa = [0, 0]\npb = [0, 1e5]\nradius_a = 0.5", "2*time / 1 [s] - 1",
                         0.24, integrator, local_error);
    const std::string name = fmt::format("{} at {:.0e}", row_of(integrator).name, local_error);
    fmt::print("  {}: {:.6f} m, {:.1e} off, {} events in {} steps\n", name, now.x, now.x - exact, now.counts.events,
               now.counts.taken + now.counts.rejected);
    EXPECT_NEAR(now.x, exact, 1e-4) << name;
    EXPECT_LT(now.counts.taken + now.counts.rejected, 40) << name;
  }
}

}  // namespace
}  // namespace cdot::test::grips_test
