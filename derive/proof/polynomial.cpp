#include "derive/proof/polynomial.hpp"

#include <algorithm>
#include <stdexcept>

namespace cdot::derive {

namespace {

std::uint64_t hash_of(Monomials::Factors factors) {
  std::uint64_t hash = 0x9E3779B97F4A7C15u;
  for (const std::uint32_t factor : factors) {
    hash = (hash ^ factor) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 29;
  }
  return hash;
}

cln::cl_RA fraction(const numeric& value) { return cln::the<cln::cl_RA>(value.to_cl_N()); }

}  // namespace

void Monomials::grow() {
  table_.assign(std::max<std::size_t>(64, 2 * table_.size()), 0);
  for (std::size_t monomial = 0; monomial < hashes_.size(); ++monomial) {
    std::size_t at = hashes_[monomial] & (table_.size() - 1);
    while (table_[at] != 0) at = (at + 1) & (table_.size() - 1);
    table_[at] = static_cast<std::uint32_t>(monomial + 1);
  }
}

std::uint32_t Monomials::number_of(Factors factors) {
  if (2 * hashes_.size() >= table_.size()) grow();
  const std::uint64_t hash = hash_of(factors);
  std::size_t at = hash & (table_.size() - 1);
  for (; table_[at] != 0; at = (at + 1) & (table_.size() - 1)) {
    const std::uint32_t known = table_[at] - 1;
    if (hashes_[known] == hash && std::ranges::equal(this->factors(known), factors)) return known;
  }
  hashes_.push_back(hash);
  all_.insert(all_.end(), factors.begin(), factors.end());
  begin_.push_back(all_.size());
  table_[at] = static_cast<std::uint32_t>(hashes_.size());
  return table_[at] - 1;
}

std::uint32_t Monomials::product(std::uint32_t a, std::uint32_t b) {
  if (a == 0 || b == 0) return a + b;
  const Factors x = factors(a), y = factors(b);
  product_factors_.clear();
  std::size_t i = 0, j = 0;
  while (i < x.size() && j < y.size()) {
    const std::uint32_t of_x = x[i] >> exponent_bits, of_y = y[j] >> exponent_bits;
    std::uint32_t factor = of_x <= of_y ? x[i] : y[j];
    if (of_x == of_y) {
      factor = x[i] + (y[j] & exponent_mask);
      if (factor >> exponent_bits != of_x) throw std::overflow_error("an exponent is too large");
    }
    product_factors_.push_back(factor);
    i += of_x <= of_y ? 1 : 0;
    j += of_y <= of_x ? 1 : 0;
  }
  product_factors_.insert(product_factors_.end(), x.begin() + static_cast<std::ptrdiff_t>(i), x.end());
  product_factors_.insert(product_factors_.end(), y.begin() + static_cast<std::ptrdiff_t>(j), y.end());
  return number_of(product_factors_);
}

std::uint32_t Polynomials::number_of(const ex& variable) {
  const auto [at, fresh] = numbers_.try_emplace(variable, static_cast<std::uint32_t>(variables_.size()));
  if (fresh) variables_.push_back(variable);
  if (at->second > Monomials::exponent_mask) throw std::overflow_error("too many variables");
  return at->second;
}

Polynomial Polynomials::number(const numeric& value) const {
  return value.is_zero() ? Polynomial{} : Polynomial{{{0, fraction(value)}}};
}

Polynomial Polynomials::power(const ex& variable, int exponent) {
  if (exponent == 0) return number(1);
  if (exponent < 0 || exponent > int{Monomials::exponent_mask}) throw std::overflow_error("an exponent is too large");
  const std::uint32_t factor = (number_of(variable) << Monomials::exponent_bits) + static_cast<std::uint32_t>(exponent);
  return {{{monomials_.number_of({&factor, 1}), 1}}};
}

Polynomial Polynomials::of_expanded(const ex& sum) {
  if (is_a<numeric>(sum)) return number(ex_to<numeric>(sum));
  if (is_a<GiNaC::power>(sum)) return power(sum.op(0), ex_to<numeric>(sum.op(1)).to_int());
  if (!is_a<GiNaC::add>(sum) && !is_a<GiNaC::mul>(sum)) return power(sum, 1);
  std::vector<Polynomial> parts;
  for (const ex& part : sum) parts.push_back(of_expanded(part));
  if (is_a<GiNaC::add>(sum)) return this->sum(parts);
  Polynomial all = number(1);
  for (const Polynomial& part : parts) all = product(all, part);
  return all;
}

// A sum in the making. There is one at a time.
class Polynomials::Total {
 public:
  explicit Total(Polynomials& all) : all_(all) {}
  Total(const Total&) = delete;
  Total& operator=(const Total&) = delete;
  ~Total() { forget(); }

