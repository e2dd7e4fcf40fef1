// Expands polynomials and reduces them by the relations of their symbols. Every product of two terms is counted: the
// budget ends at the same place on every machine.
#include <algorithm>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

void Algebra::spend(std::size_t work) {
  const auto count = static_cast<std::int64_t>(work);
  if (count > left_for_test_) {  // the rest counts as spent: at which term it ends depends on the run
    left_in_all_ -= left_for_test_;
    left_for_test_ = 0;
    allowance_ = std::max(allowance_ / 2, least_work);
    throw TooLong{};
  }
  left_for_test_ -= count;
  left_in_all_ -= count;
}

// The operands of a sum or product in the same order on every run, unlike GiNaC's. The sign of a factor, (x - y) or (y
// - x), does not count.
GiNaC::exvector Algebra::ordered(const ex& e) {
  std::vector<std::pair<std::int64_t, ex>> keyed;
  for (const ex& part : e) keyed.emplace_back(std::abs(fingerprint(part).centred()), part);
  std::sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  GiNaC::exvector parts;
  for (const auto& [key, part] : keyed) parts.push_back(part);
  return parts;
}

Modular Algebra::fingerprint(const ex& e) try { return prints_.of(e); } catch (const UndefinedHere&) {
  return Modular(0);
}

GiNaC::realsymbol Algebra::fresh_symbol(const std::string& name) {
  const GiNaC::realsymbol symbol = name.empty() ? GiNaC::realsymbol() : GiNaC::realsymbol(name);
  prints_.put(symbol);
  return symbol;
}

Polynomial Algebra::multiplied(const Polynomial& a, const Polynomial& b) {
  spend(a.size() * polynomials_.weight(b) + polynomials_.weight(a) * b.size());
  return polynomials_.product(a, b);
}

// From the shortest factor to the longest. A term by itself costs nothing.
Polynomial Algebra::multiplied(std::vector<Polynomial> factors) {
  std::ranges::stable_sort(factors, {}, &Polynomial::size);
  Polynomial result = polynomials_.number(1);
  for (const Polynomial& factor : factors) {
    result = factor.size() == 1 ? polynomials_.product(result, factor) : multiplied(result, factor);
  }
  return result;
}

Polynomial Algebra::raised(const Polynomial& base, int exponent) {
  Polynomial result = polynomials_.number(1);
  for (int k = 0; k < exponent; ++k) {
    result = base.size() == 1 ? polynomials_.product(result, base) : multiplied(result, base);
  }
  return result;
}

// Multiplied out. A part that is no polynomial counts as a variable.
Polynomial Algebra::polynomial(const ex& e) {
  if (is_a<GiNaC::symbol>(e)) return polynomials_.power(e, 1);
  if (is_a<numeric>(e) && ex_to<numeric>(e).is_rational()) return polynomials_.number(ex_to<numeric>(e));
  if (is_a<GiNaC::add>(e)) {
    std::vector<Polynomial> terms;
    for (const ex& term : e) {
      terms.push_back(polynomial(term));
      spend(polynomials_.weight(terms.back()));
    }
    return polynomials_.sum(terms);
  }
  if (is_a<GiNaC::power>(e) && e.op(1).info(GiNaC::info_flags::posint)) {
    const int exponent = ex_to<numeric>(e.op(1)).to_int();
    return is_a<GiNaC::symbol>(e.op(0)) ? polynomials_.power(e.op(0), exponent) : raised(polynomial(e.op(0)), exponent);
  }
  if (!is_a<GiNaC::mul>(e)) return polynomials_.power(e, 1);
  std::vector<Polynomial> factors;
  for (const ex& factor : ordered(e)) factors.push_back(polynomial(factor));
  return multiplied(std::move(factors));
}

