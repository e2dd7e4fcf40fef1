// A program as lines of C++: one named quantity a line, in the letters of the spec.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "derive/program/program.hpp"

namespace cdot::derive {

struct Printing {
  std::map<std::string, std::string> inputs;  // how an input is read: "x_a_x" -> "a.x"; others stand for themselves
  std::set<std::string> reserved;             // names that a local must not take
  std::string indent;
  bool zeroed = false;  // the outputs are zero beforehand: those that stay so are not assigned
};

// The statements that compute the program and assign its outputs.
std::vector<std::string> print_statements(const Program& program, const Printing& printing);

// The texts of the inputs that the program reads, as printed.
std::set<std::string> inputs_read(const Program& program, const Printing& printing);

// Breaks a line before column 100 at the outermost operator that fits, in prose at the last space. The rest is indented
// by four more.
enum class Break { at_operators, at_spaces };
std::vector<std::string> wrapped(std::string line, Break where = Break::at_operators);

}  // namespace cdot::derive
