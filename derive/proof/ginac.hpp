// A joint's expressions in GiNaC, and the zero-test. No includer may print GiNaC's own text: its order of terms changes
// from run to run.
#pragma once

#include <optional>
#include <stdexcept>
#include <vector>

#include "derive/derivation/derivation.hpp"
#include "derive/numbers/numeric.hpp"
#include "derive/proof/ginac_point.hpp"
#include "derive/proof/ginac_walks.hpp"
#include "derive/proof/polynomial.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {

// Expressions of a joint as GiNaC's, over one of two sets of coordinates:
//   names  arms and directions are symbols r_x, r_y, whose time derivative is w x r; in space a triad is A(e) of Euler
//          parameters of its own, de/dt = 1/2 G^T w
//   raw    every body is x, y, theta, in space x, y, z and Euler parameters e; what is fixed in it is R(theta) or A(e)
//          times constants
// In both, rate() is GiNaC's own chain rule over the symbols.
class Algebra final : public Arithmetic<ex> {
 public:
  enum class Route { names, raw };
  // `slopes` is the work of derivatives in GiNaC, in operands of sums and products.
  Algebra(const Joint& joint, Route route, int immovable = -1, std::int64_t slopes = most_slopes);

  // Both throw NumberTooLarge where the numbers of GiNaC's exact form would never end.
  ex of(Expr scalar) { return evaluation_.scalar(with_short_numbers(scalar)); }
  Triple<ex> of_vector(Expr vector) { return evaluation_.vector(with_short_numbers(vector)); }
  // Introduces variables for the sums of vectors in `root`, which shortens the polynomials of the zero-test.
  void shorten(Expr root);
  // The coordinate and velocity symbols of a body: x, y, theta and v_x, v_y, w; in space x, y, z, e0, e1, e2, e3 and
  // v_x, ..., w_z.
  std::vector<ex> coordinates(int body);
  std::vector<ex> velocities(int body);
  // de/dsymbol. It is zero for the velocity of an immovable body, which is the number 0. Where GiNaC's derivatives
  // become too long, it is a symbol that has a value at points only: then the zero-test shows, but does not prove.
  ex derivative(const ex& e, const ex& symbol);
  // The same if it is a number other than zero; else zero.
  ex constant_slope(const ex& e, const ex& symbol);
  // The derivative of e as the body moves along column k of J at unit rate.
  ex slope(const ex& e, int body, std::size_t k);
  // de/dt along the motion, at constant velocities.
  ex rate(const ex& e);
  // The zero-test: does e vanish wherever it is defined, under the relations of its symbols (unit vectors have length
  // 1, and so on)? Arithmetic modulo the prime decides. GiNaC then proves each zero that it can reduce as a polynomial
  // within its budget.
  enum class Zero {
    yes,    // by algebra
    shown,  // zero at `exact_points` random points modulo a prime; too expensive for algebra
    no,
    undecided
  };
  Zero is_zero(const ex& e);
  bool vanishes(const ex& e) { return is_zero(e) <= Zero::shown; }
  // A pose at which e is not zero, in the joint's names, and its value there; empty if none was found.
  std::string witness(const ex& e);
  // The numerator of e as a polynomial, reduced by the same relations; `cancelled`: without common factors. Empty if it
  // exceeds the budget.
  std::optional<ex> numerator(const ex& e, bool cancelled = false);
  ex other_coordinates(const ex& polynomial);
  // The factors of such a numerator, in the joint's names: "u_x", "ratio".
  std::vector<std::string> factors_of(const ex& polynomial) const;
  std::vector<ex> symbols_in(const ex& e) const;

  ex number(Rational value) override;
  ex scalar_leaf(const Node& symbol) override;
  Triple<ex> vector_leaf(const Node& symbol) override;
  ex inverse(const ex& x) override { return GiNaC::pow(x, -1); }
  ex call(Fn fn, std::span<const ex> args) override;

 private:
  // A symbol for a compound, with the relation that it obeys. The compound may contain earlier atoms.
  struct Atom {
    enum class Kind { square, inverse } kind;  // symbol^2 = operand; symbol operand = 1
    GiNaC::realsymbol symbol;                  // not `symbol`: a plain copy would be another symbol
    ex operand;
    Polynomial terms;  // the same
  };
  struct Leaf {
    GiNaC::realsymbol symbol;
    ex rate;
  };

  Expr with_short_numbers(Expr e);
  ex derivative_at_points(const ex& e, const ex& symbol);
  ex leaf(const std::string& name, const ex& rate);
  void add_unit(std::vector<ex> components);
  Triple<ex> free_vector(const Node& symbol);
  Triple<ex> vector_of_body(const Node& symbol);
  // Independent Euler parameters; those of `body` rotate with it.
  EulerParameters<ex> orientation(const std::string& name, int body);
  bool moves(int body) const { return body >= 0 && body != immovable_; }

