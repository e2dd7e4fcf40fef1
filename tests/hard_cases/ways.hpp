// The ways to run a scene, solver x integrator x precision, and sets of them; and the way that the runtime chooses.
#pragma once

#include <string>
#include <vector>

#include <cdot/settings.hpp>

namespace cdot::hard {

struct Way {
  Solver solver;
  Integrator integrator;
  bool single;          // in float
  bool chosen = false;  // by the runtime, in place of solver and integrator
  bool operator==(const Way&) const = default;
};

std::string name_of(const Way& way);  // "direct rattle float"
inline constexpr Way by_default{Solver::direct, Integrator::euler, false, true};

using Ways = std::vector<Way>;

Ways all_ways();
Ways direct();  // any integrator
Ways iterative();
// All integrators but these, of the same solvers.
Ways without(Ways ways, std::initializer_list<Integrator> integrators);
Ways only(Ways ways, std::initializer_list<Integrator> integrators);
Ways in_double(Ways ways);
Ways operator+(Ways ways, const Ways& more);

// "direct: all; iterative: euler, rattle (double)"
std::string text_of(const Ways& ways);

}  // namespace cdot::hard
