// Walks over GiNaC's expressions that visit each shared part once. GiNaC's own diff(), subs() and evalf() visit a part
// once for each path that leads to it: in nested names, as u = sin(t) cos(t), twice as often with each name.
#pragma once

#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

// d/dsymbol of any number of expressions, which may share parts. GiNaC's rules, in the form in which diff() gives them.
class Slope {
 public:
  explicit Slope(ex symbol) : symbol_(std::move(symbol)) {}
  ex of(const ex& e);

 private:
  ex compound(const ex& e);
  ex of_product(const ex& e);
  ex of_function(const ex& e);

  ex symbol_;
  std::unordered_map<ex, ex, std::hash<ex>, SameExpression> done_;
};

// e with other expressions in place of symbols.
ex substituted(const ex& e, const GiNaC::exmap& symbols);

// e multiplied out; none if that takes more than 20,000 terms.
std::optional<ex> expanded_if_short(const ex& e);

// The symbols in e.
std::set<ex, GiNaC::ex_is_less> symbols_of(const ex& e);

}  // namespace cdot::derive
