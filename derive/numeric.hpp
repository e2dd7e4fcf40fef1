// Expressions as numbers: one walk from leaves to roots for any kind of number (doubles here, a
// finite field, symbols of GiNaC and long decimals elsewhere), and random poses to try formulas at.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "derive/joint.hpp"

namespace cdot::derive {

template <class T>
using Pair = std::array<T, 2>;

// What a walk has to know about its numbers.
template <class T>
class Arithmetic {
 public:
  virtual ~Arithmetic() = default;
  virtual T number(Rational value) = 0;
  virtual T scalar_leaf(const Node& symbol) = 0;
  virtual Pair<T> vector_leaf(const Node& symbol) = 0;
  virtual T inverse(const T& x) = 0;
  virtual T call(Fn fn, std::span<const T> args) = 0;
  virtual Pair<T> direction(const Pair<T>& u) {  // of a vector
    const T inv = inverse(length(u));
    return {u[0] * inv, u[1] * inv};
  }
  T length(const Pair<T>& u) {
    const T square = u[0] * u[0] + u[1] * u[1];
    return call(Fn::sqrt, std::span<const T>(&square, 1));
  }
};

// Evaluates expressions over the plane, each node once.
template <class T>
class Evaluation {
 public:
  explicit Evaluation(Arithmetic<T>& arithmetic) : arithmetic_(arithmetic) {}

  T scalar(Expr e) {
    walk(e);
    return scalars_.at(&*e);
  }
  Pair<T> vector(Expr e) {
    walk(e);
    return vectors_.at(&*e);
  }

 private:
  void walk(Expr root) {
    if (scalars_.contains(&*root) || vectors_.contains(&*root)) return;
    for (const Expr e : topological(std::span(&root, 1))) {
      if (e->vector) {
        if (!vectors_.contains(&*e)) vectors_.emplace(&*e, vector_rule(e));
      } else if (!scalars_.contains(&*e)) {
        scalars_.emplace(&*e, scalar_rule(e));
      }
    }
  }

  const T& s(Expr e, std::size_t i) const { return scalars_.at(&*e->args[i]); }
  const Pair<T>& v(Expr e, std::size_t i) const { return vectors_.at(&*e->args[i]); }

  T scalar_rule(Expr e) {
    switch (e->kind) {
      case Kind::number:
        return arithmetic_.number(e->value);
      case Kind::symbol:
        return arithmetic_.scalar_leaf(*e);
      case Kind::sum: {
        T total = arithmetic_.number(0);
        for (std::size_t i = 0; i < e->args.size(); ++i) {
          total = total + arithmetic_.number(e->coefs[i]) * s(e, i);
        }
        return total;
      }
      case Kind::product:
        return product_rule(e);
      case Kind::dot:
        return v(e, 0)[0] * v(e, 1)[0] + v(e, 0)[1] * v(e, 1)[1];
      case Kind::cross:
        return v(e, 0)[0] * v(e, 1)[1] - v(e, 0)[1] * v(e, 1)[0];
      case Kind::norm:
        return arithmetic_.length(v(e, 0));
      default:
        break;
    }
    std::vector<T> args;
    for (std::size_t i = 0; i < e->args.size(); ++i) args.push_back(s(e, i));
    return arithmetic_.call(e->fn, args);
  }

  T product_rule(Expr e) {
    T total = arithmetic_.number(1);
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const int exponent = e->exponents[i];
      const T base = exponent < 0 ? arithmetic_.inverse(s(e, i)) : s(e, i);
      for (int k = 0; k < (exponent < 0 ? -exponent : exponent); ++k) total = total * base;
    }
    return total;
  }

  Pair<T> vector_rule(Expr e) {
    switch (e->kind) {
      case Kind::sum: {
        Pair<T> total{arithmetic_.number(0), arithmetic_.number(0)};
        for (std::size_t i = 0; i < e->args.size(); ++i) {
          const T coef = arithmetic_.number(e->coefs[i]);
          total = {total[0] + coef * v(e, i)[0], total[1] + coef * v(e, i)[1]};
        }
        return total;
      }
      case Kind::scale:
        return {s(e, 0) * v(e, 1)[0], s(e, 0) * v(e, 1)[1]};
      case Kind::perp:
        return {arithmetic_.number(-1) * v(e, 0)[1], v(e, 0)[0]};
      case Kind::unit:
        return arithmetic_.direction(v(e, 0));
      default:
        return arithmetic_.vector_leaf(*e);
    }
  }

  Arithmetic<T>& arithmetic_;
  std::map<const Node*, T> scalars_;
  std::map<const Node*, Pair<T>> vectors_;
};

// Values of leaves by name; a vector leaf `t` is read as `t_x`, `t_y`. `pi` and `e_x` are known.
using Values = std::map<std::string, double>;

// In doubles, as a kernel computes: 1/0 is 0, the direction of the zero vector is (1, 0).
// Throws std::out_of_range with the name of a leaf that has no value.
class Numbers {
 public:
  explicit Numbers(Values values);
  ~Numbers();
  double scalar(Expr e);
  Pair<double> vector(Expr e);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};
inline double evaluate(Expr scalar, const Values& values) { return Numbers(values).scalar(scalar); }

// The same numbers from the same seed on any machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits();
  double between(double low, double high);

 private:
  std::uint64_t state_;
};

// Bodies somewhere, and a value for everything else that some expressions contain.
struct Sample {
  struct Body {
    double x = 0, y = 0, theta = 0, v_x = 0, v_y = 0, w = 0;
  };
  std::vector<Body> bodies;
  Values scalars;  // parameters, time, masses, multipliers
  std::map<std::string, Pair<double>>
      local;  // of vector leaves: components in the body's (or the world's) frame
  std::vector<Expr> leaves;
};

// Every leaf of the expressions, in the order of their names.
std::vector<Expr> leaves_of(std::span<const Expr> expressions);

// Positions within a few metres, angles all around, scalars in [0.5, 2], unit vectors of length 1.
Sample random_sample(const Joint& joint, std::span<const Expr> expressions, std::uint64_t seed);

// The leaves' values in world axes.
Values world_values(const Joint& joint, const Sample& sample);

}  // namespace cdot::derive
