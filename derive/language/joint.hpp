// A joint as the reader returns it: names, parameters, constraint rows as expressions, with all units checked.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "derive/expression/expr.hpp"
#include "derive/expression/unit.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {

// The forms of velocity that J may be written in (derivation/forms.hpp).
enum class Form { global, local, euler };
constexpr std::array<std::string_view, 3> form_names = {"global", "local", "euler"};
inline std::string_view name_of(Form form) { return form_names[static_cast<std::size_t>(form)]; }
inline Form form_named(std::string_view name) {  // `global` if there is none of that name
  const auto found = std::find(form_names.begin(), form_names.end(), name);
  return found == form_names.end() ? Form::global : static_cast<Form>(found - form_names.begin());
}

enum class ParameterKind { point, vector, unit, frame, scalar };

struct Parameter {
  std::string name;
  ParameterKind kind = ParameterKind::scalar;
  int body = -1;  // the body it is fixed in; -1: the world, or a scalar
  Unit unit;
  Expr value;   // as it occurs in expressions: point: its place in the world (x_a + ra); frame: its x axis
  Expr symbol;  // the leaf behind it: the arm `ra`, the direction `t`, the number; what a kernel reads or rotates
  std::vector<Expr> axes;                                   // of a frame in space: its three leaves, `symbol` first
  double above = -std::numeric_limits<double>::infinity();  // a scalar lies between these
  double below = std::numeric_limits<double>::infinity();
  bool from = false;               // `above` itself too
  std::string range;               // "between 0 and pi", as written; empty: any number
  Expr default_value;              // may be empty; of the kind of `value`
  std::vector<Expr> default_axes;  // of a frame in space
  Span where;
};

struct Let {
  std::string name;
  Expr value;
  Unit unit;
  Span where;
};

enum class RowKind { equality, inequality, velocity };

// One statement `lhs = rhs`. A vector equation counts as one Row with `rows` components here; C, J and K number them
// one by one.
struct Row {
  std::string name;  // given by the author, else C1, C2, ... (of the first component: C1_x, C1_y in a vector row)
  RowKind kind = RowKind::equality;
  Expr C;  // lhs - rhs for equality, rhs - lhs for <=, lhs - rhs for >=; velocity rows: the velocity expression
  Unit unit;
  Span where;
  std::string text;       // as written, for people
  std::string from;       // the included joint that it came from; empty if written here
  Expr kept;              // with `keep`: the cross product that it is a component of
  bool of_world = false;  // it names a quantity of the world, which takes any impulse: it need not conserve momentum
};

struct Coordinate {
  std::string name;
  Expr value;
  Unit unit;
  Span where;
  std::string text;
  std::string from;                         // the included joint that it came from; empty if written here
  std::vector<std::string> constrained_by;  // rows that constrain it (derivation/free_coordinates.hpp)
  bool of_world = false;                    // as of a row
  bool by_rate = false;                     // of an effect: `value` is its rate, and it has no value
};

// A scalar or vector that the law of an effect reads, and its rate. Its row has the same place in Joint::rows.
struct LawInput {
  std::string name;  // of the row
  Expr value, rate;  // leaves; no value: of a torque in space, where a turn is no vector
  Unit unit;
  Expr force;             // along it, without that of the energy; empty: none
  Expr lower{}, upper{};  // limits of the force; empty: none
};

// A row with bounds on a coordinate of the effect: lower <= value <= upper, or a prescribed rate by a force within
// [lower, upper]. A missing bound is infinite.
struct BoundedRow {
  std::string name;
  std::string coordinate;  // among Joint::coordinates
  bool of_rate = false;
  Expr rate;          // prescribed; depends on parameters and time
  Expr lower, upper;  // may depend on `value` too, if they are bounds of the force
  Expr value;         // the leaf of the coordinate
  Span where;
  std::string text;  // as written, for people
  // The leaf of the load that the bounds of the force grow with, and the row of the effect that carries it; -1: the
  // joint of the coordinate. Without a leaf they grow with none.
  Expr load{};
  int load_of = -1;
  // Distances from the events between which the row acts, as shares of what is compared: at most 0 where it happens.
  // They may read the coordinate, its rate and the row's own force too. Empty: it acts from the start, or for ever.
  Expr after{}, until{};
  Expr own_rate{}, own_load{};      // their leaves
  int cone_row = 0, cone_rows = 0;  // its place among rows that share one force, and their number; 0: it is alone
};

// The law of an effect: generalised forces along the rows of its joint, F = force - dE/d(value), and rows with bounds.
struct EffectLaw {
  std::vector<LawInput> inputs;
  Expr energy;  // empty: none
  std::vector<BoundedRow> bounded;
  // Of an effect on the coordinate of any joint: that coordinate, its value a leaf. Such an effect has no bodies and no
  // rows, and at most one input.
  std::optional<Coordinate> free{};
  // The effect is on a joint itself. `free` then stands for the joint: it has no value. `bounded` has one row without
  // bounds, those of the joint, and its `until` breaks the joint.
  bool on_joint = false;
  Expr mass{};  // the leaf of its effective mass 1/K, if the law reads it
};

// Folders, namespaces and headers of specs are named so.
inline std::string name_of_space(int dimension) { return dimension == 2 ? "planar" : "spatial"; }

struct Joint {
  std::shared_ptr<Pool> pool;
  int dimension = 2;
  std::string name, title, source;
  std::string comment;                // the comment block right under or above the header, without `#`, for people
  std::vector<std::string> includes;  // names of the included joints, in order
  std::vector<std::string> bodies;    // "a", "b", ... in order
  std::vector<Parameter> parameters;  // in order of declaration
  std::vector<Let> lets;
  std::vector<Row> rows;
  std::vector<Coordinate> coordinates;
  std::optional<EffectLaw> law;            // of an effect; its rows are coordinates, not constraints
  std::vector<Coordinate> dropped;         // from an include, but constrained by rows
  std::shared_ptr<const SourceFile> file;  // for messages of later stages
  bool uses_world = false;                 // some quantity is fixed in the world
  bool uses_time = false;

  bool on_any_coordinate() const { return law && law->free; }
};

inline std::string name_of_space(const Joint& joint) {
  return joint.on_any_coordinate() ? "coordinate" : name_of_space(joint.dimension);
}

}  // namespace cdot::derive
