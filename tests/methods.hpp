// The methods of a World, for tests that go through all of them, and what order they are of.
#pragma once

#include <fmt/format.h>
#include <string>

#include <cdot/methods.hpp>

namespace cdot::test {

constexpr double order_of(Integrator integrator) { return row_of(integrator).order; }

// f(settings, name) for every solver, drift correction and integrator, with fixed steps and with steps of their own,
// that go together (setup_test.cpp says which are refused, and how); the rest as in `base`. Returns how many these are.
template <class F>
int for_each_method(const Settings& base, F f) {
  int methods = 0;
  for (const auto& [solver_name, solver] : solvers)
    for (const auto& [drift_name, drift] : drifts)
      for (const auto& [name, integrator] : integrators)
        for (const double local_error : {0.0, 1e-5}) {
          Settings s = base;
          s.solver = solver;
          s.drift = drift;
          s.integrator = integrator;
          s.local_error = local_error;
          if (wrong_with_methods(s)) continue;
          f(s, fmt::format("{} {} {} {}", solver_name, drift_name, name, local_error));
          ++methods;
        }
  return methods;
}

}  // namespace cdot::test
