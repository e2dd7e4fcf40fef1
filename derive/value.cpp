#include "derive/value.hpp"

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

Expr components_along(Expr u, const std::vector<Expr>& axes) {
  const std::vector<Expr> world = world_axes(*u->pool);
  Expr sum = zero_vector(*u->pool);
  for (std::size_t k = 0; k < axes.size(); ++k) sum = sum + dot(axes[k], u) * world[k];
  return sum;
}

Expr component(Expr u, std::size_t index) {
  Pool& pool = *u->pool;
  const std::vector<Expr> world = world_axes(pool);
  const auto is_axis = [&](Expr e) { return std::find(world.begin(), world.end(), e) != world.end(); };
  std::vector<Term> terms;
  for (const Term& t : terms_of(u)) {
    const bool scaled = t.e->kind == Kind::scale;
    const Expr direction = scaled ? t.e->args[1] : t.e;
    if (!is_axis(direction)) return dot(world[index], u);
    if (direction == world[index]) terms.push_back({t.coef, scaled ? t.e->args[0] : pool.number(1)});
  }
  return sum(pool, terms, false);
}

}  // namespace cdot::derive
