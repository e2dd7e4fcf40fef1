// A scalar expression of the time alone -> the program that computes it, for those who write it on as code.
#pragma once

#include <string_view>
#include <vector>

#include "derive/interpret/formula.hpp"
#include "derive/program/program.hpp"

namespace cdot {

struct ProgramInTime {
  derive::Program program;               // time, pi -> value, rate, acceleration
  std::vector<FormulaMistake> mistakes;  // if there are any, there is no program
};
// `unit` is the one that the value must have.
ProgramInTime program_in_time(std::string_view text, std::string_view unit);

}  // namespace cdot
