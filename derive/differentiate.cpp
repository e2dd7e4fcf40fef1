// C to Cdot, Cdot to J, J to K: the derivation, on vectors and by the rules of the textbook.
//
// J is read off Cdot by transposition. A term n . (w x r) says how w enters; its transpose (r x n) w says what w is
// multiplied by. Each rule below is such an identity, so "isolating the velocities" is a walk from Cdot to the leaves.
#include <cassert>
#include <map>

#include "derive/derivation.hpp"
#include "derive/symbols.hpp"

namespace cdot::derive {
namespace {

// e, a product, with its i-th factor taken out once; also where e has a name, which plain division does not look into.
Expr without_factor(Expr e, std::size_t i) {
  std::vector<int> exponents = e->exponents;
  --exponents[i];
  return product(*e->pool, e->args, exponents);
}

class TimeDerivative {
 public:
  TimeDerivative(const Joint& joint, int immovable, Expr only)
      : joint_(joint), immovable_(immovable), only_(only) {}

  Expr of(Expr e) {
    if (const auto found = done_.find(&*e); found != done_.end()) return found->second;
    const Expr result = e->vector ? vector_rule(e) : scalar_rule(e);
    if (!e->name.empty() && !only_) e->pool->name(result, e->name + "_dot", false);
    done_.emplace(&*e, result);
    return result;
  }

 private:
  bool moves(Expr leaf) const {
    return leaf->body >= 0 && leaf->body != immovable_ && (!only_ || only_ == leaf);
  }

  Expr vector_rule(Expr e) {
    Pool& pool = *e->pool;
    switch (e->kind) {
      case Kind::symbol:
        if (!moves(e)) return zero_vector(pool);
        if (e->role == Role::position) return body_symbols(joint_, e->body).v;
        // ds/dt = w x s for a vector fixed in a body.
        if (e->role == Role::body_vector) return cross(body_symbols(joint_, e->body).w, e);
        return zero_vector(pool);
      case Kind::sum: return sum_rule(e);
      // d(s u)/dt = sdot u + s udot
      case Kind::scale: return of(e->args[0]) * e->args[1] + e->args[0] * of(e->args[1]);
      case Kind::perp: return perp(of(e->args[0]));
      case Kind::cross: return cross(of(e->args[0]), e->args[1]) + cross(e->args[0], of(e->args[1]));
      case Kind::unit: return unit_rule(e);
      default: break;
    }
    assert(false && "not a vector");
    return e;
  }

  Expr scalar_rule(Expr e) {
    Pool& pool = *e->pool;
    switch (e->kind) {
      case Kind::number: return pool.number(0);
      case Kind::symbol:
        if (e->role == Role::angle && moves(e)) return body_symbols(joint_, e->body).w;
        return pool.number(e->role == Role::time && !only_ ? 1 : 0);
      case Kind::sum: return sum_rule(e);
      case Kind::product: return product_rule(e);
      // d(u . v)/dt = udot . v + u . vdot, and the same for u x v
      case Kind::dot: return dot(of(e->args[0]), e->args[1]) + dot(e->args[0], of(e->args[1]));
      case Kind::cross: return cross(of(e->args[0]), e->args[1]) + cross(e->args[0], of(e->args[1]));
      // d|u|/dt = n . udot
      case Kind::norm: return dot(unit(e->args[0]), of(e->args[0]));
      case Kind::twist: return twist_rule(e);
      case Kind::function: return chain_rule(e);
      default: break;
    }
    assert(false && "not a scalar");
    return e;
  }

  Expr sum_rule(Expr e) {
    std::vector<Term> terms;
    for (std::size_t i = 0; i < e->args.size(); ++i) terms.push_back({e->coefs[i], of(e->args[i])});
    return sum(*e->pool, terms, e->vector);
  }

  // d(x^k y ...)/dt = k x^(k-1) xdot y ... + ...
  Expr product_rule(Expr e) {
    Expr total = e->pool->number(0);
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      const Expr rate = of(e->args[i]);
      if (is_zero(rate)) continue;
      total = total + Rational(e->exponents[i]) * (without_factor(e, i) * rate);
    }
    return total;
  }

  // Only the part of udot across n = u/|u| turns it: (n x udot)/|u| perp(n) in the plane, in space
  // (udot - (n . udot) n)/|u|.
  Expr unit_rule(Expr e) {
    const Expr rate = of(e->args[0]), length = norm(e->args[0]);
    if (e->pool->dimension() == 2) return cross(e, rate) / length * perp(e);
    return (rate - dot(e, rate) * e) / length;
  }

