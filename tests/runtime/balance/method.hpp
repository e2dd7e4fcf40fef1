// Every integrator with every solver that it allows, with fixed and with adaptive steps.
#pragma once

#include <string>
#include <vector>

#include <cdot/methods.hpp>
#include <cdot/settings.hpp>

namespace cdot::test {

struct Method {
  Integrator integrator;
  Solver solver;
  double local_error = 0;
  std::string name() const {
    return std::string(name_of(integrators, integrator)) + " " + std::string(name_of(solvers, solver)) +
           (local_error > 0 ? " adaptive" : "");
  }
  Settings settings(double gravity_y = 0) const {
    Settings s;
    s.integrator = integrator, s.solver = solver, s.local_error = local_error;
    s.gravity_y = gravity_y;
    s.iterations = 60;
    return s;
  }
  // With sweeps, `implicit` takes steps of Euler's.
  int order() const { return row_of(integrator).stiffens && sweeps(solver) ? 1 : row_of(integrator).order; }
};

inline std::vector<Method> methods() {
  std::vector<Method> all;
  for (const IntegratorRow& row : integrator_rows)
    for (Solver solver : {Solver::direct, Solver::iterative}) {
      if (!row.any_solver && sweeps(solver)) continue;
      all.push_back({row.integrator, solver});
      if (row.level == Level::acceleration) all.push_back({row.integrator, solver, 1e-8});
    }
  return all;
}

}  // namespace cdot::test
