#include "derive/language/value.hpp"

#include <algorithm>

namespace cdot::derive {

std::string_view in_words(Type type) {
  switch (type) {
    case Type::poison: return "a mistake";
    case Type::scalar: return "a number";
    case Type::vector: return "a vector";
    case Type::point: return "a point";
    case Type::body: return "a body";
    case Type::frame: return "a frame";
    case Type::matrix: return "a matrix";
  }
  return "";
}

Value of_matrix(Matrix m) {
  Value v;
  v.type = Type::matrix;
  v.matrix = std::make_shared<const Matrix>(std::move(m));
  return v;
}

Value simplest(Matrix m, bool column_is_vector) {
  if (m.rows == 1 && m.columns == 1) return scalar(m.at(0, 0), {});
  if (!column_is_vector || m.columns != 1) return of_matrix(std::move(m));
  Pool& pool = *m.at(0, 0)->pool;
  if (m.rows != pool.dimension()) return of_matrix(std::move(m));
  Expr sum = zero_vector(pool);
  for (int i = 0; i < m.rows; ++i) sum = sum + m.at(i, 0) * world_axes(pool)[static_cast<std::size_t>(i)];
  return vector(sum, {});
}

Matrix as_matrix(const Value& v) {
  if (v.type == Type::matrix) return v.inverted ? inverse(*v.matrix) : *v.matrix;
  if (v.type == Type::scalar) return {1, 1, {v.e}};
  return column_of(v.e);
}

Value skew_of(Expr r) {
  const Expr x = component(r, 0), y = component(r, 1), z = component(r, 2), o = r->pool->number(0);
  Value v = of_matrix({3, 3, {o, -z, y, z, o, -x, -y, x, o}});
  v.skew = r;
  return v;
}

bool same_unit(const Value& a, const Value& b, bool radians_are_numbers) {
  if (!a.unit || !b.unit || *a.unit == *b.unit) return true;
  Unit x = *a.unit, y = *b.unit;
  x.rad = y.rad = 0;
  return (radians_are_numbers || a.ratio || b.ratio) && x == y;
}

}  // namespace cdot::derive