  void add(std::uint32_t monomial, const cln::cl_RA& coef) {
    std::vector<std::uint32_t>& places = all_.places_;
    if (places.size() <= monomial) places.resize(all_.monomials_.size() + all_.monomials_.size() / 2);
    std::uint32_t& place = places[monomial];
    if (place == 0) {
      sum_.terms.push_back({monomial, coef});
      place = static_cast<std::uint32_t>(sum_.terms.size());
    } else {
      cln::cl_RA& known = sum_.terms[place - 1].coef;
      known = known + coef;
    }
  }

  Polynomial finished() {
    forget();
    std::erase_if(sum_.terms, [](const Polynomial::Term& term) { return cln::zerop(term.coef); });
    return std::move(sum_);
  }

 private:
  void forget() {
    for (const Polynomial::Term& term : sum_.terms) all_.places_[term.monomial] = 0;
  }

  Polynomials& all_;
  Polynomial sum_;
};

Polynomial Polynomials::sum(std::span<const Polynomial> parts) {
  Total total(*this);
  for (const Polynomial& part : parts) {
    for (const Polynomial::Term& term : part.terms) total.add(term.monomial, term.coef);
  }
  return total.finished();
}

Polynomial Polynomials::product(const Polynomial& a, const Polynomial& b) {
  Total total(*this);
  for (const Polynomial::Term& x : a.terms) {
    for (const Polynomial::Term& y : b.terms) {
      total.add(monomials_.product(x.monomial, y.monomial), x.coef * y.coef);
    }
  }
  return total.finished();
}

int Polynomials::degree(const Polynomial& p, const ex& variable) const {
  const auto number = numbers_.find(variable);
  if (number == numbers_.end()) return 0;
  std::uint32_t highest = 0;
  for (const Polynomial::Term& term : p.terms) {
    for (const std::uint32_t factor : monomials_.factors(term.monomial)) {
      if (factor >> Monomials::exponent_bits == number->second)
        highest = std::max(highest, factor & Monomials::exponent_mask);
    }
  }
  return static_cast<int>(highest);
}

std::vector<Polynomial> Polynomials::coefficients(const Polynomial& p, const ex& variable) {
  const std::uint32_t number = number_of(variable);
  std::vector<Polynomial> by_exponent(static_cast<std::size_t>(degree(p, variable)) + 1);
  std::vector<std::uint32_t> others;
  for (const Polynomial::Term& term : p.terms) {
    std::uint32_t exponent = 0;
    others.clear();
    for (const std::uint32_t factor : monomials_.factors(term.monomial)) {
      if (factor >> Monomials::exponent_bits == number) exponent = factor & Monomials::exponent_mask;
      else others.push_back(factor);
    }
    by_exponent[exponent].terms.push_back({monomials_.number_of(others), term.coef});
  }
  return by_exponent;
}

std::size_t Polynomials::weight(const Polynomial& p) const {
  if (p.is_zero()) return 2;
  std::size_t total = 0;
  for (const Polynomial::Term& term : p.terms)
    total += std::max<std::size_t>(2, monomials_.factors(term.monomial).size() + 1);
  return total;
}

ex Polynomials::expression(const Polynomial& p) const {
  GiNaC::exvector terms;
  for (const Polynomial::Term& term : p.terms) {
    GiNaC::exvector factors{numeric(term.coef)};
    for (const std::uint32_t factor : monomials_.factors(term.monomial)) {
      const int exponent = static_cast<int>(factor & Monomials::exponent_mask);
      factors.push_back(pow(variables_[factor >> Monomials::exponent_bits], exponent));
    }
    terms.push_back(GiNaC::mul(factors));
  }
  return GiNaC::add(terms);
}

}  // namespace cdot::derive
