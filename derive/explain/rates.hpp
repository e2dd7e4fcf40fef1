// Time derivatives rule by rule: the forms that the rules of derivation/rate_rules.hpp give before they are simplified,
// each with its name. What has a name is differentiated once and then called by it (u_dot).
#pragma once

#include <set>

#include "derive/derivation/rate_rules.hpp"
#include "derive/explain/explain.hpp"

namespace cdot::derive {

class Rates {
 public:
  Rates(const Joint& joint, const Notation& notation) : joint_(joint), notation_(notation) {}

  // left = d e/dt by its rules = the same with all names inserted. Before it come the chains of the
  // names it needs that no earlier call has introduced.
  std::vector<Chain> differentiate(Expr e, Formula left);

  // d e/dt with all names inserted: a form in which only v and w move. Nothing if that is long.
  std::optional<Formula> inserted(Expr e);

  // The algebra of the rules: a formula as they write it, none where it is zero.
  struct Written {
    std::optional<Formula> formula;

    friend bool is_zero(const Written& a) { return !a.formula; }
    friend Written operator+(const Written& a, const Written& b) {
      if (!a.formula || !b.formula) return a.formula ? a : b;
      return {sum({{false, *a.formula}, {false, *b.formula}})};
    }
    friend Written operator-(const Written& a) { return a.formula ? Written{negative(*a.formula)} : a; }
    friend Written operator-(const Written& a, const Written& b) { return a + -b; }
    friend Written operator*(const Written& a, const Written& b) {
      return both(a, b, [](const Formula& f, const Formula& g) { return product({f, g}); });
    }
    friend Written operator/(const Written& a, const Written& b) { return both(a, b, quotient); }
    friend Written cross(const Written& a, const Written& b) {
      return both(a, b, [](const Formula& f, const Formula& g) { return derive::cross(f, g); });
    }
    friend Written dot(const Written& a, const Written& b) { return both(a, b, along_axis_or_dot); }
    friend Written perp(const Written& a) { return a.formula ? Written{shaped(Shape::perp, *a.formula)} : a; }
    friend Written pow(const Written& a, int exponent) { return a.formula ? Written{power(*a.formula, exponent)} : a; }

   private:
    template <class Build>
    static Written both(const Written& a, const Written& b, Build build) {
      if (!a.formula || !b.formula) return {};
      return {build(*a.formula, *b.formula)};
    }
    // The component along an axis of the world is written u.x.
    static Formula along_axis_or_dot(const Formula& f, const Formula& g);
  };
  using Value = Written;
  Written operand(Expr e) const { return {notation_.of(e)}; }
  Written nothing(Expr) const { return {}; }
  Written rate(Expr e);
  std::vector<Addend> addends(Expr sum) const;
  Written total(Expr e, const std::vector<Weighted<Written>>& terms) const;
  Written monomial(Rational coef, std::span<const Expr> bases, std::span<const int> exponents,
                   const Written& rate) const;
  Written times(Expr factor, const Written& rate) const;
  void rule(const auto&... words) { take_note((std::string() + ... + std::string(words))); }

 private:
  Formula by_rules(Expr e);
  Written by_name(Expr e, const std::string& name);
  Chain chain(Expr e, Formula left);
  std::size_t place_of(std::string name) const;  // among the author's lets
  void take_note(const std::string& rule);

  const Joint& joint_;
  const Notation& notation_;
  static constexpr int most_insertions = 150;
  struct TooLong {};
  bool insert_ = false;
  int insertions_ = 0;
  std::set<std::string> introduced_;
  std::vector<std::string> rules_;
  std::vector<Chain> chains_;
};

}  // namespace cdot::derive
