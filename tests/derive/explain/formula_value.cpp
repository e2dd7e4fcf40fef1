#include "formula_value.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "derive/expression/symbols.hpp"

using namespace cdot::derive;

namespace {

Array scalar(double x) { return {1, 1, {x}}; }
Array column(const Triple<double>& v, std::size_t dimension) {
  return {dimension, 1, std::vector<double>(v.begin(), v.begin() + static_cast<long>(dimension))};
}

Triple<double> triple(const Array& a) { return {a.entries[0], a.entries[1], a.entries.size() > 2 ? a.entries[2] : 0}; }

Array times(double s, Array a) {
  for (double& x : a.entries) x *= s;
  return a;
}

Array added(Array a, const Array& b, double sign) {
  if (a.entries.size() == 1 && a.entries[0] == 0) return times(sign, b);
  if (a.entries.size() != b.entries.size()) throw std::logic_error("a sum of different shapes");
  for (std::size_t i = 0; i < a.entries.size(); ++i) a.entries[i] += sign * b.entries[i];
  return a;
}

Array multiplied(const Array& a, const Array& b) {
  if (a.entries.size() == 1) return times(a.entries[0], b);
  if (b.entries.size() == 1) return times(b.entries[0], a);
  if (a.columns != b.rows) throw std::logic_error("a product of shapes that do not fit");
  Array c{a.rows, b.columns, std::vector<double>(a.rows * b.columns)};
  for (std::size_t i = 0; i < a.rows; ++i) {
    for (std::size_t j = 0; j < b.columns; ++j) {
      for (std::size_t k = 0; k < a.columns; ++k) c.entries[i * c.columns + j] += a.at(i, k) * b.at(k, j);
    }
  }
  return c;
}

Array transposed(const Array& a) {
  Array t{a.columns, a.rows, std::vector<double>(a.entries.size())};
  for (std::size_t i = 0; i < a.rows; ++i) {
    for (std::size_t j = 0; j < a.columns; ++j) t.entries[j * t.columns + i] = a.at(i, j);
  }
  return t;
}

Array cross_product(const Array& u, const Array& v) {
  if (u.entries.size() == 3) return column(cdot::derive::cross_product(triple(u), triple(v)), 3);
  if (u.entries.size() == 1) return column({-u.entries[0] * v.entries[1], u.entries[0] * v.entries[0], 0}, 2);
  return scalar(u.entries[0] * v.entries[1] - u.entries[1] * v.entries[0]);
}

// S(r): in the plane the column with S(r) w = w × r, in space the matrix with S(r) u = r × u.
Array skew(const Array& r) {
  if (r.entries.size() == 2) return column({-r.entries[1], r.entries[0], 0}, 2);
  const auto [x, y, z] = triple(r);
  return {3, 3, {0, -z, y, z, 0, -x, -y, x, 0}};
}

// Assembles blocks in rows and columns; a 0 takes the size of its place.
Array assembled(const Formula& f, const std::vector<Array>& blocks) {
  const std::size_t n = static_cast<std::size_t>(f.columns), m = blocks.size() / n;
  std::vector<std::size_t> heights(m, 1), widths(n, 1), tops(m + 1), lefts(n + 1);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    heights[k / n] = std::max(heights[k / n], blocks[k].rows);
    widths[k % n] = std::max(widths[k % n], blocks[k].columns);
  }
  for (std::size_t i = 0; i < m; ++i) tops[i + 1] = tops[i] + heights[i];
  for (std::size_t j = 0; j < n; ++j) lefts[j + 1] = lefts[j] + widths[j];
  Array a{tops[m], lefts[n], std::vector<double>(tops[m] * lefts[n])};
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    for (std::size_t i = 0; i < blocks[k].rows; ++i) {
      for (std::size_t j = 0; j < blocks[k].columns; ++j) {
        a.entries[(tops[k / n] + i) * a.columns + lefts[k % n] + j] = blocks[k].at(i, j);
      }
    }
  }
  return a;
}

double length(const Array& u) {
  const auto [x, y, z] = triple(u);
  return std::hypot(x, y, z);
}

double called(const std::string& name, const std::vector<Array>& args) {
  const double x = args[0].entries[0];
  if (name == "sqrt") return std::sqrt(x);
  if (name == "sin") return std::sin(x);
  if (name == "cos") return std::cos(x);
  if (name == "tan") return std::tan(x);
  if (name == "exp") return std::exp(x);
  if (name == "log") return std::log(x);
  if (name == "abs") return std::fabs(x);
  if (name == "sign") return x > 0 ? 1 : x < 0 ? -1 : 0;
  if (name == "atan2") return std::atan2(x, args[1].entries[0]);
  if (name == "twist") throw NoValue(name);  // needs whole frames, not only their x axes
  if (name == "angle") {
    const Array sine = cross_product(args[0], args[1]);
    return std::atan2(sine.entries.size() == 1 ? sine.entries[0] : length(sine),
                      multiplied(transposed(args[0]), args[1]).entries[0]);
  }
  throw std::logic_error("unknown function " + name);
}

Array tensor(Expr leaf, const Values& values) {
  Array a{3, 3, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) a.entries.push_back(evaluate(tensor_component(leaf, i, j), values));
  }
  return a;
}

// A_a, G_a and e_a of a body from its Euler parameters e_a_0 to e_a_3.
Array of_orientation(const std::string& name, const Values& values) {
  const bool known = name.size() == 3 && name[1] == '_' && values.contains("e_" + name.substr(2) + "_0");
  if (!known) throw NoValue(name);
  EulerParameters<double> e;
  for (std::size_t k = 0; k < 4; ++k) e[k] = values.at("e_" + name.substr(2) + "_" + std::to_string(k));
  if (name[0] == 'e') return {4, 1, {e.begin(), e.end()}};
  if (name[0] == 'G') return {3, 4, {-e[1], e[0], -e[3], e[2], -e[2], e[3], e[0], -e[1], -e[3], -e[2], e[1], e[0]}};
  if (name[0] != 'A') throw NoValue(name);
  const auto axes = axes_of(e);
  Array A{3, 3, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) A.entries.push_back(axes[j][i]);
  }
  return A;
}

