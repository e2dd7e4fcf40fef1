// Expressions as numbers: one walk from leaves to roots for any kind of number (doubles here, a finite field, symbols
// of GiNaC and long decimals elsewhere), and random poses to try formulas at.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "derive/expression/components.hpp"
#include "derive/expression/functions.hpp"
#include "derive/expression/matrix.hpp"
#include "derive/language/joint.hpp"

namespace cdot::derive {

// Components along the world's axes; in the plane the third is zero.
template <class T>
using Triple = std::array<T, 3>;

template <class T>
T inner_product(const Triple<T>& u, const Triple<T>& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}
template <class T>
Triple<T> cross_product(const Triple<T>& u, const Triple<T>& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// Euler parameters (e0, e1, e2, e3) of an orientation, e . e = 1.
template <class T>
using EulerParameters = std::array<T, 4>;

// The product of quaternions; w in world axes turns e at de/dt = 1/2 (0, w) e, w' in the body's at 1/2 e (0, w').
template <class T>
EulerParameters<T> product(const EulerParameters<T>& p, const EulerParameters<T>& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3], p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1]};
}

// The axes of a frame with orientation e: the columns of the rotation matrix
// A(e) = (e0^2 - e'e') E + 2 e' e'^T + 2 e0 ~e', e' = (e1, e2, e3); exact where e . e = 1.
template <class T>
std::array<Triple<T>, 3> axes_of(const EulerParameters<T>& e) {
  const T e00 = e[0] * e[0], e11 = e[1] * e[1], e22 = e[2] * e[2], e33 = e[3] * e[3];
  const auto twice = [](const T& x) -> T { return x + x; };
  return {{{e00 + e11 - e22 - e33, twice(e[1] * e[2] + e[0] * e[3]), twice(e[1] * e[3] - e[0] * e[2])},
           {twice(e[1] * e[2] - e[0] * e[3]), e00 - e11 + e22 - e33, twice(e[2] * e[3] + e[0] * e[1])},
           {twice(e[1] * e[3] + e[0] * e[2]), twice(e[2] * e[3] - e[0] * e[1]), e00 - e11 - e22 + e33}}};
}

// The operations that a walk needs of its numbers.
template <class T>
class Arithmetic {
 public:
  virtual ~Arithmetic() = default;
  virtual T number(Rational value) = 0;
  virtual T scalar_leaf(const Node& symbol) = 0;
  virtual Triple<T> vector_leaf(const Node& symbol) = 0;
  virtual T inverse(const T& x) = 0;
  virtual T call(Fn fn, std::span<const T> args) = 0;
  // True if call() implements the function, even if the table expresses it by others.
  virtual bool has(Fn fn) const { return function_of(fn).by_others == nullptr; }
  // The component i, j of a symmetric tensor leaf.
  virtual T tensor_leaf(const Node& tensor, std::size_t i, std::size_t j) {
    const Expr component = tensor_component(Expr(&tensor), i, j);
    return scalar_leaf(*component);
  }
  virtual Triple<T> direction(const Triple<T>& u) {
    const T inv = inverse(length(u));
    return {u[0] * inv, u[1] * inv, u[2] * inv};
  }
  T length(const Triple<T>& u) {
    const T square = inner_product(u, u);
    return call(Fn::sqrt, std::span<const T>(&square, 1));
  }
};

// Evaluates expressions, each node once, operands before users.
template <class T>
class Evaluation {
 public:
  explicit Evaluation(Arithmetic<T>& arithmetic) : arithmetic_(arithmetic) {}

  T scalar(Expr e) { return values_[place_of(e)][0]; }
  Triple<T> vector(Expr e) { return values_[place_of(e)]; }

  // Evaluates all expressions so far anew, after the leaves have changed.
  void repeat() {
    for (std::size_t i = 0; i < steps_.size(); ++i) values_[i] = value_of(steps_[i]);
  }

 private:
  struct Step {
    Expr e;
    std::vector<std::size_t> operands;  // places in values_
  };

  std::size_t place_of(Expr e) {
    if (const auto known = places_.find(&*e); known != places_.end()) return known->second;
    if (const std::optional<Expr> others = by_others(e)) {
      const std::size_t place = place_of(*others);
      return places_.emplace(&*e, place).first->second;
    }
    Step step{e, {}};
    for (const Expr arg : e->args) {
      const bool tensor = arg->kind == Kind::symbol && is_tensor(arg);  // read by its components
      step.operands.push_back(tensor ? 0 : place_of(arg));
    }
    const Triple<T> value = value_of(step);
    steps_.push_back(std::move(step));
    values_.push_back(value);
    places_.emplace(&*e, steps_.size() - 1);
    return steps_.size() - 1;
  }

  // The same in what the arithmetic has.
  std::optional<Expr> by_others(Expr e) const {
    if (e->kind == Kind::twist) return twist_as_atan2(e);
    if (e->kind != Kind::function || arithmetic_.has(e->fn)) return std::nullopt;
    return function_of(e->fn).by_others(e->args[0]);
  }

  const T& s(const Step& step, std::size_t i) const { return values_[step.operands[i]][0]; }
  const Triple<T>& v(const Step& step, std::size_t i) const { return values_[step.operands[i]]; }

  Triple<T> value_of(const Step& step) { return step.e->vector ? vector_rule(step) : Triple<T>{scalar_rule(step)}; }

