// Where K is singular: minors of J, as formulas and as numbers; sums of squares that cannot vanish; and the words.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

// The determinant of J's columns as chosen: as many as J has rows.
ex determinant(const std::vector<std::vector<ex>>& J, const std::vector<std::size_t>& columns);
double determinant(const std::vector<std::vector<double>>& J, const std::vector<std::size_t>& columns);
// n over k.
double number_of_choices(std::size_t n, std::size_t k);

// All even powers with positive factors, and a constant: never zero. A number other than zero is one.
bool is_positive(const ex& expanded, const std::vector<ex>& symbols);

// For sums of squares that all have to vanish, each by the factors one of which has to (empty: no words are known):
// "where ratio = 0 and cross(ra, n) = 0". What is zero where something else in the list is goes without saying.
std::string where_all_vanish(const std::vector<std::vector<std::string>>& factors);

// Who has to be able to move and to turn.
struct Way {
  std::set<std::string> move, turn;
  friend bool operator==(const Way&, const Way&) = default;
};
// "a or b can move, and a or b can turn", if the ways are just that; else one after the other.
std::string in_words(const std::vector<Way>& ways);

}  // namespace cdot::derive
