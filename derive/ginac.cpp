// From expressions to GiNaC's, over either set of coordinates, and the chain rule over them.
#include "derive/ginac.hpp"

#include <stdexcept>

namespace cdot::derive {

using GiNaC::ex;
using GiNaC::ex_to;
using GiNaC::numeric;

Algebra::Algebra(const Joint& joint, Route route, int immovable)
    : joint_(joint), route_(route), immovable_(immovable), evaluation_(*this) {}

ex Algebra::leaf(const std::string& name, const ex& rate) {
  const auto found = leaves_.find(name);
  if (found != leaves_.end()) return found->second.symbol;
  return leaves_.emplace(name, Leaf{GiNaC::realsymbol(name), rate}).first->second.symbol;
}

std::array<ex, 3> Algebra::velocities(int body) {
  const std::string& name = joint_.bodies[static_cast<std::size_t>(body)];
  if (!moves(body)) return {0, 0, 0};
  return {leaf("v_" + name + "_x", 0), leaf("v_" + name + "_y", 0), leaf("w_" + name, 0)};
}

std::array<ex, 3> Algebra::coordinates(int body) {
  const std::string& name = joint_.bodies[static_cast<std::size_t>(body)];
  const std::array<ex, 3> rates = velocities(body);
  return {leaf("x_" + name + "_x", rates[0]), leaf("x_" + name + "_y", rates[1]),
          leaf("theta_" + name, rates[2])};
}

ex Algebra::rate(const ex& e) {
  ex total = 0;
  for (const auto& [name, leaf] : leaves_) {
    if (!leaf.rate.is_zero()) total += e.diff(leaf.symbol) * leaf.rate;
  }
  return total;
}

ex Algebra::number(Rational value) {
  return numeric(static_cast<long>(value.num())) / numeric(static_cast<long>(value.den()));
}

ex Algebra::scalar_leaf(const Node& symbol) {
  switch (symbol.role) {
    case Role::constant:
      return GiNaC::Pi;
    case Role::time:
      return leaf(symbol.symbol, 1);
    case Role::angle:
      return coordinates(symbol.body)[2];
    case Role::spin:
      return velocities(symbol.body)[2];
    default:
      return leaf(symbol.symbol, 0);
  }
}

// Components that are nobody's function, of length 1 where that is known.
Pair<ex> Algebra::free_vector(const Node& symbol) {
  const bool fresh = !leaves_.contains(symbol.symbol + "_x");
  ex rate_x = 0, rate_y = 0;
  const ex x = leaf(symbol.symbol + "_x", 0), y = leaf(symbol.symbol + "_y", 0);
  if (route_ == Route::names && symbol.role == Role::body_vector && moves(symbol.body)) {
    const ex w = velocities(symbol.body)[2];
    leaves_.at(symbol.symbol + "_x").rate = -w * y;
    leaves_.at(symbol.symbol + "_y").rate = w * x;
  }
  if (fresh && symbol.unit_length) {
    unit_vectors_.push_back({x, y});
    atoms_.push_back({Atom::Kind::square, ex_to<GiNaC::realsymbol>(y), 1 - x * x});
  }
  return {x, y};
}

Pair<ex> Algebra::vector_leaf(const Node& symbol) {
  if (symbol.role == Role::position) {
    const auto q = coordinates(symbol.body);
    return {q[0], q[1]};
  }
  if (symbol.role == Role::velocity) {
    const auto v = velocities(symbol.body);
    return {v[0], v[1]};
  }
  if (&symbol == &*world_x(*joint_.pool)) return {1, 0};
  if (symbol.role != Role::body_vector || route_ == Route::names) return free_vector(symbol);
  const ex theta = coordinates(symbol.body)[2], c = cos(theta), s = sin(theta);
  if (symbol.symbol.starts_with("axis_")) return {c, s};
  const Pair<ex> l = free_vector(symbol);
  return {c * l[0] - s * l[1], s * l[0] + c * l[1]};
}

ex Algebra::call(Fn fn, std::span<const ex> args) {
  const ex& x = args[0];
  switch (fn) {
    case Fn::sqrt:
      return GiNaC::sqrt(x);
    case Fn::sin:
      return sin(x);
    case Fn::cos:
      return cos(x);
    case Fn::tan:
      return sin(x) / cos(x);
    case Fn::exp:
      return exp(x);
    case Fn::log:
      return log(x);
    case Fn::abs:
      return GiNaC::sqrt(x * x);
    case Fn::sign:
      return GiNaC::sqrt(x * x) / x;
    case Fn::atan2:
      return atan2(x, args[1]);
    default:
      break;
  }
  throw std::logic_error("no such function before the components are written out");
}

}  // namespace cdot::derive
