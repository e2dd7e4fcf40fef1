// All methods of a World with their orders, for tests that run every method.
#pragma once

#include <fmt/format.h>
#include <string>

#include <cdot/methods.hpp>

namespace cdot::test {

constexpr double order_of(Integrator integrator) { return row_of(integrator).order; }

// f(settings, name) for every allowed combination of solver, drift correction and integrator, with fixed and with
// adaptive steps; other settings are those of `base`. Returns the number of combinations. setup_test.cpp tests the
// refused ones.
template <class F>
int for_each_method(const Settings& base, F f) {
  int methods = 0;
  for (const auto& [solver_name, solver, sweeps] : solvers)
    for (const auto& [drift_name, drift] : drifts)
      for (const auto& [name, integrator] : integrators)
        for (const double local_error : {0.0, 1e-5}) {
          Settings s = base;
          s.solver = solver;
          s.drift = drift;
          s.integrator = integrator;
          s.local_error = local_error;
          if (mistake_in_methods(s)) continue;
          f(s, fmt::format("{} {} {} {}", solver_name, drift_name, name, local_error));
          ++methods;
        }
  return methods;
}

}  // namespace cdot::test
