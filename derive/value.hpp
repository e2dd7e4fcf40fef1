// What an expression of the author amounts to: its type, its unit, the frame of its components, and
// its Expr.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "derive/expr.hpp"
#include "derive/matrix.hpp"
#include "derive/unit.hpp"

namespace cdot::derive {

// `poison` stands for what went wrong and was reported; whatever is made of it is poison too.
enum class Type { poison, scalar, vector, point, body, frame, matrix };

struct Value {
  Type type = Type::poison;
  Expr e;  // scalar; vector; point: its place; frame: its x axis
  std::optional<Unit>
      unit;               // empty: fits every unit (the literal 0, what an entry declares `free`)
  bool ratio = false;     // a number in which lengths cancelled: it may stand for an angle, an arc
                          // over its radius
  bool zero = false;      // the literal 0, which fits vectors too
  int body = -1;          // body, anchored point, frame: -1 is the world
  Expr arm;               // point anchored in a body: place minus centre of mass
  bool anchored = false;  // point that is known to be fixed in `body`
  Expr axis;              // vector whose components are those along a frame: that frame's x axis
  std::shared_ptr<const Matrix> matrix;
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

std::string_view in_words(Type type);  // "a number", "a vector", ...

// Whether two values may be added or compared; if radians are numbers, a rad and 1 are one.
bool same_unit(const Value& a, const Value& b, bool radians_are_numbers = false);

// u along a frame with the x axis `axis`, as a vector whose world components are these components.
Expr components_along(Expr u, Expr axis);
// Component 0 or 1 along the world's axes.
Expr component(Expr u, int index);

}  // namespace cdot::derive
