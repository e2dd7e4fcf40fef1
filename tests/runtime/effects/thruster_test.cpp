// A thruster turns with its body: the path of a body that spins while it is pushed, in closed form.
#include <cmath>
#include <fmt/format.h>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// With a spin w, a = F/m (cos wt, sin wt), so x = F/(m w^2) (1 - cos wt, wt - sin wt).
template <class S, class Body>
double error_of_spiral(Integrator integrator, double h, Body spinning, std::vector<double> at, std::vector<double> n) {
  constexpr double w = 3, m = 2, F = 5;
  Settings s = settings(Solver::direct, Drift::projection, 0);
  s.integrator = integrator;
  BasicWorld<S> world(s);
  const int rocket = world.add_body(spinning(m, w));
  world.add_joint({"thruster", {rocket}, {{"pa", at}, {"n", n}, {"F", {F}}}, {}});
  for (int k = 0; k < std::lround(1 / h); ++k) EXPECT_TRUE(world.step(h));
  const double unit = F / (m * w * w);
  return std::hypot(world.place(rocket).x - unit * (1 - std::cos(w)), world.place(rocket).y - unit * (w - std::sin(w)));
}

double error_in_plane(Integrator integrator, double h) {
  const auto body = [](double m, double w) {
    BodyDefinition d;
    d.mass = m, d.inertia = 1, d.w = w;
    return d;
  };
  return error_of_spiral<Planar<double>>(integrator, h, body, {-0.4, 0}, {2, 0});
}

double error_in_space(Integrator integrator, double h) {
  const auto body = [](double m, double w) {
    SpatialBodyDefinition d;
    d.mass = m, d.inertia = {1, 2, 3}, d.wz = w;
    return d;
  };
  return error_of_spiral<Spatial<double>>(integrator, h, body, {-0.4, 0, 0}, {2, 0, 0});
}

double order_of_thrust(Integrator integrator) {
  return integrator == Integrator::rk4 ? 4 : integrator == Integrator::dop853 ? 8 : 1;
}

TEST(Thruster, DrivesASpinningBodyAlongASpiral) {
  for (const auto& [name, integrator] : integrators) {
    for (const auto& error_of : {error_in_plane, error_in_space}) {
      const double coarse = error_of(integrator, 0.05), fine = error_of(integrator, 0.025);
      fmt::print("  {}: {:.1e} m at 0.05 s, {:.1e} at 0.025 s\n", name, coarse, fine);
      EXPECT_LT(coarse, 0.1) << name;
      EXPECT_TRUE(fine < 1e-12 || coarse / fine > 0.8 * std::pow(2, order_of_thrust(integrator))) << name;
    }
  }
}

}  // namespace
}  // namespace cdot::test
