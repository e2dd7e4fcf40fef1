// GiNaC's view of a joint's expressions, and a decision whether one of them vanishes. Nothing that
// includes this header hands GiNaC's text on: its order of terms changes from run to run.
#pragma once

#include <ginac/ginac.h>

#include <optional>
#include <stdexcept>
#include <vector>

#include "derive/derivation.hpp"
#include "derive/ginac_point.hpp"
#include "derive/numeric.hpp"

namespace cdot::derive {

// Expressions of a joint as GiNaC's, over one of two sets of coordinates:
//   names  arms and directions are symbols r_x, r_y, whose time derivative is w x r; in space a triad is A(e) of Euler
//          parameters of its own, de/dt = 1/2 G^T w
//   raw    every body is x, y, theta, in space x, y, z and Euler parameters e; what is fixed in it is R(theta) or A(e)
//          times constants
// In both, rate() is GiNaC's own chain rule over the symbols.
class Algebra final : public Arithmetic<GiNaC::ex> {
 public:
  enum class Route { names, raw };
  Algebra(const Joint& joint, Route route, int immovable = -1);

  GiNaC::ex of(Expr scalar) { return evaluation_.scalar(scalar); }
  Triple<GiNaC::ex> of_vector(Expr vector) { return evaluation_.vector(vector); }
  // Tells the zero test which sums of vectors its expressions are about.
  void shorten(Expr root);
  // The coordinate and velocity symbols of a body: x, y, theta and v_x, v_y, w; in space x, y, z, e0, e1, e2, e3 and
  // v_x, ..., w_z.
  std::vector<GiNaC::ex> coordinates(int body);
  std::vector<GiNaC::ex> velocities(int body);
  // The derivative of e as the body moves along column k of J at unit rate.
  GiNaC::ex slope(const GiNaC::ex& e, int body, std::size_t k);
  // d e/dt along the motion; the velocities count as constant.
  GiNaC::ex rate(const GiNaC::ex& e);
  // Decides whether e vanishes wherever it is defined, given that unit vectors have length 1 and so
  // on.
  enum class Zero {
    yes,    // by algebra
    shown,  // too much for algebra, but zero at `exact_points` random points modulo a prime
    no,
    undecided
  };
  Zero is_zero(const GiNaC::ex& e);
  bool vanishes(const GiNaC::ex& e) { return is_zero(e) <= Zero::shown; }
  // After Zero::no: a pose at which it shows, in the joint's names, and how much it is there.
  const std::string& witness() const { return witness_; }
  // Reduced by the same relations: a numerator as a polynomial, zero where e is; the second one
  // without what cancels.
  std::optional<GiNaC::ex> numerator(const GiNaC::ex& e);
  std::optional<GiNaC::ex> reduced_numerator(const GiNaC::ex& e);
  GiNaC::ex other_coordinates(const GiNaC::ex& polynomial);
  // The factors of such a numerator, in the joint's names: "u_x", "ratio".
  std::vector<std::string> factors_of(const GiNaC::ex& polynomial) const;
  std::vector<GiNaC::ex> symbols_in(const GiNaC::ex& e) const;

  GiNaC::ex number(Rational value) override;
  GiNaC::ex scalar_leaf(const Node& symbol) override;
  Triple<GiNaC::ex> vector_leaf(const Node& symbol) override;
  GiNaC::ex inverse(const GiNaC::ex& x) override { return GiNaC::pow(x, -1); }
  GiNaC::ex call(Fn fn, std::span<const GiNaC::ex> args) override;

 private:
  // A symbol that stands for a compound, with the relation that it obeys; it may contain earlier
  // ones.
  struct Atom {
    enum class Kind { square, inverse } kind;  // symbol^2 = operand; symbol operand = 1
    GiNaC::realsymbol symbol;  // kept as what it is: a copy as plain `symbol` would be another one
    GiNaC::ex operand;
  };
  struct Leaf {
    GiNaC::realsymbol symbol;
    GiNaC::ex rate;
  };