  // The twist of g against f grows at (f_x + g_x) . (w_g - w_f) / (1 + f_x . g_x): the rate about the axis halfway
  // between the two x axes.
  Expr twist_rule(Expr e) {
    const Expr f = e->args[0], g = e->args[3];
    const Expr relative = spin_of(g) - spin_of(f);
    return dot(f + g, relative) / (e->pool->number(1) + dot(f, g));
  }

  // The angular velocity of what a triad is fixed in.
  Expr spin_of(Expr axis) {
    return moves(axis) ? body_symbols(joint_, axis->body).w : zero_vector(*axis->pool);
  }

  Expr chain_rule(Expr e) {
    const Expr a = e->args[0], rate = of(a);
    switch (e->fn) {
      case Fn::sqrt: return Rational(1, 2) * (rate / e);
      case Fn::sin: return call(Fn::cos, a) * rate;
      case Fn::cos: return -(call(Fn::sin, a) * rate);
      case Fn::tan: return (e->pool->number(1) + pow(e, 2)) * rate;
      case Fn::exp: return e * rate;
      case Fn::log: return rate / a;
      case Fn::abs: return call(Fn::sign, a) * rate;
      case Fn::sign: return e->pool->number(0);
      case Fn::atan2: return atan2_rule(e);
      case Fn::inverse:
      case Fn::select:
      case Fn::pivot: break;  // arise only after differentiation
    }
    assert(false && "no derivative");
    return e;
  }

  Expr atan2_rule(Expr e) {
    const Expr y = e->args[0], x = e->args[1];
    const Term cross_part = split_coefficient(y), dot_part = split_coefficient(x);
    const bool angle_between = cross_part.e->kind == Kind::cross && dot_part.e->kind == Kind::dot &&
                               cross_part.e->args == dot_part.e->args &&
                               abs(cross_part.coef) == Rational(1) && dot_part.coef == Rational(1);
    if (angle_between) {
      // The angle from u to v grows as v turns and falls as u turns; a vector turns at (u x udot)/(u . u).
      const Expr u = cross_part.e->args[0], v = cross_part.e->args[1];
      return cross_part.coef * (turning(v) - turning(u));
    }
    // d atan2(y, x)/dt = (x ydot - y xdot)/(x^2 + y^2)
    return (x * of(y) - y * of(x)) / (pow(x, 2) + pow(y, 2));
  }

  Expr turning(Expr u) { return cross(u, of(u)) / dot(u, u); }

  const Joint& joint_;
  int immovable_;
  Expr only_;
  std::map<const Node*, Expr> done_;
};

// Walks from an expression that is linear in the velocities to v and w, carrying what each node is multiplied by.
class Transposition {
 public:
  explicit Transposition(Expr root) : order_(topological(std::span(&root, 1))) {
    for (const Expr e : order_) {
      bool moving = e->kind == Kind::symbol && (e->role == Role::velocity || e->role == Role::spin);
      for (const Expr arg : e->args) moving = moving || moving_.at(&*arg);
      moving_.emplace(&*e, moving);
    }
    factor_.emplace(&*root, root->pool->number(1));
    for (auto e = order_.rbegin(); e != order_.rend(); ++e) {
      const auto found = factor_.find(&**e);
      if (found != factor_.end() && moving_.at(&**e)) pass_on(*e, found->second);
    }
  }

  Expr coefficient(Expr velocity) const {
    const auto found = factor_.find(&*velocity);
    if (found != factor_.end()) return found->second;
    return velocity->vector ? zero_vector(*velocity->pool) : velocity->pool->number(0);
  }

 private:
  bool moving(Expr e) const { return moving_.at(&*e); }

  void add(Expr e, Expr factor) {
    if (!moving(e)) return;
    const auto [at, fresh] = factor_.emplace(&*e, factor);
    if (!fresh) at->second = at->second + factor;
  }

  void pass_on(Expr e, Expr c) {
    switch (e->kind) {
      case Kind::symbol: return;
      case Kind::sum:
        for (std::size_t i = 0; i < e->args.size(); ++i) add(e->args[i], e->coefs[i] * c);
        return;
      case Kind::product: return pass_on_product(e, c);
      case Kind::scale:  // c . (s u) = (c . u) s
        require(!(moving(e->args[0]) && moving(e->args[1])));
        add(e->args[0], dot(c, e->args[1]));
        add(e->args[1], e->args[0] * c);
        return;
      case Kind::dot:
        require(!(moving(e->args[0]) && moving(e->args[1])));
        add(e->args[0], c * e->args[1]);
        add(e->args[1], c * e->args[0]);
        return;
      case Kind::cross:
        require(!(moving(e->args[0]) && moving(e->args[1])));
        return pass_on_cross(e, c);
      case Kind::tensor:  // c . (T u) = (T c) . u
        return add(e->args[1], apply(e->args[0], c));
      case Kind::perp:  // c . perp(u) = -perp(c) . u
        return add(e->args[0], -perp(c));
      default: require(false);
    }
  }