Array leaf_value(const Formula& f, const Values& values) {
  if (!f.leaf) return of_orientation(f.name, values);
  if (is_tensor(f.leaf)) return tensor(f.leaf, values);
  if (!f.leaf->vector) return scalar(evaluate(f.leaf, values));
  const std::size_t dimension = static_cast<std::size_t>(f.leaf->pool->dimension());
  return column(Numbers(values).vector(f.leaf), dimension);
}

}  // namespace

Values world_values(const Joint& joint, const Sample& sample) {
  Values values = sample.scalars;
  Numbers numbers(sample);
  const auto put = [&](Expr leaf) {
    if (!leaf->vector) values[leaf->symbol] = numbers.scalar(leaf);
    for (std::size_t k = 0; leaf->vector && k < static_cast<std::size_t>(joint.dimension); ++k) {
      values[leaf->symbol + "_" + "xyz"[k]] = numbers.vector(leaf)[k];
    }
  };
  Pool& pool = *joint.pool;
  for (int b = 0; b < static_cast<int>(joint.bodies.size()); ++b) {
    for (const Expr leaf : {body_position(pool, b), body_velocity(pool, b), body_spin(pool, b)}) put(leaf);
    if (joint.dimension == 2) put(body_angle(pool, b));
    else std::ranges::for_each(body_euler_parameters(pool, b), put);
  }
  for (const Expr leaf : sample.leaves) {
    if (leaf->vector) put(leaf);
  }
  return values;
}

Array value_of_formula(const Formula& f, const Values& values) {
  std::vector<Array> args;
  for (const Formula& arg : f.args) args.push_back(value_of_formula(arg, values));
  switch (f.shape) {
    case Shape::leaf: return leaf_value(f, values);
    case Shape::number: return scalar(f.number.value());
    case Shape::sum: {
      Array total = scalar(0);
      for (std::size_t i = 0; i < args.size(); ++i) total = added(total, args[i], f.minus[i] ? -1 : 1);
      return total;
    }
    case Shape::product: {
      Array total = scalar(1);
      for (const Array& arg : args) total = multiplied(total, arg);
      return total;
    }
    case Shape::quotient: return times(1 / args[1].entries[0], args[0]);
    case Shape::power: return scalar(std::pow(args[0].entries[0], f.exponent));
    case Shape::dot: return multiplied(transposed(args[0]), args[1]);
    case Shape::cross: return cross_product(args[0], args[1]);
    case Shape::perp:
    case Shape::skew: return skew(args[0]);
    case Shape::norm: return scalar(length(args[0]));
    case Shape::unit: return times(1 / length(args[0]), args[0]);
    case Shape::component: return scalar(args[0].entries[static_cast<std::size_t>(f.name[0] - 'x')]);
    case Shape::call: return scalar(called(f.name, args));
    case Shape::transpose: return transposed(args[0]);
    case Shape::identity:
      return values.contains("v_a_z") ? Array{3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}} : Array{2, 2, {1, 0, 0, 1}};
    case Shape::matrix: return assembled(f, args);
  }
  throw std::logic_error("unknown form");
}

std::vector<double> blocks_times(const Formula& J, const std::vector<std::vector<double>>& velocities,
                                 const Values& values) {
  std::vector<double> result;
  const std::size_t columns = static_cast<std::size_t>(J.columns);
  for (std::size_t row = 0; row * columns < J.args.size(); ++row) {
    std::vector<double> sum(1, 0.0);
    for (std::size_t k = 0; k < columns; ++k) {
      const Array block = value_of_formula(J.args[row * columns + k], values);
      if (block.entries == std::vector{0.0}) continue;
      if (block.columns != velocities.at(k).size()) throw std::logic_error("a block of J is too wide or too narrow");
      sum.resize(block.rows);
      for (std::size_t i = 0; i < block.rows; ++i) {
        for (std::size_t j = 0; j < block.columns; ++j) sum[i] += block.at(i, j) * velocities[k][j];
      }
    }
    result.insert(result.end(), sum.begin(), sum.end());
  }
  return result;
}

std::vector<Expr> leaves_shown(const Joint& joint, const Explanation& explanation) {
  std::vector<Expr> leaves;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    leaves.insert(leaves.end(), {body.v, body.w});
  }
  for (const Step& step : explanation.steps) {
    for (const Item& item : step.items) {
      collect_leaves(item.chain.left, leaves);
      for (const Link& link : item.chain.links) collect_leaves(link.formula, leaves);
    }
  }
  return leaves;
}

void collect_leaves(const Formula& f, std::vector<Expr>& leaves) {
  if (f.leaf) leaves.push_back(f.leaf);
  for (const Formula& arg : f.args) collect_leaves(arg, leaves);
}

double difference(const Array& a, const Array& b) {
  const auto is_zero = [](const Array& m) {
    return std::all_of(m.entries.begin(), m.entries.end(), [](double x) { return x == 0; });
  };
  if (is_zero(a) && is_zero(b)) return 0;
  if (a.entries.size() != b.entries.size()) return std::numeric_limits<double>::infinity();
  double largest = 1, worst = 0;
  for (std::size_t i = 0; i < a.entries.size(); ++i) {
    largest = std::max(largest, std::fabs(a.entries[i]));
    worst = std::max(worst, std::fabs(a.entries[i] - b.entries[i]));
  }
  return worst / largest;
}
