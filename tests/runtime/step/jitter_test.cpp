// Sweeps leave errors in impulses and poses. In steps of varying lengths they do not grow with the steps.
#include <cmath>

#include <cdot/balance.hpp>
#include <cdot/methods.hpp>

#include "tests/runtime/support.hpp"

namespace cdot::test {
namespace {

// Of step k: between a tenth and two 240ths of a second, in no order.
double length_of(int k) { return std::sqrt(0.2) * std::pow(20, 0.5 * std::sin(12.9898 * k * k)) / 240; }

TEST(Jitter, ByFewSweepsNoMethodGainsEnergy) {
  for (Integrator integrator : {Integrator::euler, Integrator::implicit, Integrator::rattle})
    for (int iterations : {1, 4, 10}) {
      Settings s = settings(Solver::iterative, Drift::projection, -10);
      s.integrator = integrator, s.iterations = iterations;
      World<double> world(s);
      add_chain(world, 10, 0);
      BalanceWatch seen;
      for (int k = 0; k < 1500; ++k) {
        ASSERT_TRUE(world.step(length_of(k)));
        seen.look(world.balance());
      }
      EXPECT_LT(seen.risen.share(), 0.05) << name_of(integrators, integrator) << ", " << iterations << " sweeps";
    }
}

}  // namespace
}  // namespace cdot::test