  void pass_on_cross(Expr e, Expr c) {
    const Expr u = e->args[0], v = e->args[1];
    if (e->vector) {  // c . (u x v) = u . (v x c) = v . (c x u)
      if (moving(u)) add(u, cross(v, c));
      if (moving(v)) add(v, cross(c, u));
    } else {  // u x v = u . (-perp v) = perp(u) . v
      if (moving(u)) add(u, -(c * perp(v)));
      if (moving(v)) add(v, c * perp(u));
    }
  }

  void pass_on_product(Expr e, Expr c) {
    int found = 0;
    for (std::size_t i = 0; i < e->args.size(); ++i) {
      if (!moving(e->args[i])) continue;
      require(++found == 1 && e->exponents[i] == 1);
      add(e->args[i], c * without_factor(e, i));
    }
  }

  static void require(bool linear) {
    if (!linear) throw NotLinear("the row is not linear in the velocities");
  }

  std::vector<Expr> order_;
  std::map<const Node*, bool> moving_;
  std::map<const Node*, Expr> factor_;
};

// A term coef * rest * op(u, v), op being dot or cross.
struct PairTerm {
  Rational coef;
  Expr rest;  // scalar
  Kind kind = Kind::number;
  Expr u, v;
};

PairTerm pair_term(const Term& term) {
  PairTerm out{term.coef, term.e, Kind::number, {}, {}};
  std::vector<Expr> factors{term.e};
  if (term.e->kind == Kind::product && term.e->name.empty()) factors = term.e->args;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const Expr f = factors[i];
    if (f->kind != Kind::dot && f->kind != Kind::cross) continue;
    if (factors.size() > 1 && term.e->exponents[i] != 1) continue;
    return {term.coef, term.e / f, f->kind, f->args[0], f->args[1]};
  }
  return out;
}

// r1 x t + r2 x t = (r1 + r2) x t: two products fewer, and the form that people write. Likewise for dot.
bool merge_pair(std::vector<Term>& terms) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const PairTerm a = pair_term(terms[i]);
    if (a.kind == Kind::number) continue;
    for (std::size_t j = i + 1; j < terms.size(); ++j) {
      const PairTerm b = pair_term(terms[j]);
      if (b.kind != a.kind || b.rest != a.rest || abs(b.coef) != abs(a.coef)) continue;
      const Rational swap = a.kind == Kind::cross ? Rational(-1) : Rational(1);
      const Rational sign = b.coef / a.coef;
      Expr left, right;
      if (a.v == b.v) left = a.u + sign * b.u, right = a.v;
      else if (a.u == b.u) left = a.u, right = a.v + sign * b.v;
      else if (a.v == b.u) left = a.u + (sign * swap) * b.v, right = a.v;
      else if (a.u == b.v) left = a.u, right = a.v + (sign * swap) * b.u;
      else continue;
      const Expr merged = a.rest * (a.kind == Kind::cross ? cross(left, right) : dot(left, right));
      terms[i] = {a.coef, merged};
      terms.erase(terms.begin() + static_cast<std::ptrdiff_t>(j));
      return true;
    }
  }
  return false;
}

// d(J^T lambda)/dq: each component of the generalised force, differentiated along the motion at fixed time and
// lambda; what multiplies each component of v and w of a body is its column.
std::vector<std::vector<Expr>> geometric_stiffness(const Joint& joint, Block& block) {
  Pool& pool = *joint.pool;
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    block.lambda.push_back(pool.symbol("lambda_" + std::to_string(i + 1), Role::multiplier));
  }
  std::vector<std::vector<Expr>> H;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    JacobianEntry force{zero_vector(pool), zero_spin(pool)};
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      force.v = force.v + block.lambda[i] * block.rows[i].J[b].v;
      force.w = force.w + block.lambda[i] * block.rows[i].J[b].w;
    }
    for (const Expr component : columns_of(force)) {
      const Expr rate = time_derivative(component, joint, block.immovable);
      H.push_back(columns_of(isolate_velocities(rate, joint)));
    }
  }
  return H;
}

ScalarRow derive_row(const Joint& joint, ScalarRow row, Expr expression, int immovable) {
  Pool& pool = *joint.pool;
  const bool at_velocity_level = row.kind == RowKind::velocity;
  row.C = at_velocity_level ? pool.number(0) : expression;
  row.Cdot = at_velocity_level ? expression : time_derivative(expression, joint, immovable);
  std::map<const Node*, Expr> at_rest;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    at_rest.emplace(&*body.v, zero_vector(pool));
    at_rest.emplace(&*body.w, zero_spin(pool));
  }
  if (at_velocity_level && immovable >= 0) {
    const BodySymbols body = body_symbols(joint, immovable);
    row.Cdot = substitute(row.Cdot, {{&*body.v, zero_vector(pool)}, {&*body.w, zero_spin(pool)}},
                          KeepNames::no);
  }
  row.C_t = substitute(row.Cdot, at_rest, KeepNames::no);
  row.J = isolate_velocities(row.Cdot, joint);
  row.gamma = -time_derivative(row.Cdot, joint, immovable);
  return row;
}

