// A function of the header, to be written.
#pragma once

#include <string>

#include "derive/program/program.hpp"

namespace cdot::compile {

struct FunctionText {
  std::string comment, head;
  const derive::Program* program;
};

}  // namespace cdot::compile
