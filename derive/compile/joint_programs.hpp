// The kernels of the joints of a scene as programs, by the pipeline that writes generated/.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "derive/language/specs_folder.hpp"
#include "derive/program/program.hpp"

namespace cdot::compile {

struct JointPrograms {
  std::vector<std::string> bodies;      // "a", "b", ...
  std::vector<std::string> parameters;  // what the programs read, in the order of Parameters<T>: "p.pa_x", "phi"
  std::vector<std::string> row_names;
  std::vector<std::string> fields;                   // of Jacobian<T>
  bool has_rates = false;                            // dC/dt at fixed q is not 0
  std::map<std::string, derive::Program> functions;  // by the names of the kernel contract

  const derive::Program& function(const std::string& name) const { return functions.at(name); }
  std::size_t rows() const { return row_names.size(); }
};

JointPrograms programs_of(const derive::SpecsFolder& specs, const std::string& joint);

}  // namespace cdot::compile
