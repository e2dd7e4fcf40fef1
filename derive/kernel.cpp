// From a derivation to the functions of the kernel contract, as programs.
#include "derive/kernel.hpp"

#include <algorithm>
#include <set>

#include "derive/canonical.hpp"

namespace cdot::derive {
namespace {

// A number of J as coef * product of fields.
struct StoredEntry {
  Rational coef;
  std::vector<int> fields;
};

class BlockPlanner {
 public:
  BlockPlanner(const Joint& joint, Block block, std::string name)
      : joint_(joint), pool_(*joint.pool), pose_(joint) {
    out_.name = std::move(name);
    out_.block = std::move(block);
  }

  KernelBlock plan() {
    store_jacobian();
    add_position_and_jacobian();
    add_effective_mass();
    add_factor_and_solve();
    add_velocity();
    add_apply();
    add_dense();
    add_from_pose();
    return std::move(out_);
  }

 private:
  std::size_t rows() const { return out_.block.rows.size(); }
  std::size_t bodies() const { return joint_.bodies.size(); }
  static std::string at(const std::string& array, std::size_t i) {
    return array + "[" + std::to_string(i) + "]";
  }
  static std::string triangle(const std::string& array, std::size_t i, std::size_t j) {
    return at(array, i * (i + 1) / 2 + j);
  }

  void add(std::string name, std::string summary, const std::vector<NamedExpr>& outputs) {
    out_.functions.push_back({std::move(name), std::move(summary), simplify(assemble(outputs))});
  }

  // Which numbers Jacobian<T> holds: the factors of J's entries that are neither zero nor one.
  void store_jacobian() {
    Components components;
    const Expr ex = world_x(pool_);
    for (std::size_t i = 0; i < rows(); ++i) {
      std::vector<StoredEntry> row;
      for (std::size_t b = 0; b < bodies(); ++b) {
        const JacobianEntry& J = out_.block.rows[i].J[b];
        const std::string suffix = joint_.bodies[b] + (rows() > 1 ? "_" + std::to_string(i + 1) : "");
        row.push_back(store(components.of(dot(ex, J.v)), "v" + suffix + "_x"));
        row.push_back(store(components.of(dot(perp(ex), J.v)), "v" + suffix + "_y"));
        row.push_back(store(components.of(J.w), "w" + suffix));
      }
      J_.push_back(std::move(row));
    }
  }

  StoredEntry store(Expr entry, const std::string& column) {
    const Term term = split_coefficient(entry);
    if (is_one(term.e)) return {term.coef, {}};
    StoredEntry stored{term.coef, {}};
    const bool plain_factors =
        term.e->kind == Kind::product && term.e->name.empty() &&
        std::all_of(term.e->args.begin(), term.e->args.end(), [](Expr f) { return simple(f); }) &&
        std::all_of(term.e->exponents.begin(), term.e->exponents.end(), [](int k) { return k == 1; });
    if (!plain_factors) {
      stored.fields.push_back(field(term.e, column));
      return stored;
    }
    for (const Expr factor : term.e->args) stored.fields.push_back(field(factor, column));
    return stored;
  }

  static bool simple(Expr e) { return e->kind == Kind::symbol || !e->name.empty(); }

  int field(Expr e, const std::string& column) {
    for (std::size_t i = 0; i < out_.fields.size(); ++i) {
      if (out_.fields[i].value == e) return static_cast<int>(i);
    }
    std::string name = !e->name.empty() ? e->name : e->kind == Kind::symbol ? e->symbol : column;
    const auto taken = [&](const Field& f) { return f.name == name; };
    while (std::any_of(out_.fields.begin(), out_.fields.end(), taken)) name += "_";
    out_.fields.push_back({name, e, pool_.symbol("J." + name, Role::given)});
    return static_cast<int>(out_.fields.size()) - 1;
  }

  // J's entry in terms of the stored fields.
  Expr stored(std::size_t row, std::size_t column) const {
    const StoredEntry& entry = J_[row][column];
    Expr e = pool_.number(entry.coef);
    for (const int f : entry.fields) e = e * out_.fields[static_cast<std::size_t>(f)].symbol;
    return e;
  }

