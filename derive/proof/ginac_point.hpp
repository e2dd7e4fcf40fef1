// GiNaC's expressions at one random point modulo a prime. The values decide the zero-test, up to a vanishing
// probability, and sort terms in the same way on every run.
#pragma once

#include <unordered_map>
#include <vector>

#include "derive/numbers/modular_point.hpp"
#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

// An expression as steps, operands before their users: quicker than the tree where several points follow.
class Steps {
 public:
  explicit Steps(const ex& e) { place_of(e); }

 private:
  friend class PointValues;
  struct Step {
    ex e;                  // a leaf, or the exponent of a power
    std::optional<Fn> fn;  // none of a function that no table knows
    enum class Kind { leaf, sum, product, power, function } kind;
    std::size_t begin, end;  // its operands
  };

  std::size_t place_of(const ex& e);

  std::vector<Step> steps_;
  std::vector<std::size_t> operands_;
  std::unordered_map<ex, std::size_t, std::hash<ex>, SameExpression> places_;
};

class PointValues {
 public:
  // `of_squares`: only squares have roots, as among the reals. `of_all`: every number has some value as its root.
  enum class Roots { of_squares, of_all };
  PointValues(std::uint64_t seed, Roots roots) : point_(seed), roots_(roots) {}

  // Draws a small whole number, as angles require.
  void put(const ex& symbol) { values_[symbol] = Modular(point_.small()); }
  void put_direction(const std::vector<ex>& unit_vector);

  Modular of(const ex& e);
  Modular of(const Steps& e);
  bool holds_for_reals() const { return point_.holds_for_reals(); }

 private:
  Modular compound(const ex& e);
  Modular power(Modular base, const numeric& exponent);
  Modular function(const std::optional<Fn>& fn, std::span<const Modular> args);
  Modular of_step(const Steps& all, const Steps::Step& step, const std::vector<Modular>& values);

  ModularPoint point_;
  Roots roots_;
  std::unordered_map<ex, Modular, std::hash<ex>, SameExpression> values_;
};

}  // namespace cdot::derive
