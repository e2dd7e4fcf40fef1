// A spec, read and derived while a program runs: its kernel as tapes. The door by which cdot-run takes joints that
// nobody compiled; this header includes no other of derive/.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/tape/tape.hpp"

namespace cdot {

// A function of the kernel contract (runtime/include/cdot/kernel.hpp).
struct OwnFunction {
  // An argument of the contract as an array of numbers: the members of its structs, body by body.
  // Those of a law are C and its rate, 1/K as `effective_mass`, and the load of a bounded row.
  enum class Argument {
    pose,
    velocity,
    mass,
    parameters,
    jacobian,
    time,
    matrix,
    numbers,
    C,
    rate,
    effective_mass,
    load
  };
  struct Input {
    Argument of;
    int index;
  };
  // The array of an output: the first, or the second, as the numbers of J beside C.
  struct Output {
    bool second;
    int index;
  };
  Tape tape;
  std::vector<Input> inputs;    // of the tape, in its order
  std::vector<Output> outputs;  // likewise; numbers of the arrays that it does not name are 0
  bool exists() const { return !outputs.empty(); }
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

// A parameter <coordinate>_turns of a joint in space: it counts the whole turns of that coordinate.
struct OwnTurns {
  int parameter;  // its place among the numbers of the parameters
  OwnFunction angle;
};

struct OwnBlock {
  std::string name, unit;  // the unit of a coordinate: "rad"
  std::vector<std::string> row_names;
  std::vector<int> row_kinds;  // of cdot::RowKind
  bool explicit_time = false;
  int jacobian_size = 0;
  int immovable = -1;  // of a variant: the body that stands still
  std::array<OwnFunction, own_functions> functions;
  std::vector<OwnTurns> turns;  // those of the joint, in the order of its coordinates

  int rows() const { return static_cast<int>(row_names.size()); }
  const OwnFunction& operator[](OwnFunctionName name) const { return functions[static_cast<std::size_t>(name)]; }
};

struct OwnParameter {
  std::string name, unit;
  int kind, body, offset, size;  // the kind is a cdot::ParameterKind
  bool has_default;
  double above, below;
  bool from, unlimited;
  OwnFunction by_default;  // if it has a default
};

// The law of an effect along its rows (runtime/include/cdot/detail/effect_law.hpp). Some functions may not exist.
struct OwnLaw {
  std::vector<bool> acts;  // by row
  bool in_time = false;
  OwnFunction energy, force, unstored, slopes, limits;
};

// A bounded row of an effect (runtime/include/cdot/detail/bounded_law.hpp). Some functions may not exist.
struct OwnBound {
  std::string name;
  int coordinate;  // its place; 0 for an effect on the coordinate of any joint
  bool of_rate, in_time, of_value;
  int load_of;              // another bounded row; -1: the joint's own rows
  int cone_row, cone_rows;  // its place among rows that share one force, and their number; 0: the row is alone
  OwnFunction bounds, by_load, after, until;
  bool has_events() const { return after.exists() || until.exists(); }
};

// Of an effect that acts on the coordinate of any joint, as cdot::JointType has it.
struct OwnOnCoordinate {
  std::string unit;
  std::vector<int> uses;  // of cdot::CoordinateUse, by parameter
  bool reads_mass, linear, slopes_vanish;
};

struct OwnKernel {
  std::string name, title;
  int dimension = 2;  // 0: an effect without bodies, on the coordinate of any joint
  std::vector<std::string> body_names;
  std::vector<OwnParameter> parameters;
  OwnBlock rows;
  std::vector<OwnBlock> variants;  // of the rows, each with one body immovable
  std::vector<OwnBlock> coordinates;
  bool is_effect = false;
  std::optional<OwnLaw> law;
  std::vector<OwnBound> bounded;
  std::optional<OwnOnCoordinate> on_coordinate;

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
