// Expressions to GiNaC's, over either set of coordinates, and the chain rule over them.
#include "derive/proof/ginac.hpp"

#include <algorithm>
#include <cmath>

namespace cdot::derive {

Algebra::Algebra(const Joint& joint, Route route, int immovable, std::int64_t slopes)
    : joint_(joint), route_(route), immovable_(immovable), left_for_slopes_(slopes), evaluation_(*this) {}

namespace {

struct NumbersTooLong final : NumberTooLarge {
  const char* what() const noexcept override {
    return "exact numbers in the proof would have more than 30000 digits: names with fractions are raised to powers, "
           "one inside the other";
  }
};

double bits_of(Rational value) {
  return std::log2(1 + std::abs(static_cast<double>(value.num()))) + std::log2(static_cast<double>(value.den())) - 1;
}

}  // namespace

// GiNaC takes numbers out of powers: (c x)^3 = c^3 x^3, so nested names have numbers of 3^n digits. A sum needs about
// the digits of its longest term, a product those of all factors.
Expr Algebra::with_short_numbers(Expr root) {
  constexpr double most_bits = 100000;
  if (bits_.contains(&*root)) return root;
  for (const Expr e : topological(std::span(&root, 1))) {
    double bits = e->kind == Kind::number ? bits_of(e->value) : 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const double of_arg = bits_.at(&*e->args[i]);
      if (e->kind == Kind::sum) bits = std::max(bits, of_arg + bits_of(e->coefs[i]));
      else bits += of_arg * (e->kind == Kind::product ? std::abs(e->exponents[i]) : 1);
    }
    if (bits > most_bits) throw NumbersTooLong();
    bits_[&*e] = bits;
  }
  return root;
}

ex Algebra::leaf(const std::string& name, const ex& rate) {
  const auto found = leaves_.find(name);
  if (found != leaves_.end()) return found->second.symbol;
  const ex symbol = leaves_.emplace(name, Leaf{fresh_symbol(name), rate}).first->second.symbol;
  drawn_with_.emplace(symbol, name);
  drawn_together_[name] = {symbol};
  return symbol;
}

std::vector<ex> Algebra::velocities(int body) {
  const std::size_t columns = columns_per_body(joint_.dimension);
  if (!moves(body)) return std::vector<ex>(columns, 0);
  const std::string& name = joint_.bodies[static_cast<std::size_t>(body)];
  std::vector<ex> v = {leaf("v_" + name + "_x", 0), leaf("v_" + name + "_y", 0)};
  if (joint_.dimension == 2) {
    v.push_back(leaf("w_" + name, 0));
  } else {
    v.push_back(leaf("v_" + name + "_z", 0));
    for (const char* axis : {"_x", "_y", "_z"}) v.push_back(leaf("w_" + name + axis, 0));
  }
  return v;
}

std::vector<ex> Algebra::coordinates(int body) {
  const std::string& name = joint_.bodies[static_cast<std::size_t>(body)];
  const std::vector<ex> rates = velocities(body);
  std::vector<ex> q;
  for (int k = 0; k < joint_.dimension; ++k) {
    q.push_back(leaf("x_" + name + "_" + "xyz"[k], rates[static_cast<std::size_t>(k)]));
  }
  if (joint_.dimension == 2) {
    q.push_back(leaf("theta_" + name, rates[2]));
  } else if (route_ == Route::raw) {
    const EulerParameters<ex> e = orientation("e_" + name, body);
    q.insert(q.end(), e.begin(), e.end());
  }
  return q;
}

namespace {

EulerParameters<ex> rates_of(const EulerParameters<ex>& e, const ex& w_x, const ex& w_y, const ex& w_z) {
  return product(EulerParameters<ex>{0, w_x / 2, w_y / 2, w_z / 2}, e);
}

}  // namespace