  void add_position_and_jacobian() {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < rows(); ++i) {
      outputs.push_back({at("C", i), pose_.of(out_.block.rows[i].C)});
    }
    add("position", "C", outputs);
    for (const Field& f : out_.fields) outputs.push_back({"J." + f.name, pose_.of(f.value)});
    add("jacobian", "C and J", outputs);
  }

  // K in the form that the derivation simplified it to, reading what J has stored. If that form needs something that
  // J does not hold, the plain sum over J's entries is used.
  void add_effective_mass() {
    Components components;
    std::map<const Node*, Expr> held;
    for (const Field& f : out_.fields) held.emplace(&*f.value, f.symbol);
    std::vector<NamedExpr> simplified, plain;
    bool complete = true;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const Expr K = substitute(components.of(out_.block.K[i][j]), held);
        for (const Expr e : topological(std::span(&K, 1))) {
          complete = complete && (e->kind != Kind::symbol || e->role == Role::given ||
                                  e->role == Role::inverse_mass || e->role == Role::inverse_inertia ||
                                  e->role == Role::constant);
        }
        simplified.push_back({triangle("K", i, j), K});
        plain.push_back({triangle("K", i, j), plain_effective_mass(i, j)});
      }
    }
    const std::string summary = "K = J M^-1 J^T, lower triangle, from J";
    add("effective_mass", summary, plain);
    if (!complete) return;
    Program shorter = simplify(assemble(simplified));
    Program& kept = out_.functions.back().program;
    if (count(shorter).total() <= count(kept).total()) kept = std::move(shorter);
  }

  Expr plain_effective_mass(std::size_t i, std::size_t j) const {
    Expr K = pool_.number(0);
    for (std::size_t b = 0; b < bodies(); ++b) {
      if (static_cast<int>(b) == out_.block.immovable) continue;
      const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
      const Expr linear = stored(i, 3 * b) * stored(j, 3 * b) + stored(i, 3 * b + 1) * stored(j, 3 * b + 1);
      K = K + body.inv_m * linear + body.inv_I * (stored(i, 3 * b + 2) * stored(j, 3 * b + 2));
    }
    return K;
  }

  // K = L D L^T column by column; what is zero in K for every pose stays zero and is not computed.
  void add_factor_and_solve() {
    const std::size_t n = rows();
    std::vector<std::vector<Expr>> L(n, std::vector<Expr>(n)), K(n, std::vector<Expr>(n));
    std::vector<Expr> D(n), D_inverse(n);
    std::vector<NamedExpr> factor;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        K[i][j] = is_zero(out_.block.K[i][j]) ? pool_.number(0)
                                              : pool_.symbol(triangle("K", i, j), Role::given);
        Expr e = K[i][j];
        for (std::size_t k = 0; k < j; ++k) e = e - L[i][k] * L[j][k] * D[k];
        if (i == j) {
          D[i] = opaque(e, "D" + std::to_string(i + 1));
          const Expr pivot[] = {D[i], K[i][i]};
          D_inverse[i] = opaque(call(Fn::pivot, pivot), "inv_D" + std::to_string(i + 1));
        } else {
          L[i][j] = opaque(e * D_inverse[j], "L" + std::to_string(i + 1) + std::to_string(j + 1));
        }
        factor.push_back({triangle("F", i, j), i == j ? D_inverse[i] : L[i][j]});
      }
    }
    add("factor", "K = L D L^T; F holds L and, on the diagonal, D^-1", factor);
    add_solve();
  }

  Expr opaque(Expr e, const std::string& name) {
    pool_.name(e, name, false);
    return e;
  }

  void add_solve() {
    const std::size_t n = rows();
    const auto L = [&](std::size_t i, std::size_t j) {
      return is_zero_in_factor(i, j) ? pool_.number(0)
                                     : pool_.symbol(triangle("F", i, j), Role::given);
    };
    std::vector<Expr> y(n), x(n);
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = pool_.symbol(at("rhs", i), Role::given);
      for (std::size_t k = 0; k < i; ++k) y[i] = y[i] - L(i, k) * y[k];
      y[i] = opaque(y[i], "y" + std::to_string(i + 1));
    }
    for (std::size_t i = n; i-- > 0;) {
      x[i] = L(i, i) * y[i];
      for (std::size_t k = i + 1; k < n; ++k) x[i] = x[i] - L(k, i) * x[k];
      x[i] = opaque(x[i], "x" + std::to_string(i + 1));
    }
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < n; ++i) outputs.push_back({at("lambda", i), x[i]});
    add("solve", "lambda = K^-1 rhs", outputs);
  }

  // L's entry vanishes for every pose if K's does and no fill arises.
  bool is_zero_in_factor(std::size_t i, std::size_t j) const {
    if (!is_zero(out_.block.K[i][j])) return false;
    for (std::size_t k = 0; k < j; ++k) {
      if (!is_zero_in_factor(i, k) && !is_zero_in_factor(j, k)) return false;
    }
    return true;
  }

  std::vector<Expr> velocity_components(std::size_t b) const {
    const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
    Components components;
    const auto v = components.of_vector(body.v);
    return {v[0], v[1], body.w};
  }

  void add_velocity() {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < rows(); ++i) {
      Expr Jv = pool_.number(0);
      for (std::size_t b = 0; b < bodies(); ++b) {
        const std::vector<Expr> v = velocity_components(b);
        for (std::size_t k = 0; k < 3; ++k) Jv = Jv + stored(i, 3 * b + k) * v[k];
      }
      outputs.push_back({at("Jv", i), Jv});
    }
    add("velocity", "J v", outputs);
  }

  // One number of M^-1: 1/m for the columns x and y of a body, 1/I for its w.
  Expr inverse_mass(std::size_t column) const {
    const BodySymbols body = body_symbols(joint_, static_cast<int>(column / 3));
    return column % 3 == 2 ? body.inv_I : body.inv_m;
  }

  void add_apply() {
    static const char* const axis[] = {"x", "y", "w"};
    std::vector<NamedExpr> outputs;
    for (std::size_t c = 0; c < 3 * bodies(); ++c) {
      Expr force = pool_.number(0);
      for (std::size_t i = 0; i < rows(); ++i) {
        force = force + stored(i, c) * pool_.symbol("lambda_" + std::to_string(i + 1), Role::multiplier);
      }
      if (is_zero(force)) continue;
      outputs.push_back({at("v", c / 3) + "." + axis[c % 3],
                         velocity_components(c / 3)[c % 3] + inverse_mass(c) * force});
    }
    add("apply", "v += M^-1 J^T lambda", outputs);
  }

  void add_dense() {
    std::vector<NamedExpr> J, weighted;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t c = 0; c < 3 * bodies(); ++c) {
        const std::string cell = at(at("D", i), c);
        J.push_back({cell, stored(i, c)});
        weighted.push_back({cell, inverse_mass(c) * stored(i, c)});
      }
    }
    add("dense", "J with its zeros: v_x, v_y, w of each body", J);
    add("inverse_mass_jacobian", "(M^-1 J^T)^T, laid out like dense", weighted);
  }

  void add_from_pose() {
    std::vector<NamedExpr> gamma, C_t, H;
    for (std::size_t i = 0; i < rows(); ++i) {
      gamma.push_back({at("g", i), pose_.of(out_.block.rows[i].gamma)});
      C_t.push_back({at("C_t", i), pose_.of(out_.block.rows[i].C_t)});
    }
    for (std::size_t r = 0; r < out_.block.stiffness.size(); ++r) {
      for (std::size_t c = 0; c < out_.block.stiffness[r].size(); ++c) {
        H.push_back({at(at("H", r), c), pose_.of(out_.block.stiffness[r][c])});
      }
    }
    add("gamma", "-Jdot v - d/dt(dC/dt)", gamma);
    add("time_derivative", "dC/dt at fixed q", C_t);
    add("stiffness", "d(J^T lambda)/dq: x, y, angle of each body", H);
  }

  const Joint& joint_;
  Pool& pool_;
  PoseInputs pose_;
  KernelBlock out_;
  std::vector<std::vector<StoredEntry>> J_;
};

