// Formulas as a person writes them on paper. Equal expressions share one normal form in Expr; a derivation also needs
// the forms in between: "(w_b × t) · u" before it becomes "-(u × t) w_b". These trees therefore simplify nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

enum class Shape {
  leaf,  // a symbol or a named expression
  number,
  sum,        // args, each with its sign
  product,    // args side by side
  quotient,   // args[0] / args[1]
  power,      // args[0]^exponent
  dot,        // args[0] · args[1]
  cross,      // args[0] × args[1]; scalar × vector is w × r
  perp,       // a quarter turn to the left
  norm,       // |args[0]|
  unit,       // direction of args[0]
  component,  // args[0].x or .y; `name` says which
  call,       // name(args...)
  transpose,  // args[0]'
  skew,       // S(args[0]), the column with S(r) w = w × r
  identity,   // E
  matrix      // args row by row, `columns` of them a row
};

struct Formula {
  Shape shape = Shape::number;
  Expr leaf;
  std::string name;
  Rational number;
  int exponent = 1;
  int columns = 0;
  std::vector<bool> minus;  // of a sum's args
  std::vector<Formula> args;

  friend bool operator==(const Formula& f, const Formula& g) = default;
};

struct SignedFormula {
  bool minus = false;
  Formula formula;
};

Formula leaf(Expr e, std::string name = {});
Formula number(Rational value);
Formula sum(std::vector<SignedFormula> terms);  // of no terms: 0
Formula negative(Formula f);
Formula product(std::vector<Formula> factors);  // leaves out ones; of no factors: 1
Formula quotient(Formula above, Formula below);
Formula power(Formula base, int exponent);
Formula dot(Formula u, Formula v);
Formula cross(Formula u, Formula v);
Formula shaped(Shape kind, Formula arg);  // perp, norm, unit, transpose, skew
Formula component(Formula u, std::string axis);
Formula identity();
Formula matrix(int columns, std::vector<Formula> entries);

bool is_one(const Formula& f);
// f as terms with signs: a sum's own, or f alone.
std::vector<SignedFormula> terms_of(const Formula& f);

// A number times f, f/2 for a half.
Formula times(Rational magnitude, Formula f);

// Terms with a plus sign first, else in their order.
std::vector<SignedFormula> positive_first(std::vector<SignedFormula> terms);
// True if two formulas have the same terms, in any order.
bool same_terms(const Formula& f, const Formula& g);

// The value of a formula without matrices.
Expr value_of(const Formula& f, Pool& pool);

// The name of the component that a product with this world axis takes: "x", "y"; empty for other vectors.
std::string world_axis(Expr axis);

// How expressions of a joint are written: with the author's names for lets and points.
class Notation {
 public:
  explicit Notation(const Joint& joint);

  Formula of(Expr e) const;          // a named expression is its name
  Formula definition(Expr e) const;  // what stands behind the name

  struct Point {
    std::string name;
    Expr position, arm, value;
  };
  // The points x + arm hidden among a sum's terms: for each term its point, or none; the arm's term is marked used.
  struct PointTerms {
    std::vector<const Point*> at;
    std::vector<bool> used;
  };
  PointTerms points_among(Expr sum) const;

  // Gives names to what recurs in these expressions, if they are long.
  void share(std::span<const Expr> roots);
  const std::vector<Expr>& shared() const { return shared_; }  // operands before users
  std::string shared_name(Expr e) const;                       // empty: it has none

  static bool has_name(Expr e);  // given by the author, or a rate of such a thing

 private:
  Formula written(Expr e) const;
  Formula sum_of(Expr e) const;
  Formula product_of(Expr e) const;
  Formula dot_of(Expr e) const;
  Formula cross_of(Expr e) const;
  Formula scale_of(Expr e) const;

  std::vector<Point> points_;
  std::vector<std::string> taken_;
  std::vector<Expr> shared_;
  std::map<const Node*, std::string> names_of_shared_;
};

}  // namespace cdot::derive
