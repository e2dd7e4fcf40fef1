// A compiled scene as the text of a C++ header.
#pragma once

#include <string>

#include "derive/compile/scene/mechanism.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot::compile {

struct Request {
  std::string struct_name;  // empty: after the file
  std::string command;      // that writes the header again
};

struct Header {
  std::string text, struct_name;
  long operations = 0;   // of the equations in a step with one round of Newton
  long state_bytes = 0;  // of a State in double
};

Header header_of(const Mechanism& mechanism, const Request& request, const derive::SpecsFolder& specs);

}  // namespace cdot::compile