// Once the work is spent, no slope is GiNaC's: which parts it has finished by then depends on the run.
ex Algebra::derivative(const ex& e, const ex& symbol) try {
  if (!is_a<GiNaC::symbol>(symbol)) return 0;
  if (left_for_slopes_ == 0) return derivative_at_points(e, symbol);
  const auto of_leaf = [this, symbol](const ex& other) { return derivative_at_points(other, symbol); };
  return slopes_.try_emplace(symbol, symbol, left_for_slopes_, of_leaf).first->second.of(e);
} catch (const Slope::TooLong&) {
  return derivative_at_points(e, symbol);
}

// With work of its own: the law of momentum must not depend on how much the others left.
ex Algebra::constant_slope(const ex& e, const ex& symbol) try {
  std::int64_t left = most_slopes / 16;
  const ex slope = Slope(symbol, left, [](const ex&) -> ex { return 0; }).of(e);
  return is_a<numeric>(slope) ? slope : 0;
} catch (const Slope::TooLong&) {
  return numeric_slope(e, symbol).value_or(0);
}

ex Algebra::derivative_at_points(const ex& e, const ex& symbol) {
  if (is_a<GiNaC::symbol>(e) && slopes_at_points_.empty()) return e.is_equal(symbol) ? 1 : 0;
  const std::size_t place = steps_.slope(steps_.place_of(e), symbol);
  for (const int constant : {0, 1})
    if (place == steps_.place_of(constant)) return constant;
  const auto [found, fresh] = slopes_at_points_.try_emplace(place);
  if (fresh) places_of_slopes_.insert(steps_.define(found->second = fresh_symbol(), place));
  return found->second;
}

void Algebra::add_unit(std::vector<ex> components) {
  for (const ex& component : components) drawn_with_[component] = drawn_with_.at(components[0]);
  drawn_together_[drawn_with_.at(components[0])] = components;
  units_.push_back(std::move(components));
}

EulerParameters<ex> Algebra::orientation(const std::string& name, int body) {
  const bool fresh = !leaves_.contains(name + "0");
  EulerParameters<ex> e;
  for (std::size_t k = 0; k < 4; ++k) e[k] = leaf(name + std::to_string(k), 0);
  if (!fresh) return e;
  add_unit({e.begin(), e.end()});
  // e0^2 = 1 - e1^2 - e2^2 - e3^2
  relate(Atom::Kind::square, e[0], 1 - e[1] * e[1] - e[2] * e[2] - e[3] * e[3]);
  if (!moves(body)) return e;
  const std::vector<ex> v = velocities(body);
  const EulerParameters<ex> rates = rates_of(e, v[3], v[4], v[5]);
  for (std::size_t k = 0; k < 4; ++k) leaves_.at(name + std::to_string(k)).rate = rates[k];
  return e;
}

ex Algebra::slope(const ex& e, int body, std::size_t k) {
  if (!moves(body)) return 0;
  const std::vector<ex> q = coordinates(body);
  if (joint_.dimension == 2 || k < 3) return derivative(e, q[k]);
  const auto unit = [&](std::size_t axis) { return ex(k == axis ? 1 : 0); };
  const EulerParameters<ex> rates = rates_of({q[3], q[4], q[5], q[6]}, unit(3), unit(4), unit(5));
  ex total = 0;
  for (std::size_t m = 0; m < 4; ++m) total += derivative(e, q[3 + m]) * rates[m];
  return total;
}

ex Algebra::rate(const ex& e) {
  ex total = 0;
  for (const auto& [name, leaf] : leaves_) {
    if (!leaf.rate.is_zero()) total += derivative(e, leaf.symbol) * leaf.rate;
  }
  return total;
}

ex Algebra::number(Rational value) {
  return numeric(static_cast<long>(value.num())) / numeric(static_cast<long>(value.den()));
}

ex Algebra::scalar_leaf(const Node& symbol) {
  switch (symbol.role) {
    case Role::constant: return GiNaC::Pi;
    case Role::time: return leaf(symbol.symbol, 1);
    case Role::angle: return coordinates(symbol.body)[2];
    case Role::spin: return velocities(symbol.body)[2];
    default: return leaf(symbol.symbol, 0);
  }
}