Block finished(const Joint& joint, Block block) {
  block.K = effective_mass(joint, block.rows, block.immovable);
  block.stiffness = geometric_stiffness(joint, block);
  return block;
}

}  // namespace

BodySymbols body_symbols(const Joint& joint, int body) {
  Pool& pool = *joint.pool;
  return {body_position(pool, body), pool.dimension() == 2 ? body_angle(pool, body) : Expr(),
          body_velocity(pool, body), body_spin(pool, body),
          inverse_mass(pool, body),  inverse_inertia(pool, body)};
}

Expr zero_spin(Pool& pool) { return pool.dimension() == 2 ? pool.number(0) : zero_vector(pool); }

std::vector<Expr> columns_of(const JacobianEntry& entry) {
  std::vector<Expr> columns = components_of(entry.v), w = components_of(entry.w);
  columns.insert(columns.end(), w.begin(), w.end());
  return columns;
}

std::vector<Expr> columns_of(const std::vector<JacobianEntry>& J) {
  std::vector<Expr> columns;
  for (const JacobianEntry& entry : J) {
    const std::vector<Expr> part = columns_of(entry);
    columns.insert(columns.end(), part.begin(), part.end());
  }
  return columns;
}

Expr time_derivative(Expr e, const Joint& joint, int immovable, Expr only) {
  return TimeDerivative(joint, immovable, only).of(e);
}

Expr collected(Expr e) {
  if (e->kind != Kind::sum || !e->name.empty()) return e;
  std::vector<Term> terms = terms_of(e);
  while (merge_pair(terms)) {
  }
  return sum(*e->pool, terms, e->vector);
}

// Entry by entry the sum over the bodies of v_i . v_j / m + w_i . I^-1 w_j.
std::vector<std::vector<Expr>> effective_mass(const Joint& joint, const std::vector<ScalarRow>& rows,
                                              int immovable, bool isotropic) {
  std::vector<std::vector<Expr>> K(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Expr entry = joint.pool->number(0);
      for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
        if (static_cast<int>(b) == immovable) continue;
        const BodySymbols body = body_symbols(joint, static_cast<int>(b));
        const JacobianEntry& Ji = rows[i].J[b];
        const JacobianEntry& Jj = rows[j].J[b];
        const bool tensor = Ji.w->vector && !isotropic;
        const Expr turning = tensor         ? dot(Ji.w, apply(body.inv_I, Jj.w))
                             : Ji.w->vector ? body.inv_I * dot(Ji.w, Jj.w)
                                            : body.inv_I * (Ji.w * Jj.w);
        entry = entry + body.inv_m * dot(Ji.v, Jj.v) + turning;
      }
      K[i].push_back(entry);
    }
  }
  return K;
}

std::vector<JacobianEntry> isolate_velocities(Expr Cdot, const Joint& joint) {
  const Transposition transposed(Cdot);
  std::vector<JacobianEntry> J;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    J.push_back({transposed.coefficient(body.v), collected(transposed.coefficient(body.w))});
  }
  return J;
}

Block derive_rows(const Joint& joint, int immovable) {
  Block block;
  block.immovable = immovable;
  const std::vector<Expr> axes = world_axes(*joint.pool);
  for (const Row& row : joint.rows) {
    if (!row.C->vector) {
      block.rows.push_back(derive_row(joint, {row.name, &row, row.kind, -1, {}, {}, {}, {}, {}},
                                      row.C, immovable));
      continue;
    }
    for (std::size_t k = 0; k < axes.size(); ++k) {
      ScalarRow part{row.name + "_" + "xyz"[k], &row, row.kind, static_cast<int>(k), {}, {}, {}, {}, {}};
      block.rows.push_back(derive_row(joint, std::move(part), dot(axes[k], row.C), immovable));
    }
  }
  return finished(joint, std::move(block));
}

Block derive_coordinate(const Joint& joint, const Coordinate& coordinate, int immovable) {
  Block block;
  block.name = coordinate.name;
  block.immovable = immovable;
  ScalarRow row{coordinate.name, nullptr, RowKind::equality, -1, {}, {}, {}, {}, {}};
  block.rows.push_back(derive_row(joint, std::move(row), coordinate.value, immovable));
  return finished(joint, std::move(block));
}

}  // namespace cdot::derive
