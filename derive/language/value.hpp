// The value of an author's expression: its type, its unit, the frame of its components, and its Expr.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "derive/expression/expr.hpp"
#include "derive/expression/matrix.hpp"
#include "derive/expression/unit.hpp"

namespace cdot::derive {

// `poison` is the value of an expression with a reported error; an expression that contains it is poison, too.
enum class Type { poison, scalar, vector, point, body, frame, matrix };

struct Value {
  Type type = Type::poison;
  Expr e;                    // scalar; vector; point: its place; frame: its x axis
  std::vector<Expr> axes;    // frame: its axes, two or three
  std::optional<Unit> unit;  // empty: fits every unit (the literal 0, what an entry declares `free`)
  bool ratio = false;        // a number in which lengths cancelled: it may stand for an angle, an arc
                             // over its radius
  bool zero = false;         // the literal 0, which fits vectors too
  int body = -1;             // body, anchored point, frame: -1 is the world
  Expr arm;                  // point anchored in a body: place minus centre of mass
  bool anchored = false;     // point that is known to be fixed in `body`
  std::vector<Expr> along;   // vector whose components are those along a frame: that frame's axes
  std::shared_ptr<const Matrix> matrix;
  // The vector form of a matrix in space, if known: r of skew(r), n of the row n', the leaf of a tensor.
  Expr skew, row, tensor;
  bool inverted = false;  // matrix: the value is its inverse (an inertia tensor, whose inverse has the leaves)
};

inline Value scalar(Expr e, std::optional<Unit> unit = Unit{}) {
  Value v;
  v.type = Type::scalar;
  v.e = e;
  v.unit = unit;
  return v;
}

inline Value vector(Expr e, std::optional<Unit> unit = Unit{}) {
  Value v = scalar(e, unit);
  v.type = Type::vector;
  return v;
}

Value of_matrix(Matrix m);
// A matrix of one entry as a number; in hand derivations a column may be a vector.
Value simplest(Matrix m, bool column_is_vector = false);
// A matrix as it is, a number as 1 x 1, a vector as a column.
Matrix as_matrix(const Value& v);

// In space: the matrix with skew(r) u = r x u.
Value skew_of(Expr r);

std::string_view in_words(Type type);  // "a number", "a vector", ...

// True if two values may be added or compared; if radians are numbers, rad and 1 are one unit.
bool same_unit(const Value& a, const Value& b, bool radians_are_numbers = false);

}  // namespace cdot::derive
