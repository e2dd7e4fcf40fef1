// Multiplying out preserves the shape of each factor, so that a reader recognises each term in Cdot.
#include "derive/explain/velocities.hpp"

#include <algorithm>
#include <utility>

#include "derive/derivation/transposition_rules.hpp"

namespace cdot::derive {
namespace {

class Distribution {
 public:
  std::vector<SignedFormula> of(const Formula& f) const {
    if (!moves(f)) return {{false, f}};
    switch (f.shape) {
      case Shape::sum: {
        std::vector<SignedFormula> all;
        for (std::size_t i = 0; i < f.args.size(); ++i) append(all, of(f.args[i]), f.minus[i]);
        return all;
      }
      case Shape::product: return through(f, [](std::vector<Formula> args) { return product(std::move(args)); });
      case Shape::quotient: return through(f, [](std::vector<Formula> args) { return quotient(args[0], args[1]); });
      // A velocity w × r is a unit of its own: only sums inside it are taken apart.
      case Shape::dot:
      case Shape::cross:
      case Shape::perp:
      case Shape::component:
        return through(f, [&f](std::vector<Formula> args) {
          Formula g = f;
          g.args = std::move(args);
          return g;
        });
      default: return {{false, f}};
    }
  }

  bool moves(const Formula& f) const {
    if (f.shape == Shape::leaf) return depends_on_velocity(f.leaf);
    for (const Formula& arg : f.args) {
      if (moves(arg)) return true;
    }
    return false;
  }

 private:
  static void append(std::vector<SignedFormula>& all, std::vector<SignedFormula> more, bool minus) {
    for (SignedFormula& term : more) {
      all.push_back({term.minus != minus, std::move(term.formula)});
    }
  }

  // The one argument that moves, taken apart; the others beside each of its terms.
  template <class Build>
  std::vector<SignedFormula> through(const Formula& f, Build build) const {
    std::vector<SignedFormula> all;
    for (std::size_t i = 0; i < f.args.size(); ++i) {
      if (!moves(f.args[i])) continue;
      for (SignedFormula& term : of(f.args[i])) {
        std::vector<Formula> args = f.args;
        args[i] = std::move(term.formula);
        for (SignedFormula& whole : terms_of(build(std::move(args)))) {
          all.push_back({whole.minus != term.minus, std::move(whole.formula)});
        }
      }
      return all;
    }
    return {{false, f}};
  }
};

bool is_turning(const Formula& f) {  // w × r
  return f.shape == Shape::cross && f.args[0].shape == Shape::leaf && f.args[0].leaf->role == Role::spin;
}

bool moves_in_space(const Formula& f) {
  if (f.shape == Shape::leaf) return f.leaf && f.leaf->pool->dimension() == 3;
  return std::any_of(f.args.begin(), f.args.end(), moves_in_space);
}

// The identity that brings the innermost product with a velocity into the form "coefficient times velocity".
std::string identity_in(const Formula& f, const Distribution& distribution) {
  for (const Formula& arg : f.args) {
    if (is_turning(f) || !distribution.moves(arg) || arg.shape == Shape::leaf) continue;
    if (std::string inner = identity_in(arg, distribution); !inner.empty()) return inner;
  }
  const bool in_space = moves_in_space(f);
  if (f.shape == Shape::dot) {
    if (is_turning(f.args[0])) return in_space ? "(w × s) · u = (s × u) · w" : "(w × s) · u = (s × u) w";
    if (is_turning(f.args[1])) return in_space ? "n · (w × r) = (r × n) · w" : "n · (w × r) = (r × n) w";
    for (const Formula& arg : f.args) {
      if (in_space && arg.shape == Shape::cross && distribution.moves(arg))
        return "a · (b × c) = b · (c × a) = c · (a × b)";
    }
  }
  if (in_space) return "";
  if (f.shape == Shape::cross && !is_turning(f)) {
    if (is_turning(f.args[0])) return "(w × s) × u = -(s · u) w";
    if (is_turning(f.args[1])) return "u × (w × r) = (u · r) w";
    return distribution.moves(f.args[1]) ? "u × v = perp(u) · v" : "v × u = -perp(u) · v";
  }
  if (f.shape == Shape::component) {
    if (is_turning(f.args[0])) return f.name == "x" ? "(w × r).x = -r.y w" : "(w × r).y = r.x w";
  }
  return "";
}

// The factors left of a velocity in a term: a number, scalars, then matrices or columns.
struct Left {
  Rational coef{1};
  std::vector<Formula> scalars, matrices;
  Expr column = {};  // the last matrix, where it is a column that a scalar multiplies

  Left times(Rational c) const {
    Left left = *this;
    left.coef = coef * c;
    return left;
  }
  Left with_scalar(Formula f) const {
    Left left = *this;
    left.scalars.push_back(std::move(f));
    return left;
  }
  Left with_matrix(Formula f, Expr as_column = {}) const {
    Left left = *this;
    left.matrices.push_back(std::move(f));
    left.column = as_column;
    return left;
  }
  bool same_but_coef(const Left& other) const { return scalars == other.scalars && matrices == other.matrices; }
  SignedFormula formula() const {
    std::vector<Formula> factors = scalars;
    if (matrices.empty()) factors.push_back(identity());
    else factors.insert(factors.end(), matrices.begin(), matrices.end());
    Formula f = product(std::move(factors));
    if (abs(coef) != Rational(1)) f = cdot::derive::times(abs(coef), std::move(f));
    return {coef.sign() < 0, std::move(f)};
  }
};

// Matrices and columns as the algebra of the rules, for a vector Cdot: written, not simplified.
class VectorIsolation {
 public:
  using Map = Left;

