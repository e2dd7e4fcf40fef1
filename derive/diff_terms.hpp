// Two expressions taken apart, so that what they have in common cancels: into terms, and terms into factors.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "derive/joint.hpp"

namespace cdot::derive {

// Which names are opened before terms are compared: the fewer, the better it reads.
enum class Opened { nothing, rates, own_lets, everything };  // rates: u_dot; own_lets: those of the entry, too
constexpr Opened all_openings[] = {Opened::nothing, Opened::rates, Opened::own_lets, Opened::everything};

// e as a sum of products: products are distributed over sums whose names are opened.
Expr expanded(Expr e, const Joint& joint, Opened opened);

// What only one of two expressions has.
struct Leftover {
  std::vector<Term> hand, generated;
};
Leftover leftover_terms(Expr hand, Expr generated, const Joint& joint, Opened opened);
Expr sum_of(const std::vector<Term>& terms, Pool& pool);

// hand = rest * ours, generated = rest * theirs, for single terms.
struct Factors {
  Expr hand, generated, rest;
};
Factors leftover_factors(const Term& hand, const Term& generated);

// hand - generated, in the spec's names and as short as opening and collecting makes it.
Expr difference_of(Expr hand, Expr generated, const Joint& joint);

// Their value is unknown: symbols that an entry declares free.
std::vector<Expr> free_symbols(Expr e);

}  // namespace cdot::derive
