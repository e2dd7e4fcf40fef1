// Sparse polynomials with rational coefficients, for the zero-test: GiNaC's trees take twenty to fifty times as long to
// multiply out. GiNaC's expressions go in, and come out where they are needed.
#pragma once

#include <cln/rational.h>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

// A sum of terms, each a number times a numbered monomial; no monomial twice, no term zero.
struct Polynomial {
  struct Term {
    std::uint32_t monomial;
    cln::cl_RA coef;
  };
  std::vector<Term> terms;

  bool is_zero() const { return terms.empty(); }
  std::size_t size() const { return terms.empty() ? 1 : terms.size(); }  // zero is one term
};

// Products of powers of variables, numbered as they come up. Number 0 is the empty product.
class Monomials {
 public:
  // variable * 2^16 + exponent, by rising variable
  using Factors = std::span<const std::uint32_t>;
  static constexpr std::uint32_t exponent_bits = 16, exponent_mask = (1u << exponent_bits) - 1;

  Monomials() { number_of({}); }
  Factors factors(std::uint32_t monomial) const {
    return std::span(all_).subspan(begin_[monomial], begin_[monomial + 1] - begin_[monomial]);
  }
  std::uint32_t number_of(Factors factors);
  std::uint32_t product(std::uint32_t a, std::uint32_t b);
  std::size_t size() const { return begin_.size() - 1; }

 private:
  void grow();

  std::vector<std::uint32_t> all_;              // factors of monomial 0, then of 1, ...
  std::vector<std::size_t> begin_{0};           // where those of a monomial begin
  std::vector<std::uint64_t> hashes_;           // by monomial
  std::vector<std::uint32_t> table_;            // open addressing: monomial + 1, or 0
  std::vector<std::uint32_t> product_factors_;  // scratch
};

// The polynomials over variables that come up one by one. A variable is a symbol of GiNaC, or any expression that is no
// polynomial.
class Polynomials {
 public:
  Polynomial number(const numeric& value) const;
  Polynomial power(const ex& variable, int exponent);
  Polynomial of_expanded(const ex& sum);  // of products of powers
  Polynomial sum(std::span<const Polynomial> parts);
  Polynomial product(const Polynomial& a, const Polynomial& b);

  // The highest exponent of a variable.
  int degree(const Polynomial& p, const ex& variable) const;
  // The polynomials c_k in p = c_0 + c_1 x + c_2 x^2 + ...
  std::vector<Polynomial> coefficients(const Polynomial& p, const ex& variable);
  // The number of powers in all terms, plus one for each term; a number weighs 2.
  std::size_t weight(const Polynomial& p) const;
  ex expression(const Polynomial& p) const;

 private:
  class Total;
  std::uint32_t number_of(const ex& variable);

  Monomials monomials_;
  std::vector<ex> variables_;
  std::unordered_map<ex, std::uint32_t, std::hash<ex>, SameExpression> numbers_;
  std::vector<std::uint32_t> places_;  // of monomials among the terms of the total in the making, plus one; else 0
};

}  // namespace cdot::derive
