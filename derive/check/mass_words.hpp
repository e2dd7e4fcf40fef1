// Where K is singular and who has to move for it to be regular, in words.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace cdot::derive {

// For sums of squares that all have to vanish, each by the factors one of which has to (empty: no
// words are known): "where ratio = 0 and cross(ra, n) = 0". What is zero where something else in
// the list is goes without saying.
std::string where_all_vanish(const std::vector<std::vector<std::string>>& factors);

// Who has to be able to move and to turn.
struct Way {
  std::set<std::string> move, turn;
  friend bool operator==(const Way&, const Way&) = default;
};
// "a or b can move, and a or b can turn", if the ways are just that; else one after the other.
std::string in_words(const std::vector<Way>& ways);

}  // namespace cdot::derive
