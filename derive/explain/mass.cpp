// K = J M^-1 J', first as the product that it is, then simplified.
#include <algorithm>
#include <utility>

#include "derive/explain/lecture.hpp"

namespace cdot::derive {
namespace {

Formula name_of_K(const Part& part, const std::string& row, const std::string& column) {
  const bool coordinate = part.statements[0].row == nullptr;
  if (coordinate) return leaf({}, "K_" + part.statements[0].name);
  return leaf({}, row.empty() ? "K" : "K[" + row + ", " + column + "]");
}

struct Factors {
  Rational coef;
  Expr i, j;
};

Factors factors(Expr i, Expr j) {
  const Term a = split_coefficient(i), b = split_coefficient(j);
  return {a.coef * b.coef, a.e, b.e};
}

// inv_m_a (t · t): the form before any identity of t is used.
void add_scalar_product(const Notation& notation, Expr inverse_mass, Expr vi, Expr vj,
                        std::vector<SignedFormula>& terms) {
  if (is_zero(vi) || is_zero(vj)) return;
  const Factors f = factors(vi, vj);
  const Formula written = dot(notation.of(f.i), notation.of(f.j));
  terms.push_back({f.coef.sign() < 0, product({number(abs(f.coef)), leaf(inverse_mass), written})});
}

// A number: the scalars that stand before e, which is what is left of it.
struct Scaled {
  Formula scalars;
  Expr e;
};
Scaled without_scalars(const Notation& notation, Expr e) {
  const bool scaled = e->kind == Kind::scale && !Notation::has_name(e);
  return scaled ? Scaled{notation.of(e->args[0]), e->args[1]} : Scaled{number(1), e};
}

// inv_I_a (ra × t)^2 in the plane; in space, where the inertia is a tensor, (ra × t)' inv_I_a (ra × t).
void add_product(const Notation& notation, Expr inverse, Expr wi, Expr wj, std::vector<SignedFormula>& terms) {
  if (is_zero(wi) || is_zero(wj)) return;
  const Factors f = factors(wi, wj);
  std::vector<Formula> parts{number(abs(f.coef))};
  if (wi->vector) {
    const Scaled i = without_scalars(notation, f.i), j = without_scalars(notation, f.j);
    if (i.scalars == j.scalars) parts.push_back(power(i.scalars, 2));
    else parts.insert(parts.end(), {i.scalars, j.scalars});
    parts.insert(parts.end(), {shaped(Shape::transpose, notation.of(i.e)), leaf(inverse), notation.of(j.e)});
  } else {
    const Formula a = notation.of(f.i), b = notation.of(f.j);
    parts.push_back(leaf(inverse));
    parts.push_back(wi == wj ? power(a, 2) : product({a, b}));
  }
  terms.push_back({f.coef.sign() < 0, product(std::move(parts))});
}

class MassProduct {
 public:
  MassProduct(const Lecture& lecture, const Part& part) : lecture_(lecture), part_(part) {}

  // Sum over the bodies of (block of v) inv_m (block of v)' + (block of w) inv_I (block of w)'.
  Formula of(const Statement& s, const Statement& t) const {
    std::vector<SignedFormula> terms;
    for (std::size_t b = 0; b < lecture_.joint.bodies.size(); ++b) {
      const BodySymbols body = body_symbols(lecture_.joint, static_cast<int>(b));
      if (!s.vector() && !t.vector()) {
        const JacobianEntry &Js = J(s, b), &Jt = J(t, b);
        add_scalar_product(lecture_.notation, body.inv_m, Js.v, Jt.v, terms);
        add_product(lecture_.notation, body.inv_I, Js.w, Jt.w, terms);
      } else {
        const bool tensor = lecture_.joint.dimension == 3;
        add_blocks(body.inv_m, s.J[b].v, t.J[b].v, false, terms);
        add_blocks(body.inv_I, s.J[b].w, t.J[b].w, tensor, terms);
      }
    }
    return sum(std::move(terms));
  }

 private:
  const JacobianEntry& J(const Statement& s, std::size_t body) const { return part_.block.rows[s.first].J[body]; }

  // (A B)' = B' A', term by term.
  static Formula transposed(const Formula& f) {
    if (f.shape == Shape::transpose) return f.args[0];
    if (f.shape == Shape::sum) {
      std::vector<SignedFormula> terms = terms_of(f);
      for (SignedFormula& term : terms) term.formula = transposed(term.formula);
      return sum(std::move(terms));
    }
    if (f.shape == Shape::quotient) return quotient(transposed(f.args[0]), f.args[1]);
    if (f.shape == Shape::product) {
      std::vector<Formula> factors;
      for (auto factor = f.args.rbegin(); factor != f.args.rend(); ++factor) {
        const Formula t = transposed(*factor);
        factors.insert(is_scalar(t) ? factors.begin() : factors.end(), t);
      }
      return product(std::move(factors));
    }
    const bool symmetric = f.shape == Shape::identity || is_scalar(f);
    return symmetric ? f : shaped(Shape::transpose, f);
  }

  static bool is_scalar(const Formula& f) {
    const bool leaf_or_call = f.shape == Shape::leaf || f.shape == Shape::call;
    return f.shape == Shape::number || f.shape == Shape::dot || f.shape == Shape::power || f.shape == Shape::norm ||
           f.shape == Shape::component || (leaf_or_call && (!f.leaf || !f.leaf->vector));
  }

