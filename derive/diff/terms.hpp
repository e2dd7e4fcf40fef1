// Splits two expressions into terms, and terms into factors, so that common parts cancel.
#pragma once

#include <vector>

#include "derive/language/joint.hpp"

namespace cdot::derive {

using Terms = std::vector<Term>;

// How far expressions are expanded before terms are compared. Less expansion reads better.
enum class Opened {
  top,         // nothing is distributed
  nothing,     // products are distributed over sums, but for those that have a name
  rates,       // u_dot is opened
  own_lets,    // names that the entry gives, too
  everything,  // the spec's names, too, and denominators
  dots,        // own_lets, and dot products of vectors in components
  components   // everything, and all products of vectors in components
};
constexpr Opened all_openings[] = {Opened::top,        Opened::nothing, Opened::rates,     Opened::own_lets,
                                   Opened::everything, Opened::dots,    Opened::components};

// e as a sum of products.
Terms terms_of_expansion(Expr e, const Joint& joint, Opened opened);

// The terms that only one of two expressions has.
struct Leftover {
  Terms hand, generated;
};
Leftover leftover_terms(Expr hand, Expr generated, const Joint& joint, Opened opened);
Expr sum_of(const Terms& terms, Pool& pool);

// hand = rest * hand', generated = rest * generated', for single terms.
struct Factors {
  Expr hand, generated, rest;
};
Factors leftover_factors(const Term& hand, const Term& generated);

// hand - generated, in the spec's names and in the shortest form that opening and collecting finds.
Expr difference_of(Expr hand, Expr generated, const Joint& joint);

// The text of e; in space that of its components, if it is shorter.
std::string brief_text(Expr e, const Joint& joint);

// The symbols that an entry declares free: their values are unknown.
std::vector<Expr> free_symbols(Expr e);

}  // namespace cdot::derive
