// Every integrator on every problem with a known solution: the error falls with the step as the method's order says,
// rotations in space included, until it meets the reference's own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/methods.hpp"
#include "tests/scenes/support.hpp"

namespace cdot::test {
namespace {

struct Problem {
  const char* scene;
  double until;   // [s]
  double step;    // the coarsest [s] of RATTLE
  double coarse4, coarse8;  // of rk4 and dop853
};

struct Case {
  Problem problem;
  Integrator integrator;
  double step;
  double least_slope;
};

std::string name_of_case(const testing::TestParamInfo<Case>& info) {
  return fmt::format("{}_{}", info.param.problem.scene, name_of(integrators, info.param.integrator));
}

std::vector<Case> all_cases() {
  const Problem problems[] = {
      {"simple_pendulum", 10, 0.01, 0.05, 0.25},  {"compound_pendulum", 10, 0.01, 0.05, 0.25},
      {"double_pendulum", 2, 0.01, 0.02, 0.125},  {"four_bar", 0.5, 0.01, 0.02, 0.1},
      {"slider_crank", 0.2, 1e-4, 4e-4, 2e-3},
  };
  std::vector<Case> cases;
  for (const Problem& problem : problems) {
    cases.push_back({problem, Integrator::rattle, problem.step, 1.9});
    cases.push_back({problem, Integrator::rk4, problem.coarse4, 3.8});
    cases.push_back({problem, Integrator::dop853, problem.coarse8, 7});
  }
  return cases;
}

class Orders : public testing::TestWithParam<Case> {};

// The slope is taken where the error is small enough to follow the order and stands well above the reference's own.
TEST_P(Orders, AreThoseOfTheMethod) {
  const auto& [problem, integrator, coarsest, least_slope] = GetParam();
  Scene scene = scene_named(problem.scene);
  scene.settings.integrator = integrator;
  const Reference reference = read_reference(problem.scene, problem.until);
  double before = 0, best = 0;
  for (int halvings = 0; halvings < 5; ++halvings) {
    scene.step = coarsest / (1 << halvings);
    const double now = distance_to(reference, scene).largest();
    const double slope = halvings > 0 ? std::log2(before / now) : 0;
    fmt::print("  h = {:.4e}  off by {:.3e} m or rad  slope {:.2f}\n", scene.step, now, slope);
    if (now > 20 * reference.accuracy) best = std::max(best, slope);
    before = now;
  }
  EXPECT_GT(best, least_slope);
}

INSTANTIATE_TEST_SUITE_P(Problems, Orders, testing::ValuesIn(all_cases()), name_of_case);

}  // namespace
}  // namespace cdot::test