bool some_row_vanishes(const Block& block) {
  return std::any_of(block.rows.begin(), block.rows.end(), [](const ScalarRow& row) {
    return std::all_of(row.J.begin(), row.J.end(),
                       [](const JacobianEntry& e) { return is_zero(e.v) && is_zero(e.w); });
  });
}

template <class Derive>
KernelBlock plan_block(const Joint& joint, std::string name, Derive derive) {
  KernelBlock out = BlockPlanner(joint, derive(-1), std::move(name)).plan();
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    Block variant = derive(static_cast<int>(b));
    if (some_row_vanishes(variant)) continue;
    out.variants.push_back(
        BlockPlanner(joint, std::move(variant), joint.bodies[b] + "_immovable").plan());
  }
  return out;
}

// The default of a parameter in the frame that it is fixed in: R^T (p - x) for a point, R^T u for a vector.
DefaultValue plan_default(const Joint& joint, int index) {
  const Parameter& parameter = joint.parameters[static_cast<std::size_t>(index)];
  PoseInputs pose(joint);
  Pool& pool = *joint.pool;
  std::vector<NamedExpr> outputs;
  const auto output = [&](int axis, Expr e) {
    outputs.push_back({"p." + field_name(parameter, axis), pose.of(e)});
  };
  if (size_of(parameter) == 1) {
    output(-1, parameter.default_value);
    return {index, simplify(assemble(outputs))};
  }
  Expr value = parameter.default_value, axis = world_x(pool);
  if (parameter.body >= 0) {
    const std::string& body = joint.bodies[static_cast<std::size_t>(parameter.body)];
    if (parameter.kind == ParameterKind::point) value = value - body_symbols(joint, parameter.body).x;
    axis = pool.vector_symbol("axis_" + body, Role::body_vector, parameter.body, true);
  }
  output(0, dot(axis, value));
  output(1, dot(perp(axis), value));
  return {index, simplify(assemble(outputs))};
}

}  // namespace

