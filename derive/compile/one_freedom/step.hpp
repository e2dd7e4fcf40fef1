// The step of a mechanism of one freedom as text: symplectic Euler in its few angles, where rounds on K would meet the
// same poses; else on its rows.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/foresight/function_text.hpp"
#include "derive/compile/one_freedom/programs.hpp"

namespace cdot::compile {

std::vector<FunctionText> functions_of_freedom(const FreedomPrograms& freedom);

// Of a step, with one round of Newton; and of a State, beside those of its rows.
long operations_of_freedom(const FreedomPrograms& freedom);
long numbers_of_freedom(const FreedomPrograms& freedom);

// Members of the struct before State, those of State, and lines of begin().
std::string types_of_freedom(const FreedomPrograms& freedom);
std::string state_of_freedom();
inline constexpr const char* begins_freedom = R"(    s.known = T(0);
    for (Excess& numbers : s.past)
      for (T& of_angle : numbers.of) of_angle = T(0);
    find_tangent($ss.q, s.F);
)";
// step(), which calls step_by_rows() where the angles do not do.
std::string step_of_freedom(const FreedomPrograms& freedom, double tolerance);

}  // namespace cdot::compile