// The sum of c_k base^(exponent of k) x^(rest of k), where p = c_0 + c_1 x + c_2 x^2 + ...
template <class Exponent, class Rest>
Polynomial Algebra::in_powers(const Polynomial& p, const ex& x, const Polynomial& base, Exponent exponent, Rest rest) {
  std::vector<Polynomial> terms, coefs = polynomials_.coefficients(p, x);
  spend(polynomials_.weight(p) * (coefs.size() - 1));
  for (std::size_t i = 0; i < coefs.size(); ++i) {
    if (coefs[i].is_zero()) continue;
    const int k = static_cast<int>(i), power = exponent(k);
    if (i > 0) spend(polynomials_.weight(coefs[i]));
    if (power > 0) spend(polynomials_.weight(base));
    terms.push_back(multiplied({std::move(coefs[i]), raised(base, power), polynomials_.power(x, rest(k))}));
    spend(polynomials_.weight(terms.back()));
  }
  return polynomials_.sum(terms);
}

// Reduces powers of x by x^2 = square.
Polynomial Algebra::square_reduced(const Polynomial& p, const ex& x, const Polynomial& square) {
  if (polynomials_.degree(p, x) < 2) return p;
  return in_powers(
      p, x, square, [](int k) { return k / 2; }, [](int k) { return k % 2; });
}

// The numerator over the power of `operand` that removes x = 1/operand.
Polynomial Algebra::inverse_removed(const Polynomial& p, const ex& x, const Polynomial& operand) {
  const int degree = polynomials_.degree(p, x);
  if (degree < 1) return p;
  return in_powers(
      p, x, operand, [&](int k) { return degree - k; }, [](int) { return 0; });
}

// Cancels symbol = 1/operand against multiples of the operand.
Polynomial Algebra::without_common_factors(Polynomial p) {
  for (auto atom = atoms_.rbegin(); atom != atoms_.rend(); ++atom) {
    for (int k = atom->kind == Atom::Kind::inverse ? polynomials_.degree(p, atom->symbol) : 0; k > 0; --k) {
      std::vector<Polynomial> coefs = polynomials_.coefficients(p, atom->symbol);
      const auto at = static_cast<std::size_t>(k);
      if (at >= coefs.size() || coefs[at].is_zero()) continue;
      spend(polynomials_.weight(p) + coefs[at].size() * polynomials_.weight(atom->terms));
      ex quotient;
      if (!divide(polynomials_.expression(coefs[at]), atom->operand, quotient)) continue;
      coefs[at] = {};
      coefs[at - 1] = polynomials_.sum(std::vector{coefs[at - 1], polynomial(quotient)});
      for (std::size_t i = 1; i < coefs.size(); ++i)
        coefs[i] = polynomials_.product(coefs[i], polynomials_.power(atom->symbol, static_cast<int>(i)));
      p = polynomials_.sum(coefs);
    }
  }
  return p;
}

Polynomial Algebra::reduced(Polynomial p, bool without_inverses) {
  for (auto atom = atoms_.rbegin(); atom != atoms_.rend(); ++atom) {
    if (atom->kind == Atom::Kind::square) p = square_reduced(p, atom->symbol, atom->terms);
    else if (without_inverses) p = inverse_removed(p, atom->symbol, atom->terms);
  }
  return p;
}

ex Algebra::reduced(const ex& e) { return polynomials_.expression(reduced(polynomial(e), false)); }

// The same polynomial in the other of two coordinates on a circle: t^2 = 1 - s^2 in place of s^2 = 1 - t^2.
ex Algebra::other_coordinates(const ex& e) try {
  Polynomial p = polynomial(e);
  for (const Atom& atom : atoms_) {
    if (atom.kind != Atom::Kind::square) continue;
    for (const ex& t : symbols_in(atom.operand)) {
      if (!polynomial(atom.operand - 1 + t * t).is_zero()) continue;
      p = square_reduced(p, t, polynomial(1 - atom.symbol * atom.symbol));
    }
  }
  return polynomials_.expression(p);
} catch (const TooLong&) {
  return e;
}

}  // namespace cdot::derive
