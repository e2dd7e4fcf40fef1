// step() of the explicit Runge-Kutta methods as text, and what other methods on accelerations share with them.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

int stages_of(Method method);

// few: the numbers of a slope are lines each.
std::string runge_kutta(Method method, const Contents& has, bool few);

// Of the arguments of slope(): those between the velocities and the result.
std::string arguments_of_slope(const Contents& has);
// From moved poses and velocities to the end of the step: C = 0, J v = -dC/dt, accelerations. `at`: where J was
// evaluated last.
std::string end_on_accelerations(const Contents& has);
// The head of the step: that of a stride between events, of a mechanism with modes.
std::string head_on_accelerations(const Contents& has);

}  // namespace cdot::compile
