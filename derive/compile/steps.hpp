// begin() and step() of each method as text.
#pragma once

#include <string>

#include "derive/compile/corrections.hpp"
#include "derive/compile/equations.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

Contents contents_of(const Mechanism& mechanism, const Equations& equations);

// How often step() calls each function, with one round of Newton and no end passed.
struct Calls {
  int evaluate = 0, errors = 0, rates = 0, accelerate = 0, solve = 0, fall = 0, kick = 0, past = 0;
  int distances = 0, guard = 0, reach = 0;
  int dampen = 0, notice = 0, look = 0, finish = 0;  // by RATTLE and the midpoint rule
  int improve = 0;                                   // by the midpoint rule
  long newton = 0;                                   // by Radau IIA: operations of its linear systems
};
Calls calls_of(Method method, const Contents& has);
// Operations of a step.
long operations_of(const Equations& equations, const Calls& calls);
// Of a State of double.
long state_bytes_of(const Mechanism& mechanism, const Equations& equations, const Contents& has);

// approach(), for ends that wait for events; late: "true, false", by row.
std::string approach_of(const Mechanism& mechanism, const std::string& late, const Contents& has);
std::string begin_of(Method method, const Contents& has);
std::string step_of(const Mechanism& mechanism, const Contents& has);

// The step of a mechanism of one freedom on its rows, as step_by_rows().
std::string by_rows(std::string step);

}  // namespace cdot::compile