  bool replace(const ex& x, const ex& compound, const std::string& name);
  ex in_names(ex e) const;
  ex atomised(const ex& e);
  ex atomised_power(const ex& base, const ex& exponent);
  ex atomised_function(const ex& e);
  ex inverse_of(const ex& base);
  ex root_of(const ex& base);
  ex turned(bool cosine, const ex& angle);
  ex symbol_for(const ex& compound);
  void relate(Atom::Kind kind, const ex& symbol, const ex& operand);
  std::string difference_at(const ex& e, std::span<const std::size_t> parts, std::uint64_t seed);
  // A point, and what is known there.
  struct Point : Draws {
    using Draws::Draws;
    std::optional<PointValues> values;
    PointValues::KnownValues known;
    std::pair<Modular, bool> value_at(std::size_t place) const {
      return {known.values[place].value, known.values[place].holds_for_reals};
    }
  };
  // The value drawn for the part at this place.
  const Draws::Leaves& leaves_at(std::size_t place);
  void put(const Draws& draws, const ex& symbol, PointValues& values) const;
  std::vector<std::vector<std::size_t>> order_of_trial(const std::vector<std::size_t>& parts) const;
  void draw_again(Point& point, std::span<const std::size_t> roots, std::span<const std::size_t> without_value);
  std::vector<std::size_t> related(std::vector<std::size_t> without_value, std::span<const std::size_t> roots);
  Nullity nullity_of(const std::vector<std::size_t>& parts);

  // Budgets of one test and of all tests together, in factors of multiplied terms. A test that exceeds its budget
  // halves that of the next one, which is likely to be as expensive.
  static constexpr std::int64_t most_work = 500000, least_work = most_work / 64;
  static constexpr std::int64_t most_work_in_all = 6 * most_work;
  // Steps at points of all tests together, a hundred times what the catalogue takes. Later tests give up earlier.
  static constexpr std::int64_t most_work_at_points = 200000000;
  static constexpr std::uint64_t attempts_at_points = 1 << 18, least_attempts = 64;
  struct TooLong : std::runtime_error {
    TooLong() : std::runtime_error("too much to multiply out") {}
  };
  void spend(std::size_t work);  // throws TooLong
  GiNaC::exvector ordered(const ex& e);
  Modular fingerprint(const ex& e);
  GiNaC::realsymbol fresh_symbol(const std::string& name = "");
  Polynomial multiplied(const Polynomial& a, const Polynomial& b);
  Polynomial multiplied(std::vector<Polynomial> factors);
  Polynomial raised(const Polynomial& base, int exponent);
  Polynomial polynomial(const ex& e);
  template <class Exponent, class Rest>
  Polynomial in_powers(const Polynomial& p, const ex& x, const Polynomial& base, Exponent exponent, Rest rest);
  Polynomial square_reduced(const Polynomial& p, const ex& x, const Polynomial& square);
  Polynomial inverse_removed(const Polynomial& p, const ex& x, const Polynomial& operand);
  Polynomial without_common_factors(Polynomial p);
  Polynomial reduced(Polynomial p, bool without_inverses);
  ex reduced(const ex& e);
  std::optional<Polynomial> numerator_of(const ex& e, bool cancelled);

  const Joint& joint_;
  Route route_;
  int immovable_;
  std::map<std::string, Leaf> leaves_;
  std::map<ex, Slope, GiNaC::ex_is_less> slopes_;  // by symbol
  std::int64_t left_for_slopes_;
  std::map<std::size_t, ex> slopes_at_points_;  // symbols, by the places of their values
  std::set<std::size_t> places_of_slopes_;      // of these symbols
  Polynomials polynomials_;
  std::vector<Atom> atoms_;
  std::vector<std::vector<ex>> units_;                   // symbols whose squares sum to 1
  GiNaC::exmap known_;                                   // symbols for compounds of which nothing is known
  GiNaC::exmap atomised_;                                // results of atomised(), by compounds in old variables
  GiNaC::exmap inverses_;                                // by their operand in normal form
  std::vector<std::pair<ex, ex>> roots_;                 // operand -> symbol
  std::vector<std::pair<ex, std::array<ex, 2>>> turns_;  // angle -> (cos, sin)
  GiNaC::exmap change_;                                  // of variables, before an expression is tested
  std::vector<std::pair<ex, ex>> meanings_;              // of symbols without a name, as they came up
  std::int64_t allowance_ = most_work, left_for_test_ = most_work, left_in_all_ = most_work_in_all;
  PointValues prints_{1, PointValues::Roots::of_all};  // of every symbol, by when it came up
  Steps steps_;                                        // of all expressions tested so far
  std::vector<Point> points_ = points_for_zero_test<Point>();
  // The leaf with which a symbol is drawn: its own, or the first of its direction.
  std::unordered_map<ex, std::string, std::hash<ex>, SameExpression> drawn_with_;
  std::map<std::string, std::vector<ex>> drawn_together_;           // by leaf
  std::unordered_map<std::size_t, Draws::Leaves> leaves_of_parts_;  // by place
  std::vector<std::vector<std::size_t>> never_together_;            // roots for which no point was found
  std::int64_t left_for_points_ = most_work_at_points;
  std::unordered_map<const Node*, double> bits_;  // of the numbers in an expression, at most
  Evaluation<ex> evaluation_;
};

// e or -e, whichever has a positive first term: one form of expressions with equal zeros.
Expr with_leading_sign(Expr e);

}  // namespace cdot::derive
