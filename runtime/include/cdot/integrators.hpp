// The integrators, one row each: all properties that other parts need. runtime/step/integrators.cpp has the functions
// that take the steps.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string_view>

namespace cdot {

enum class Integrator { euler, implicit, rattle, rk4, dop853, radau5 };

enum class Level {
  velocity,     // impulses keep J v = -dC/dt
  acceleration  // forces keep J dv/dt = gamma; a step ends at events
};

struct IntegratorRow {
  Integrator integrator;
  std::string_view name;
  int order;
  Level level;
  bool stiffens;          // takes the stiffness from the joints' tension implicitly
  bool projects;          // drift = projection is a part of the method
  bool forces_springs;    // springs on coordinates act as forces; otherwise they are rows of the solver
  bool symmetric;         // a step of -h undoes a step of h
  bool any_solver;        // otherwise the direct one only
  double stable_radians;  // largest h omega at which an oscillation stays bounded
  double stable_decay;    // largest h d at which a motion that decays as exp(-d t) stays bounded
};

inline constexpr double always = std::numeric_limits<double>::infinity();
// stable: symplectic Euler and RATTLE are stable up to 2 exactly. The Runge-Kutta methods are stable up to the point
// where their stability regions cut the imaginary axis, and the negative real one. Radau IIA is stable at every h omega
// and h d. Methods on velocities take dampers implicitly.
// clang-format off
inline constexpr std::array integrator_rows{
    //                                          order, level,                stiffens, projects, springs, symmetric, solver, radians, decay
    // Symplectic Euler: cheap.
    IntegratorRow{Integrator::euler,    "euler",    1, Level::velocity,     false,    false,    false,   false,     true, 2, always},
    // The implicit midpoint rule: light chains under heavy loads and stiff springs stay stable, energy and momentum are
    // kept. With sweeps, or without the projection, linearly implicit Euler.
    IntegratorRow{Integrator::implicit, "implicit", 2, Level::velocity,     true,     false,    false,   false,     true, 2, always},
    // RATTLE keeps C and Cdot to round-off.
    IntegratorRow{Integrator::rattle,   "rattle",   2, Level::velocity,     false,    true,     true,    true,      true, 2, always},
    // Runge-Kutta on accelerations; poses and velocities are projected after each step.
    IntegratorRow{Integrator::rk4,      "rk4",      4, Level::acceleration, false,    false,    true,    false,     true, 2.828, 2.785},
    // Dormand-Prince, likewise.
    IntegratorRow{Integrator::dop853,   "dop853",   8, Level::acceleration, false,    false,    true,    false,     true, 5, 6.2},
    // Radau IIA, likewise; implicit: stiff springs, dampers and tensions do not shorten its steps.
    IntegratorRow{Integrator::radau5,   "radau5",   5, Level::acceleration, false,    false,    true,    false,     false, always, always},
};
// clang-format on

constexpr const IntegratorRow& row_of(Integrator integrator) {
  return integrator_rows[static_cast<std::size_t>(integrator)];
}
static_assert(
    [] {
      for (const IntegratorRow& row : integrator_rows)
        if (&row_of(row.integrator) != &row) return false;
      return true;
    }(),
    "the rows are in the order of the enumerators");

constexpr bool works_on_accelerations(Integrator integrator) { return row_of(integrator).level == Level::acceleration; }

}  // namespace cdot
