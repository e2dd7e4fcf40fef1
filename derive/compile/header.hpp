// A compiled scene as the text of a C++ header.
#pragma once

#include <string>

#include "derive/compile/mechanism.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot::compile {

struct Request {
  std::string struct_name;  // empty: after the file
  std::string command;      // that writes the header again
};

std::string header_of(const Mechanism& mechanism, const Request& request, const derive::SpecsFolder& specs);

}  // namespace cdot::compile
