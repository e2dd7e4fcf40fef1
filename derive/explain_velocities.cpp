// Multiplying out keeps the shape of what it multiplies, so that each term can be recognised in
// Cdot.
#include "derive/explain_velocities.hpp"

#include <utility>

namespace cdot::derive {
namespace {

class Distribution {
 public:
  std::vector<SignedFormula> of(const Formula& f) const {
    if (!moves(f)) return {{false, f}};
    switch (f.form) {
      case Form::sum: {
        std::vector<SignedFormula> all;
        for (std::size_t i = 0; i < f.args.size(); ++i) append(all, of(f.args[i]), f.minus[i]);
        return all;
      }
      case Form::product:
        return through(f, [](std::vector<Formula> args) { return product(std::move(args)); });
      case Form::quotient:
        return through(f, [](std::vector<Formula> args) { return quotient(args[0], args[1]); });
      // A velocity w × r is a unit of its own: only sums inside it are taken apart.
      case Form::dot:
      case Form::cross:
      case Form::perp:
      case Form::component:
        return through(f, [&f](std::vector<Formula> args) {
          Formula g = f;
          g.args = std::move(args);
          return g;
        });
      default:
        return {{false, f}};
    }
  }

  bool moves(const Formula& f) const {
    if (f.form == Form::leaf) return depends_on_velocity(f.leaf);
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
  return f.form == Form::cross && f.args[0].form == Form::leaf && !f.args[0].leaf->vector;
}

// The identity that brings the innermost product with a velocity into the form "coefficient times
// velocity".
std::string identity_in(const Formula& f, const Distribution& distribution) {
  for (const Formula& arg : f.args) {
    if (is_turning(f) || !distribution.moves(arg) || arg.form == Form::leaf) continue;
    if (std::string inner = identity_in(arg, distribution); !inner.empty()) return inner;
  }
  if (f.form == Form::dot) {
    if (is_turning(f.args[0])) return "(w × s) · u = (s × u) w";
    if (is_turning(f.args[1])) return "n · (w × r) = (r × n) w";
  }
  if (f.form == Form::cross && !is_turning(f)) {
    if (is_turning(f.args[0])) return "(w × s) × u = -(s · u) w";
    if (is_turning(f.args[1])) return "u × (w × r) = (u · r) w";
    return distribution.moves(f.args[1]) ? "u × v = perp(u) · v" : "v × u = -perp(u) · v";
  }
  if (f.form == Form::component) {
    if (is_turning(f.args[0])) return f.name == "x" ? "(w × r).x = -r.y w" : "(w × r).y = r.x w";
  }
  return "";
}

}  // namespace

std::vector<VelocityTerm> isolate(const Formula& Cdot, const Joint& joint) {
  Pool& pool = *joint.pool;
  const Distribution distribution;
  std::vector<VelocityTerm> terms;
  for (const SignedFormula& part : distribution.of(Cdot)) {
    VelocityTerm term{part.minus, part.formula, -1,
                      false,      {},           identity_in(part.formula, distribution)};
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

std::optional<std::vector<VectorEntry>> isolate_vector(Expr Cdot, const Joint& joint) {
  Pool& pool = *joint.pool;
  std::vector<VectorEntry> J(joint.bodies.size(), {pool.number(0), zero_vector(pool)});
  for (const Term& term : terms_of(Cdot)) {
    const bool scaled = term.e->kind == Kind::scale;
    const Expr factor = scaled ? term.e->args[0] : pool.number(1);
    const Expr vector = scaled ? term.e->args[1] : term.e;
    const bool is_velocity = vector->kind == Kind::symbol && vector->role == Role::velocity;
    if (is_velocity && !depends_on_velocity(factor)) {
      Expr& v = J[static_cast<std::size_t>(vector->body)].v;
      v = v + term.coef * factor;
    } else if (scaled && !depends_on_velocity(vector)) {
      const std::vector<JacobianEntry> entries = isolate_velocities(factor, joint);
      for (std::size_t b = 0; b < J.size(); ++b) {
        if (!is_zero(entries[b].v)) return {};
        J[b].w = J[b].w + term.coef * (entries[b].w * vector);
      }
    } else if (depends_on_velocity(term.e)) {
      return {};
    }
  }
  return J;
}

Formula multiplied(Expr coefficient, int body, bool spin, const Joint& joint,
                   const Notation& notation) {
  const BodySymbols symbols = body_symbols(joint, body);
  if (spin) return product({notation.of(coefficient), leaf(symbols.w)});
  // (s n) · v is written s (n · v).
  const Term term = split_coefficient(coefficient);
  const bool scaled = term.e->kind == Kind::scale && !Notation::has_name(term.e);
  const Formula factor = scaled ? notation.of(term.e->args[0]) : number(1);
  const Formula along = dot(notation.of(scaled ? term.e->args[1] : term.e), leaf(symbols.v));
  const Formula f = product({number(abs(term.coef)), factor, along});
  return term.coef.sign() < 0 ? negative(f) : f;
}

}  // namespace cdot::derive