  VectorIsolation(const Joint& joint, const Notation& notation)
      : joint_(joint), notation_(notation), v_(joint.bodies.size()), w_(joint.bodies.size()) {}

  bool moves(Expr e) const { return depends_on_velocity(e); }
  void pass(Expr e, const Left& left) {
    if (!e->vector) return along(e, left);
    if (e->kind == Kind::symbol) return add(e->role == Role::spin ? w_ : v_, e->body, left);
    TranspositionRules(*this).of(e, left);
  }
  Left scaled(const Left& left, Rational k) const { return left.times(k); }
  Left after_factor(const Left& left, Expr s) const { return left.with_scalar(notation_.of(s)); }
  Left after_column(const Left& left, Expr u) const { return left.with_matrix(notation_.of(u), u); }
  Left after_row(const Left& left, Expr u) const {
    const Term n = split_coefficient(u);
    return left.times(n.coef).with_matrix(shaped(Shape::transpose, notation_.of(n.e)));
  }
  Left after_cross(const Left& left, Expr u) const { return left.with_matrix(shaped(Shape::skew, notation_.of(u))); }
  // u x v = S(u) v = -S(v) u
  Left before_cross(const Left& left, Expr v) const { return after_cross(left.times(-1), v); }
  Left after_perp(const Left& left) { return complete_ = false, left; }
  Left after_tensor(const Left& left, Expr) { return complete_ = false, left; }

  std::optional<std::vector<VelocityBlocks>> blocks() const {
    if (!complete_) return {};
    std::vector<VelocityBlocks> all;
    for (std::size_t b = 0; b < v_.size(); ++b) all.push_back({total(v_[b]), total(w_[b])});
    return all;
  }

 private:
  using Terms = std::vector<Left>;

  // s u with a scalar s that contains the velocities: u (n · v + c · w) = u n' v + u c' w.
  void along(Expr s, const Left& left) {
    const std::vector<JacobianEntry> J = isolate_velocities(s, joint_);
    for (std::size_t b = 0; b < J.size(); ++b) {
      const int body = static_cast<int>(b);
      const auto& [v, w] = J[b];
      if (!is_zero(v)) add(v_, body, after_row(left, v));
      if (is_zero(w)) continue;
      if (w->vector) {
        add(w_, body, after_row(left, w));
        continue;
      }
      const Term c = split_coefficient(w);
      Left column = left.times(c.coef);
      if (left.column->kind == Kind::perp) {  // w perp(r) = S(r) w
        column.matrices.back() = shaped(Shape::skew, notation_.of(left.column->args[0]));
      }
      add(w_, body, is_one(c.e) ? column : column.with_scalar(notation_.of(c.e)));
    }
  }

  static void add(std::vector<Terms>& terms, int body, const Left& left) {
    Terms& of_body = terms[static_cast<std::size_t>(body)];
    for (Left& term : of_body) {
      if (!term.same_but_coef(left)) continue;
      term.coef = term.coef + left.coef;
      return;
    }
    of_body.push_back(left);
  }

  static Formula total(const Terms& terms) {
    std::vector<SignedFormula> all;
    for (const Left& term : terms) {
      if (term.coef != Rational(0)) all.push_back(term.formula());
    }
    return sum(positive_first(std::move(all)));
  }

  const Joint& joint_;
  const Notation& notation_;
  std::vector<Terms> v_, w_;
  bool complete_ = true;
};

}  // namespace

std::vector<VelocityTerm> isolate(const Formula& Cdot, const Joint& joint) {
  Pool& pool = *joint.pool;
  const Distribution distribution;
  std::vector<VelocityTerm> terms;
  for (const SignedFormula& part : distribution.of(Cdot)) {
    VelocityTerm term{part.minus, part.formula, -1, false, {}, identity_in(part.formula, distribution)};
    const Expr value = value_of(part.formula, pool);
    const std::vector<JacobianEntry> J = isolate_velocities(part.minus ? -value : value, joint);
    for (std::size_t b = 0; b < J.size(); ++b) {
      const bool v = !is_zero(J[b].v), w = !is_zero(J[b].w);
      if (!v && !w) continue;
      term.body = static_cast<int>(b);
      term.spin = w;
      term.coefficient = w ? J[b].w : J[b].v;
    }
    if (term.body < 0) term.coefficient = pool.number(0);
    const bool constant = !distribution.moves(part.formula);
    if (constant) term.coefficient = part.minus ? -value : value;
    terms.push_back(std::move(term));
  }
  return terms;
}

std::optional<std::vector<VelocityBlocks>> isolate_vector(Expr Cdot, const Joint& joint, const Notation& notation) {
  VectorIsolation isolation(joint, notation);
  if (isolation.moves(Cdot)) isolation.pass(Cdot, {});
  return isolation.blocks();
}

Formula multiplied(Expr coefficient, int body, bool spin, const Joint& joint, const Notation& notation) {
  const BodySymbols symbols = body_symbols(joint, body);
  if (spin && !symbols.w->vector) return product({notation.of(coefficient), leaf(symbols.w)});
  // (s n) · v is written s (n · v).
  const Term term = split_coefficient(coefficient);
  const bool scaled = term.e->kind == Kind::scale && !Notation::has_name(term.e);
  const Formula factor = scaled ? notation.of(term.e->args[0]) : number(1);
  const Formula along = dot(notation.of(scaled ? term.e->args[1] : term.e), leaf(spin ? symbols.w : symbols.v));
  const Formula f = product({number(abs(term.coef)), factor, along});
  return term.coef.sign() < 0 ? negative(f) : f;
}

}  // namespace cdot::derive
