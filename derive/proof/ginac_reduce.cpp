// Expands polynomials and reduces them by the relations of their symbols. Every product of two terms is counted: the
// budget ends at the same place on every machine.
#include <algorithm>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

namespace {

std::size_t size_of(const ex& polynomial) { return is_a<GiNaC::add>(polynomial) ? polynomial.nops() : 1; }

// The number of powers of symbols in all terms, plus one for each term.
std::size_t weight_of(const ex& polynomial) {
  const auto weight = [](const ex& term) {
    if (!is_a<GiNaC::mul>(term)) return std::size_t{2};
    return term.nops() + (is_a<numeric>(term.op(term.nops() - 1)) ? 0 : 1);
  };
  if (!is_a<GiNaC::add>(polynomial)) return weight(polynomial);
  std::size_t total = 0;
  for (const ex& term : polynomial) total += weight(term);
  return total;
}

}  // namespace

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

// a * b, both expanded already.
ex Algebra::multiplied(const ex& a, const ex& b) {
  spend(size_of(a) * weight_of(b) + weight_of(a) * size_of(b));
  return (a * b).expand();
}

ex Algebra::raised(const ex& polynomial, int exponent) {
  if (!is_a<GiNaC::add>(polynomial)) return pow(polynomial, exponent);
  ex result = 1;
  for (int k = 0; k < exponent; ++k) result = multiplied(result, polynomial);
  return result;
}

// The result of GiNaC's expand(), within the budget.
ex Algebra::expanded(const ex& e) {
  if (e.info(GiNaC::info_flags::expanded)) {
    if (is_a<GiNaC::add>(e)) spend(weight_of(e));  // as without GiNaC's mark, which may be missing
    return e;
  }
  if (is_a<GiNaC::add>(e)) {
    GiNaC::exvector terms;
    for (const ex& term : e) {
      terms.push_back(expanded(term));
      spend(weight_of(terms.back()));
    }
    return ex(GiNaC::add(terms)).expand();
  }
  if (is_a<GiNaC::power>(e) && e.op(1).info(GiNaC::info_flags::posint)) {
    return raised(expanded(e.op(0)), ex_to<numeric>(e.op(1)).to_int());
  }
  if (!is_a<GiNaC::mul>(e)) return e;
  GiNaC::exvector factors;
  for (const ex& factor : ordered(e)) factors.push_back(expanded(factor));
  std::stable_sort(factors.begin(), factors.end(), [](const ex& a, const ex& b) { return size_of(a) < size_of(b); });
  ex result = 1;
  for (const ex& factor : factors) {
    result = size_of(factor) == 1 ? result * factor : multiplied(result, factor);
  }
  return result.expand();
}

// Reduces powers of `symbol` by symbol^2 = square. The polynomial must be expanded.
ex Algebra::square_reduced(const ex& polynomial, const GiNaC::symbol& symbol, const ex& square) {
  const int degree = polynomial.degree(symbol);
  if (degree < 2) return polynomial;
  spend(weight_of(polynomial) * static_cast<std::size_t>(degree));
  ex out = 0;
  for (int k = 0; k <= degree; ++k) {
    out += polynomial.coeff(symbol, k) * pow(square, k / 2) * pow(symbol, k % 2);
  }
  return expanded(out);
}

// The numerator over the power of `operand` that removes symbol = 1/operand.
ex Algebra::inverse_removed(const ex& polynomial, const GiNaC::symbol& symbol, const ex& operand) {
  const int degree = polynomial.degree(symbol);
  if (degree < 1) return polynomial;
  spend(weight_of(polynomial) * static_cast<std::size_t>(degree));
  ex out = 0;
  for (int k = 0; k <= degree; ++k) {
    out += polynomial.coeff(symbol, k) * pow(operand, degree - k);
  }
  return expanded(out);
}

// Cancels symbol = 1/operand against multiples of the operand.
ex Algebra::without_common_factors(ex p) {
  for (auto atom = atoms_.rbegin(); atom != atoms_.rend(); ++atom) {
    for (int k = atom->kind == Atom::Kind::inverse ? p.degree(atom->symbol) : 0; k > 0; --k) {
      ex quotient;
      const ex factor = p.coeff(atom->symbol, k);
      spend(weight_of(p) + size_of(factor) * weight_of(atom->operand));
      if (factor.is_zero() || !divide(factor, atom->operand, quotient)) continue;
      p = expanded(p - factor * pow(atom->symbol, k) + quotient * pow(atom->symbol, k - 1));
    }
  }
  return p;
}

ex Algebra::reduced(const ex& polynomial, bool without_inverses) {
  ex p = expanded(polynomial);
  for (auto atom = atoms_.rbegin(); atom != atoms_.rend(); ++atom) {
    if (atom->kind == Atom::Kind::square) p = square_reduced(p, atom->symbol, atom->operand);
    else if (without_inverses) p = inverse_removed(p, atom->symbol, atom->operand);
  }
  return p;
}

// The same polynomial in the other of two coordinates on a circle: t^2 = 1 - s^2 in place of s^2 = 1 - t^2.
ex Algebra::other_coordinates(const ex& polynomial) try {
  ex p = polynomial;
  for (const Atom& atom : atoms_) {
    if (atom.kind != Atom::Kind::square) continue;
    for (const ex& t : symbols_in(atom.operand)) {
      if (!expanded(atom.operand - 1 + t * t).is_zero()) continue;
      p = square_reduced(p, ex_to<GiNaC::symbol>(t), 1 - atom.symbol * atom.symbol);
    }
  }
  return p;
} catch (const TooLong&) {
  return polynomial;
}

}  // namespace cdot::derive
