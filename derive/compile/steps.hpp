// begin() and step() of each method as text.
#pragma once

#include <string>

#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// How often step() calls each function, with one round of Newton.
struct Calls {
  int evaluate = 0, errors = 0, rates = 0, gamma = 0, solve = 0, fall = 0, kick = 0;
};
Calls calls_of(Method method, bool has_effects, bool driven);

std::string begin_of(Method method, bool has_rows);
std::string step_of(Method method, bool has_rows, bool has_effects);

}  // namespace cdot::compile