  T scalar_rule(const Step& step) {
    const Expr e = step.e;
    switch (e->kind) {
      case Kind::number: return arithmetic_.number(e->value);
      case Kind::symbol: return arithmetic_.scalar_leaf(*e);
      case Kind::sum: {
        T total = arithmetic_.number(0);
        for (std::size_t i = 0; i < e->args.size(); ++i) {
          total = total + arithmetic_.number(e->coefs[i]) * s(step, i);
        }
        return total;
      }
      case Kind::product: return product_rule(step);
      case Kind::dot: return inner_product(v(step, 0), v(step, 1));
      case Kind::cross: return v(step, 0)[0] * v(step, 1)[1] - v(step, 0)[1] * v(step, 1)[0];
      case Kind::norm: return arithmetic_.length(v(step, 0));
      default: break;
    }
    std::vector<T> args;
    for (std::size_t i = 0; i < e->args.size(); ++i) args.push_back(s(step, i));
    return arithmetic_.call(e->fn, args);
  }

  T product_rule(const Step& step) {
    T total = arithmetic_.number(1);
    for (std::size_t i = 0; i < step.operands.size(); ++i) {
      const int exponent = step.e->exponents[i];
      const T base = exponent < 0 ? arithmetic_.inverse(s(step, i)) : s(step, i);
      for (int k = 0; k < (exponent < 0 ? -exponent : exponent); ++k) total = total * base;
    }
    return total;
  }

  Triple<T> vector_rule(const Step& step) {
    const Expr e = step.e;
    switch (e->kind) {
      case Kind::sum: {
        Triple<T> total{arithmetic_.number(0), arithmetic_.number(0), arithmetic_.number(0)};
        for (std::size_t i = 0; i < e->args.size(); ++i) {
          const T coef = arithmetic_.number(e->coefs[i]);
          for (std::size_t k = 0; k < 3; ++k) total[k] = total[k] + coef * v(step, i)[k];
        }
        return total;
      }
      case Kind::scale: return {s(step, 0) * v(step, 1)[0], s(step, 0) * v(step, 1)[1], s(step, 0) * v(step, 1)[2]};
      case Kind::perp: return {arithmetic_.number(-1) * v(step, 0)[1], v(step, 0)[0], arithmetic_.number(0)};
      case Kind::cross: return cross_product(v(step, 0), v(step, 1));
      case Kind::tensor: {
        Triple<T> product;
        for (std::size_t i = 0; i < 3; ++i) {
          const Triple<T> row{arithmetic_.tensor_leaf(*e->args[0], i, 0), arithmetic_.tensor_leaf(*e->args[0], i, 1),
                              arithmetic_.tensor_leaf(*e->args[0], i, 2)};
          product[i] = inner_product(row, v(step, 1));
        }
        return product;
      }
      case Kind::unit: return arithmetic_.direction(v(step, 0));
      default: return arithmetic_.vector_leaf(*e);
    }
  }

  Arithmetic<T>& arithmetic_;
  std::vector<Step> steps_;
  std::vector<Triple<T>> values_;
  std::unordered_map<const Node*, std::size_t> places_;
};

// Values of leaves by name; a vector leaf `t` is read as `t_x`, `t_y`, `t_z`. `pi` and the world's axes are known.
using Values = std::map<std::string, double>;

// The same numbers from the same seed on any machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  double between(double low, double high);

 private:
  std::uint64_t state_;
};

// e, then a turn by an amount about a world axis.
EulerParameters<double> turned_about(std::size_t axis, double amount, const EulerParameters<double>& e);

// Poses and velocities of the bodies, and a value for every other leaf of some expressions.
struct Sample {
  struct Body {
    Triple<double> x{}, v{}, w{};           // in the plane w turns about the third axis
    double theta = 0;                       // in the plane
    EulerParameters<double> e{1, 0, 0, 0};  // in space
    // Along column k of J: x, y, angle in the plane; x, y, z and a turn about a world axis in space.
    void move(int dimension, std::size_t k, double amount);
    double velocity(int dimension, std::size_t k) const {
      return k < std::size_t(dimension) ? v[k] : w[dimension == 2 ? 2 : k - 3];
    }
  };
  std::vector<Body> bodies;
  Values scalars;  // parameters, time, masses, multipliers
  // Of vector leaves: components in the body's (or the world's) frame; of triads: their orientation there.
  std::map<std::string, Triple<double>> local;
  std::map<const Triad*, EulerParameters<double>> triads;
  std::vector<Expr> leaves;
};

// Positions within a few metres, orientations all around, scalars in [0.5, 2], unit vectors of length 1.
Sample random_sample(const Joint& joint, std::span<const Expr> expressions, std::uint64_t seed);

// In doubles, as a kernel computes: 1/0 is 0, the direction of the zero vector is the x axis. Throws std::out_of_range
// with the name of a leaf that has no value.
class Numbers {
 public:
  explicit Numbers(Values values);
  // The sample outlives the numbers. Numbers up to `guard` count as 0 where a formula divides by them.
  explicit Numbers(const Sample& sample, double guard = 0);
  ~Numbers();
  double scalar(Expr e);
  Triple<double> vector(Expr e);
  std::vector<double> of(const std::vector<Expr>& scalars);
  // Evaluates all expressions so far at another sample; cheaper than to begin anew.
  void move_to(const Sample& sample);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
inline double evaluate(Expr scalar, const Values& values) { return Numbers(values).scalar(scalar); }
inline std::vector<double> values_at(const std::vector<Expr>& scalars, const Sample& at) {
  return Numbers(at).of(scalars);
}

}  // namespace cdot::derive
