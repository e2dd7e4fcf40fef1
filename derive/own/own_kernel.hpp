// A spec, read and derived while a program runs: its kernel as tapes. The door by which cdot-run takes joints that
// nobody compiled; this header includes no other of derive/.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "runtime/tape/tape.hpp"

namespace cdot {

// A function of the kernel contract (runtime/include/cdot/kernel.hpp).
struct OwnFunction {
  // An argument of the contract as an array of numbers: the members of its structs, body by body.
  enum class Argument { pose, velocity, mass, parameters, jacobian, time, matrix, numbers };
  struct Input {
    Argument of;
    int index;
  };
  // The array of an output: the first, or the numbers of J beside C.
  struct Output {
    bool jacobian;
    int index;
  };
  Tape tape;
  std::vector<Input> inputs;    // of the tape, in its order
  std::vector<Output> outputs;  // likewise; numbers of the arrays that it does not name are 0
};

// The functions of a row block, in this order.
enum class OwnFunctionName {
  position,
  jacobian,
  effective_mass,
  factor,
  solve,
  velocity,
  apply,
  dense,
  inverse_mass_jacobian,
  gamma,
  time_derivative,
  stiffness
};
inline constexpr int own_functions = 12;

struct OwnBlock {
  std::string name, unit;  // the unit of a coordinate: "rad"
  std::vector<std::string> row_names;
  std::vector<int> row_kinds;  // of cdot::RowKind
  bool explicit_time = false;
  int jacobian_size = 0;
  int immovable = -1;  // of a variant: the body that stands still
  std::array<OwnFunction, own_functions> functions;

  int rows() const { return static_cast<int>(row_names.size()); }
  const OwnFunction& operator[](OwnFunctionName name) const { return functions[static_cast<std::size_t>(name)]; }
};

struct OwnParameter {
  std::string name, unit;
  int kind, body, offset, size;  // the kind is a cdot::ParameterKind
  bool has_default;
  double above, below;
  bool from;
  OwnFunction by_default;  // if it has a default
};

struct OwnKernel {
  std::string name, title;
  int dimension = 2;
  std::vector<std::string> body_names;
  std::vector<OwnParameter> parameters;
  OwnBlock rows;
  std::vector<OwnBlock> variants;  // of the rows, each with one body immovable
  std::vector<OwnBlock> coordinates;

  int bodies() const { return static_cast<int>(body_names.size()); }
  int parameter_size() const { return parameters.empty() ? 0 : parameters.back().offset + parameters.back().size; }
};

// A kernel, or why there is none; `problems` also has warnings, each with its line and the likely fix.
struct OwnReading {
  std::shared_ptr<const OwnKernel> kernel;
  std::string problems;
};

// Includes are found beside the file and in the specs folder of the current directory or of the installation.
OwnReading read_own_kernel(const std::string& file);

}  // namespace cdot
