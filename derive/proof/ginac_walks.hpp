// Walks over GiNaC's expressions that visit each shared part once. GiNaC's own diff(), subs() and evalf() visit a part
// once for each path that leads to it: in nested names, as u = sin(t) cos(t), twice as often with each name.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

// The slopes of the arguments of f, for the chain rule: GiNaC differentiates f of fresh symbols.
struct Partials {
  explicit Partials(const ex& f);  // a call of a function, or a power
  GiNaC::exvector symbols, slopes;
};

// d/dsymbol of any number of expressions, which may share parts. GiNaC's rules, in the form in which diff() gives them.
class Slope {
 public:
  // All slopes together make at most `left` operands of sums and products; each one is counted.
  struct TooLong {};
  // d/dsymbol of another symbol.
  using OfLeaf = std::function<ex(const ex&)>;
  Slope(ex symbol, std::int64_t& left, OfLeaf of_leaf)
      : symbol_(std::move(symbol)), left_(left), of_leaf_(std::move(of_leaf)) {}
  ex of(const ex& e);

 private:
  ex compound(const ex& e);
  ex of_product(const ex& e);
  ex of_function(const ex& e);
  void spend(std::size_t operands);

  ex symbol_;
  std::int64_t& left_;
  OfLeaf of_leaf_;
  std::unordered_map<ex, ex, std::hash<ex>, SameExpression> done_;
};

// de/dsymbol where e is linear in the symbol as it is written, with a number as its factor; else none.
std::optional<numeric> numeric_slope(const ex& e, const ex& symbol);

// e with other expressions in place of symbols.
ex substituted(const ex& e, const GiNaC::exmap& symbols);

// e multiplied out; none if that takes more than 20,000 terms.
std::optional<ex> expanded_if_short(const ex& e);

// The symbols in e.
std::set<ex, GiNaC::ex_is_less> symbols_of(const ex& e);

}  // namespace cdot::derive