// A vector with independent components, of length 1 where that is known.
Triple<ex> Algebra::free_vector(const Node& symbol) {
  const std::string last = joint_.dimension == 2 ? "_y" : "_z";
  const bool fresh = !leaves_.contains(symbol.symbol + "_x");
  const Triple<ex> u{leaf(symbol.symbol + "_x", 0), leaf(symbol.symbol + "_y", 0),
                     joint_.dimension == 2 ? ex(0) : leaf(symbol.symbol + "_z", 0)};
  if (!fresh) return u;
  if (route_ == Route::names && symbol.role == Role::body_vector && moves(symbol.body)) {
    const std::vector<ex> v = velocities(symbol.body);
    const Triple<ex> w = joint_.dimension == 2 ? Triple<ex>{0, 0, v[2]} : Triple<ex>{v[3], v[4], v[5]};
    const Triple<ex> rate = cross_product(w, u);
    for (int k = 0; k < joint_.dimension; ++k) {
      leaves_.at(symbol.symbol + "_" + "xyz"[k]).rate = rate[static_cast<std::size_t>(k)];
    }
  }
  if (symbol.unit_length) {
    add_unit({u.begin(), u.begin() + joint_.dimension});
    ex square = 1;
    for (int k = 0; k + 1 < joint_.dimension; ++k) {
      square -= u[static_cast<std::size_t>(k)] * u[static_cast<std::size_t>(k)];
    }
    relate(Atom::Kind::square, leaf(symbol.symbol + last, 0), square);
  }
  return u;
}

Triple<ex> Algebra::vector_leaf(const Node& symbol) {
  const Expr e(&symbol);
  if (is_world_axis(e)) {
    Triple<ex> axis{0, 0, 0};
    axis[static_cast<std::size_t>(symbol.symbol.back() - 'x')] = 1;
    return axis;
  }
  const auto of = [&](const std::vector<ex>& v, std::size_t first) {
    return Triple<ex>{v[first], v[first + 1], joint_.dimension == 2 ? ex(0) : v[first + 2]};
  };
  switch (symbol.role) {
    case Role::position: return of(coordinates(symbol.body), 0);
    case Role::velocity: return of(velocities(symbol.body), 0);
    case Role::spin: return of(velocities(symbol.body), 3);
    default: return vector_of_body(symbol);
  }
}

// A vector fixed in a body or in the world.
Triple<ex> Algebra::vector_of_body(const Node& symbol) {
  const bool rotated = symbol.role == Role::body_vector && route_ == Route::raw;
  const bool body_axis = symbol.symbol.starts_with("axis_");
  if (joint_.dimension == 2) {
    if (!rotated) return free_vector(symbol);
    const ex theta = coordinates(symbol.body)[2], c = cos(theta), s = sin(theta);
    if (body_axis) return {c, s, 0};
    const Triple<ex> l = free_vector(symbol);
    return {c * l[0] - s * l[1], s * l[0] + c * l[1], 0};
  }
  const Pool::Axis axis = joint_.pool->axis_of(Expr(&symbol));
  const auto index = static_cast<std::size_t>(axis.index);
  const auto triad = [&] {
    const std::string stem = symbol.symbol.substr(0, symbol.symbol.size() - 1) + "e";
    return axes_of(orientation(stem, rotated ? -1 : symbol.body));
  };
  if (!rotated) return axis.triad ? triad()[index] : free_vector(symbol);
  const std::vector<ex> q = coordinates(symbol.body);
  const auto A = axes_of(EulerParameters<ex>{q[3], q[4], q[5], q[6]});
  if (body_axis) return A[index];
  const Triple<ex> l = axis.triad ? triad()[index] : free_vector(symbol);
  Triple<ex> turned{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) turned[i] += A[k][i] * l[k];
  }
  return turned;
}

ex Algebra::call(Fn fn, std::span<const ex> args) { return ginac_function(fn, args); }

}  // namespace cdot::derive
