// Where K is singular: minors of J, as formulas and as numbers; sums of squares that cannot vanish; and the words.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

// The minors of J, by Laplace's rule, multiplied out unless that is long. Each minor of J's last rows is made once.
class Minors {
 public:
  explicit Minors(std::vector<std::vector<ex>> J) : J_(std::move(J)) {}
  // Of these columns of as many last rows.
  ex of(const std::vector<std::size_t>& columns);

 private:
  std::vector<std::vector<ex>> J_;
  std::map<std::vector<std::size_t>, ex> made_;
};
// The determinant of J's columns as chosen: as many as J has rows.
double determinant(const std::vector<std::vector<double>>& J, const std::vector<std::size_t>& columns);
// n over k.
double number_of_choices(std::size_t n, std::size_t k);

// True for a positive constant plus even powers with positive factors: such a sum is never zero.
bool is_positive(const ex& expanded, const std::vector<ex>& symbols);

// The place where sums of squares all vanish: "where ratio = 0 and cross(ra, n) = 0". Each sum is given by factors, one
// of which must vanish; without factors, no closed form is known. Implied conditions are left out.
std::string where_all_vanish(const std::vector<std::vector<std::string>>& factors);

// The bodies that must be able to move, and to turn.
struct Way {
  std::set<std::string> move, turn;
  friend bool operator==(const Way&, const Way&) = default;
};
// "a or b can move, and a or b can turn", if the ways are just that; else one after the other.
std::string in_words(const std::vector<Way>& ways);

}  // namespace cdot::derive
