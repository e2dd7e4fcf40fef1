// Where K is regular, and where it is singular: proofs, searches, and the words for both.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "derive/check/parts.hpp"
#include "derive/proof/ginac.hpp"

namespace cdot::derive {

// Powers of inverse masses: m of the first body, its I, m of the second, ...
using Movement = std::vector<int>;

// The products of inverse masses which alone keep K regular at every pose, by algebra; none if that is too expensive.
std::vector<Movement> proved_regular(const Subject& subject);

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
// n over k.
double number_of_choices(std::size_t n, std::size_t k);
// True for a positive constant plus even powers with positive factors: such a sum is never zero.
bool is_positive(const ex& expanded, const std::vector<ex>& symbols);

// The bodies that must be able to move, and to turn.
struct Way {
  std::set<std::string> move, turn;
  friend bool operator==(const Way&, const Way&) = default;
};
// "a or b can move, and a or b can turn", if the ways are just that; else one after the other.
std::string in_words(const std::vector<Way>& ways);

// Some inverse masses are zero: the columns of J that remain.
struct Freedom {
  std::string condition;      // "nothing can turn"; empty: everything moves
  std::vector<bool> allowed;  // as in Movement
};

// A scalar or vector with a short name, which may vanish where K is singular.
struct Candidate {
  Expr e;
  std::string name;
  std::string explained{};  // " (n the gradient of C1)", of gradients in the name: no spec has them
};
// Parameters, entries of J, vectors that J is made of and their products: the shortest names first.
std::vector<Candidate> candidates_for_zero(const Subject& subject);

// The poses with C = 0 at which K is singular.
struct Singular {
  enum class Where { nowhere, everywhere, at_zeros, other_branch, somewhere } where = Where::nowhere;
  std::vector<std::string> zeros;  // K is singular under each of these conditions: "u = 0"
  bool by_parameters = false;      // no pose of the bodies alone was found there: parameters had to change
  bool of_poses = false;           // at least one of them depends on the pose
  bool given_up = false;           // the search was too long: there may be more
  std::vector<Sample> poses{};     // if they are asked for: one for each zero, else one
};
// With `drawn`, a regular pose is added to it, and the singular ones have poses near that.
std::vector<Singular> singular_poses(const Subject& subject, const std::vector<Freedom>& freedoms,
                                     std::vector<PoseToDraw>* drawn = nullptr);
// Vectors without a direction whose guards in the kernel leave K singular, whatever C is.
std::vector<std::string> guards_that_make_singular(const Subject& subject, const Freedom& everything);

}  // namespace cdot::derive