int size_of(const Parameter& parameter) { return parameter.kind == ParameterKind::scalar ? 1 : 2; }

std::string field_name(const Parameter& parameter, int axis) {
  return parameter.name + (axis < 0 ? "" : axis == 0 ? "_x" : "_y");
}

Expr local_symbol(const Joint& joint, const Parameter& parameter, int axis) {
  Pool& pool = *joint.pool;
  if (parameter.kind == ParameterKind::scalar) return parameter.symbol;
  return pool.symbol("p." + field_name(parameter, axis), Role::parameter);
}

PoseInputs::PoseInputs(const Joint& joint) {
  Pool& pool = *joint.pool;
  Components components;
  const auto cosine = [&](int body) {
    return pool.symbol(joint.bodies[static_cast<std::size_t>(body)] + ".c", Role::given, body);
  };
  const auto sine = [&](int body) {
    return pool.symbol(joint.bodies[static_cast<std::size_t>(body)] + ".s", Role::given, body);
  };
  for (const Parameter& parameter : joint.parameters) {
    if (parameter.kind == ParameterKind::scalar || !parameter.symbol) continue;
    const auto world = components.of_vector(parameter.symbol);
    Expr x = local_symbol(joint, parameter, 0), y = local_symbol(joint, parameter, 1);
    if (parameter.body >= 0) {
      // r = R l
      const Expr c = cosine(parameter.body), s = sine(parameter.body);
      const Expr local_x = x, local_y = y;
      x = c * local_x - s * local_y;
      y = s * local_x + c * local_y;
      pool.name(x, world[0]->symbol, true);
      pool.name(y, world[1]->symbol, true);
    }
    rotated_.emplace(&*world[0], x);
    rotated_.emplace(&*world[1], y);
  }
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const int body = static_cast<int>(b);
    const auto axis = components.of_vector(
        pool.vector_symbol("axis_" + joint.bodies[b], Role::body_vector, body, true));
    rotated_.emplace(&*axis[0], cosine(body));
    rotated_.emplace(&*axis[1], sine(body));
  }
}

Expr PoseInputs::of(Expr scalar) {
  Components components;
  return substitute(components.of(scalar), rotated_);
}

Kernel plan_kernel(const Joint& joint) {
  Kernel kernel;
  kernel.joint = &joint;
  kernel.rows = plan_block(joint, joint.name, [&](int immovable) { return derive_rows(joint, immovable); });
  for (const Coordinate& coordinate : joint.coordinates) {
    kernel.coordinates.push_back(plan_block(joint, coordinate.name, [&](int immovable) {
      return derive_coordinate(joint, coordinate, immovable);
    }));
  }
  for (std::size_t i = 0; i < joint.parameters.size(); ++i) {
    if (joint.parameters[i].default_value) {
      kernel.defaults.push_back(plan_default(joint, static_cast<int>(i)));
    }
  }
  return kernel;
}

}  // namespace cdot::derive
