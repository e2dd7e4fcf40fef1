#include "tests/derive/expression/random_expressions.hpp"

#include <cmath>
#include <stdexcept>

namespace cdot::derive {
namespace {

double length(const Triple<double>& u) { return std::hypot(u[0], u[1], u[2]); }
Triple<double> scaled(double c, const Triple<double>& u) { return {c * u[0], c * u[1], c * u[2]}; }
Triple<double> summed(const Triple<double>& u, const Triple<double>& v) {
  return {u[0] + v[0], u[1] + v[1], u[2] + v[2]};
}
bool moderate(double x) { return std::abs(x) < 200; }
bool away_from_zero(double x) { return std::abs(x) > 0.05; }

}  // namespace

RandomExpressions::RandomExpressions(Pool& pool, std::uint64_t seed) : pool_(pool), random_(seed) {
  add_leaf("x_a", Role::position, 0, false);
  add_leaf("x_b", Role::position, 1, false);
  add_leaf("ra", Role::body_vector, 0, false);
  add_leaf("t", Role::body_vector, 1, true);
  add_leaf("n", Role::world_vector, -1, true);
  Triple<double> axis{};
  for (const Expr e : world_axes(pool)) {
    axis = vectors_.size() == 5 ? Triple<double>{1, 0, 0} : Triple<double>{0, axis[0], axis[1]};
    vectors_.push_back({e, axis});
  }
  for (const char* name : {"theta_a", "l", "k"}) {
    leaves_[name] = random_.between(-2, 2);
    scalars_.push_back({pool.symbol(name, name[0] == 't' ? Role::angle : Role::parameter), leaves_[name]});
  }
  for (const Rational number : {Rational(2), Rational(-1), Rational(1, 2), Rational(0)}) {
    scalars_.push_back({pool.number(number), number.value()});
  }
}

void RandomExpressions::add_leaf(const char* name, Role role, int body, bool of_unit_length) {
  const double angle = random_.between(-3, 3), size = of_unit_length ? 1 : random_.between(0.3, 3);
  const double height = pool_.dimension() == 2 ? 0 : random_.between(-0.9, 0.9);
  const double across = std::sqrt(1 - height * height);
  const Triple<double> value = scaled(size, {across * std::cos(angle), across * std::sin(angle), height});
  for (int k = 0; k < pool_.dimension(); ++k) {
    leaves_[std::string(name) + "_" + "xyz"[k]] = value[static_cast<std::size_t>(k)];
  }
  vectors_.push_back({pool_.vector_symbol(name, role, body, of_unit_length), value});
}

void RandomExpressions::keep(KnownScalar s) {
  if (moderate(s.value)) scalars_.push_back(s);
}
void RandomExpressions::keep(KnownVector v) {
  if (moderate(length(v.value))) vectors_.push_back(v);
}

void RandomExpressions::grow(int steps) {
  for (int i = 0; i < steps; ++i) {
    switch (pick(3)) {
      case 0: grow_scalar(); break;
      case 1: grow_vector(); break;
      default: grow_function();
    }
  }
}

void RandomExpressions::grow_scalar() {
  const KnownScalar a = scalar(), b = scalar();
  const KnownVector u = vector(), v = vector();
  switch (pick(8)) {
    case 0: return keep(KnownScalar{a.e + b.e, a.value + b.value});
    case 1: return keep(KnownScalar{a.e - b.e, a.value - b.value});
    case 2: return keep(KnownScalar{a.e * b.e, a.value * b.value});
    case 3:
      if (away_from_zero(b.value)) keep(KnownScalar{a.e / b.e, a.value / b.value});
      return;
    case 4: return keep(KnownScalar{pow(a.e, 3), a.value * a.value * a.value});
    case 5: return keep(KnownScalar{cdot::derive::norm(u.e), length(u.value)});
    case 6: return keep(KnownScalar{dot(u.e, v.e), inner_product(u.value, v.value)});
    default: {
      const Triple<double> value = cross_product(u.value, v.value);
      if (pool_.dimension() == 2) return keep(KnownScalar{cross(u.e, v.e), value[2]});
      const KnownVector w = vector();
      return keep(KnownScalar{dot(cross(u.e, v.e), w.e), inner_product(value, w.value)});
    }
  }
}

void RandomExpressions::grow_vector() {
  const KnownScalar a = scalar();
  const KnownVector u = vector(), v = vector();
  switch (pick(7)) {
    case 0: return keep(KnownVector{u.e + v.e, summed(u.value, v.value)});
    case 1: return keep(KnownVector{u.e - v.e, summed(u.value, scaled(-1, v.value))});
    case 2: return keep(KnownVector{a.e * u.e, scaled(a.value, u.value)});
    case 3: return grow_turned(u, v);
    case 4:
      if (pool_.dimension() == 2) {
        keep(KnownVector{cross(a.e, u.e), {-a.value * u.value[1], a.value * u.value[0], 0}});
      }
      return;
    case 5:
      if (away_from_zero(length(u.value))) {
        keep(KnownVector{unit(u.e), scaled(1 / length(u.value), u.value)});
      }
      return;
    default:
      if (away_from_zero(a.value)) keep(KnownVector{u.e / a.e, scaled(1 / a.value, u.value)});
  }
}

// Adds a quarter turn in the plane, a cross product in space.
void RandomExpressions::grow_turned(const KnownVector& u, const KnownVector& v) {
  if (pool_.dimension() == 2) return keep(KnownVector{perp(u.e), {-u.value[1], u.value[0], 0}});
  keep(KnownVector{cross(u.e, v.e), cross_product(u.value, v.value)});
}

void RandomExpressions::grow_function() {
  const KnownScalar a = scalar(), b = scalar();
  if (std::abs(a.value) > 3) return;
  switch (pick(7)) {
    case 0: return keep(KnownScalar{call(Fn::sin, a.e), std::sin(a.value)});
    case 1: return keep(KnownScalar{call(Fn::cos, a.e), std::cos(a.value)});
    case 2: return keep(KnownScalar{call(Fn::exp, a.e), std::exp(a.value)});
    case 3: return keep(KnownScalar{call(Fn::abs, a.e), std::abs(a.value)});
    case 4:
      if (a.value > 0.05) keep(KnownScalar{call(Fn::sqrt, a.e), std::sqrt(a.value)});
      return;
    case 5:
      if (a.value > 0.05) keep(KnownScalar{call(Fn::log, a.e), std::log(a.value)});
      return;
    default: {
      // Near the negative axis a rounding error may turn atan2 by 2 pi.
      const Expr args[] = {a.e, b.e};
      if (b.value > 0.05) keep(KnownScalar{call(Fn::atan2, args), std::atan2(a.value, b.value)});
    }
  }
}

namespace {

double apply(const Operation& op, const std::vector<double>& x) {
  switch (op.fn) {
    case Fn::sqrt: return std::sqrt(x[0]);
    case Fn::sin: return std::sin(x[0]);
    case Fn::cos: return std::cos(x[0]);
    case Fn::tan: return std::tan(x[0]);
    case Fn::exp: return std::exp(x[0]);
    case Fn::log: return std::log(x[0]);
    case Fn::abs: return std::abs(x[0]);
    case Fn::sign: return (x[0] > 0) - (x[0] < 0);
    case Fn::atan2: return std::atan2(x[0], x[1]);
    case Fn::inverse: return x[0] == 0 ? 0 : 1 / x[0];
    case Fn::select: return x[0] > 0 ? x[1] : x[2];
    case Fn::pivot: return x[0] > 1e-14 * x[1] ? 1 / x[0] : 0;
    default: return function_of(op.fn).value(x.data());
  }
}

double compute(const Operation& op, const std::vector<double>& x, const Values& inputs) {
  double result = op.kind == OpKind::product ? 1 : 0;
  switch (op.kind) {
    case OpKind::number:
    case OpKind::factor: return op.value.value();
    case OpKind::input: return inputs.at(op.input);
    case OpKind::sum:
      for (std::size_t i = 0; i < x.size(); ++i) result += op.coefs[i].value() * x[i];
      return result;
    case OpKind::product:
      for (std::size_t i = 0; i < x.size(); ++i) result *= std::pow(x[i], op.exponents[i]);
      return result;
    case OpKind::function: return apply(op, x);
  }
  throw std::logic_error("an unknown operation");
}

}  // namespace

std::vector<double> run(const Program& program, const Values& inputs) {
  std::vector<double> value;
  for (const Operation& op : program.ops) {
    std::vector<double> x;
    for (const int arg : op.args) x.push_back(value.at(static_cast<std::size_t>(arg)));
    value.push_back(compute(op, x, inputs));
  }
  std::vector<double> outputs;
  for (const Output& output : program.outputs) outputs.push_back(value.at(static_cast<std::size_t>(output.op)));
  return outputs;
}

}  // namespace cdot::derive
