#include "derive/value.hpp"

namespace cdot::derive {

std::string_view in_words(Type type) {
  switch (type) {
    case Type::poison:
      return "a mistake";
    case Type::scalar:
      return "a number";
    case Type::vector:
      return "a vector";
    case Type::point:
      return "a point";
    case Type::body:
      return "a body";
    case Type::frame:
      return "a frame";
    case Type::matrix:
      return "a matrix";
  }
  return "";
}

bool same_unit(const Value& a, const Value& b, bool radians_are_numbers) {
  if (!a.unit || !b.unit || *a.unit == *b.unit) return true;
  Unit x = *a.unit, y = *b.unit;
  x.rad = y.rad = 0;
  return (radians_are_numbers || a.ratio || b.ratio) && x == y;
}

Expr components_along(Expr u, Expr axis) {
  const Expr x = world_x(*u->pool);
  return dot(axis, u) * x + dot(perp(axis), u) * perp(x);
}

Expr component(Expr u, int index) {
  Pool& pool = *u->pool;
  const Expr x = world_x(pool), along = index == 0 ? x : perp(x), across = index == 0 ? perp(x) : x;
  std::vector<Term> terms;
  for (const Term& t : terms_of(u)) {
    if (t.e == along)
      terms.push_back({t.coef, pool.number(1)});
    else if (t.e->kind == Kind::scale && t.e->args[1] == along)
      terms.push_back({t.coef, t.e->args[0]});
    else if (t.e != across && !(t.e->kind == Kind::scale && t.e->args[1] == across))
      return dot(along, u);
  }
  return sum(pool, terms, false);
}

}  // namespace cdot::derive