  // inverse i j', or i inverse j' where `inverse` is a matrix; E beside anything is not written.
  static void add_blocks(Expr inverse, const Formula& i, const Formula& j, bool tensor,
                         std::vector<SignedFormula>& terms) {
    if (i == number(0) || j == number(0)) return;
    Formula left = i, right = transposed(j);
    const bool left_is_E = is_identity(left), right_is_E = is_identity(right);
    if (left_is_E && (tensor || !right_is_E)) left = unsigned_one(left);
    if (right_is_E) right = unsigned_one(right);
    std::vector<Formula> factors;
    if (tensor) factors = {std::move(left), leaf(inverse), std::move(right)};
    else factors = {leaf(inverse), std::move(left), std::move(right)};
    terms.push_back({false, product(std::move(factors))});
  }

  static bool is_identity(const Formula& f) { return f.shape == Shape::identity || f == negative(identity()); }
  static Formula unsigned_one(const Formula& f) { return f.shape == Shape::identity ? number(1) : negative(number(1)); }

  const Lecture& lecture_;
  const Part& part_;
};

Expr unscaled(Expr v) { return v->kind == Kind::scale ? v->args[1] : v; }
std::string spoken(Expr e) { return e->name.empty() ? text(e) : e->name; }

// The identities that make K simpler than the product: lengths of unit vectors, right angles.
std::string identities_used(const Lecture& lecture, const Part& part, const Statement& s, const Statement& t) {
  std::string used;
  if (s.vector() || t.vector()) return "written out in components";
  for (std::size_t b = 0; b < lecture.joint.bodies.size(); ++b) {
    const Expr vi = part.block.rows[s.first].J[b].v, vj = part.block.rows[t.first].J[b].v;
    if (is_zero(vi) || is_zero(vj)) continue;
    const Factors f = factors(vi, vj);
    const Expr i = unscaled(f.i), j = unscaled(f.j);
    std::string identity;
    if (i == j && i->unit_length) {
      identity = spoken(i) + " has length 1: " + spoken(i) + " · " + spoken(i) + " = 1";
    } else if (is_zero(dot(i, j))) {
      identity = spoken(i) + " · " + spoken(j) + " = 0";
    }
    if (!identity.empty() && used.find(identity) == std::string::npos) {
      used += (used.empty() ? "" : "; ") + identity;
    }
  }
  return used.empty() ? "simplified" : used;
}

std::size_t rows_of(const Lecture& lecture, const Statement& s) {
  return s.vector() ? static_cast<std::size_t>(lecture.joint.dimension) : 1;
}

// Entries of block.K, which holds the lower triangle, for the rows of s and the columns of t.
Formula simplified(const Lecture& lecture, const Part& part, const Statement& s, const Statement& t) {
  std::vector<Formula> entries;
  for (std::size_t i = s.first; i < s.first + rows_of(lecture, s); ++i) {
    for (std::size_t j = t.first; j < t.first + rows_of(lecture, t); ++j) {
      entries.push_back(lecture.notation.definition(part.block.K[std::max(i, j)][std::min(i, j)]));
    }
  }
  if (entries.size() == 1) return entries[0];
  return matrix(static_cast<int>(rows_of(lecture, t)), std::move(entries));
}

Formula J_M_J(const Formula& J) { return product({J, power(leaf({}, "M"), -1), shaped(Shape::transpose, J)}); }

// In space the blocks say more than nine numbers with six components of each tensor, and a named axis more than the
// vectors that it is made of.
bool stays_in_blocks(const Lecture& lecture, const Part& part, const Statement& s, const Statement& t) {
  const bool axes = !part.block.rows[s.first].axes.empty() || !part.block.rows[t.first].axes.empty();
  return lecture.joint.dimension == 3 && (s.vector() || t.vector() || axes);
}

}  // namespace

void summarise_mass(const Lecture& lecture, const Part& part, std::vector<Chain>& chains) {
  const MassProduct product(lecture, part);
  for (const Statement& s : part.statements) {
    for (const Statement& t : part.statements) {
      if (&t < &s) continue;
      const bool blocks = s.vector() || t.vector() || stays_in_blocks(lecture, part, s, t);
      chains.push_back(
          {name_of_K(part, s.name, t.name), {{blocks ? product.of(s, t) : simplified(lecture, part, s, t), ""}}});
    }
  }
}

void multiply_mass(Lecture& lecture, const Part& part, Step& step) {
  std::vector<Formula> blocks;
  const bool coordinate = part.statements[0].row == nullptr;
  const MassProduct mass_product(lecture, part);
  for (const Statement& s : part.statements) {
    for (const Statement& t : part.statements) {
      const bool above = &t >= &s;
      const Formula name = name_of_K(part, above ? s.name : t.name, above ? t.name : s.name);
      blocks.push_back(above ? name : shaped(Shape::transpose, name));
      if (!above) continue;
      const Formula full = mass_product.of(s, t), result = simplified(lecture, part, s, t);
      const bool as_it_stands =
          stays_in_blocks(lecture, part, s, t) || same_terms(result, full) || same_terms(result, mass_product.of(t, s));
      Chain chain{name, {}};
      if (part.statements.size() == 1) chain.links.push_back({J_M_J(label("J", s)), ""});
      chain.links.push_back({full, "body by body"});
      if (!as_it_stands) chain.links.push_back({result, identities_used(lecture, part, s, t)});
      step.show(std::move(chain));
    }
  }
  if (part.statements.size() < 2 || coordinate) return;
  const int columns = static_cast<int>(part.statements.size());
  step.say("Together, with what lies below the diagonal by symmetry:");
  step.show({leaf({}, "K"), {{J_M_J(leaf({}, "J")), ""}, {matrix(columns, std::move(blocks)), ""}}});
}

}  // namespace cdot::derive