  GiNaC::ex leaf(const std::string& name, const GiNaC::ex& rate);
  Triple<GiNaC::ex> free_vector(const Node& symbol);
  Triple<GiNaC::ex> vector_of_body(const Node& symbol);
  // Euler parameters that are nobody's function; of `body`, they turn with it.
  EulerParameters<GiNaC::ex> orientation(const std::string& name, int body);
  bool moves(int body) const { return body >= 0 && body != immovable_; }

  bool replace(const GiNaC::ex& x, const GiNaC::ex& compound, const std::string& name);
  GiNaC::ex in_names(GiNaC::ex e) const;
  GiNaC::ex atomised(const GiNaC::ex& e);
  GiNaC::ex atomised_power(const GiNaC::ex& base, const GiNaC::ex& exponent);
  GiNaC::ex atomised_function(const GiNaC::ex& e);
  GiNaC::ex inverse_of(const GiNaC::ex& base);
  GiNaC::ex root_of(const GiNaC::ex& base);
  GiNaC::ex turned(bool cosine, const GiNaC::ex& angle);
  GiNaC::ex symbol_for(const GiNaC::ex& compound);
  bool differs_at_random(const GiNaC::ex& e, std::uint64_t seed);
  bool vanishes_at_points(const GiNaC::ex& e) const;

  // What one test, and all tests together, may take, in factors of terms that are multiplied. Every
  // test that is given up halves what the next may take: it is likely to be as long.
  static constexpr std::int64_t most_work = 500000, least_work = most_work / 64;
  static constexpr std::int64_t most_work_in_all = 6 * most_work;
  struct TooLong : std::runtime_error {
    TooLong() : std::runtime_error("too much to multiply out") {}
  };
  void spend(std::size_t work);  // throws TooLong
  GiNaC::exvector ordered(const GiNaC::ex& e);
  Modular fingerprint(const GiNaC::ex& e);
  GiNaC::realsymbol fresh_symbol(const std::string& name = "");
  GiNaC::ex multiplied(const GiNaC::ex& a, const GiNaC::ex& b);
  GiNaC::ex raised(const GiNaC::ex& polynomial, int exponent);
  GiNaC::ex expanded(const GiNaC::ex& e);
  GiNaC::ex square_reduced(const GiNaC::ex& polynomial, const GiNaC::symbol& symbol,
                           const GiNaC::ex& square);
  GiNaC::ex inverse_removed(const GiNaC::ex& polynomial, const GiNaC::symbol& symbol,
                            const GiNaC::ex& operand);
  GiNaC::ex inverse_cancelled(const GiNaC::ex& polynomial, const GiNaC::symbol& symbol,
                              const GiNaC::ex& operand);
  GiNaC::ex reduced(const GiNaC::ex& polynomial);
  GiNaC::ex without_inverses(const GiNaC::ex& polynomial);

  const Joint& joint_;
  Route route_;
  int immovable_;
  std::map<std::string, Leaf> leaves_;
  std::vector<Atom> atoms_;
  std::vector<std::vector<GiNaC::ex>> units_;  // symbols whose squares sum to 1
  GiNaC::exmap known_;             // compounds that have been replaced, as GiNaC wrote them
  GiNaC::exmap inverses_;          // by their operand in normal form
  std::vector<std::pair<GiNaC::ex, GiNaC::ex>> roots_;  // operand -> symbol
  std::vector<std::pair<GiNaC::ex, std::array<GiNaC::ex, 2>>> turns_;  // angle -> (cos, sin)
  GiNaC::exmap change_;  // of variables, before an expression is tested
  std::vector<std::pair<GiNaC::ex, GiNaC::ex>>
      meanings_;  // of symbols without a name, as they came up
  std::int64_t allowance_ = most_work, left_for_test_ = most_work, left_in_all_ = most_work_in_all;
  PointValues prints_{1, PointValues::Roots::of_all};  // of every symbol, by when it came up
  std::string witness_;
  Evaluation<GiNaC::ex> evaluation_;
};

// e or -e, so that its first term by name is positive: what is zero where e is, in one form.
Expr with_leading_sign(Expr e);

}  // namespace cdot::derive
