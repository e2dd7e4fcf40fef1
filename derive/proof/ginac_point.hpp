// GiNaC's expressions at one random point modulo a prime. The values decide the zero-test, up to a vanishing
// probability, and sort terms in the same way on every run.
#pragma once

#include <unordered_map>
#include <vector>

#include "derive/numbers/modular_point.hpp"
#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

class PointValues {
 public:
  // `of_squares`: only squares have roots, as among the reals. `of_all`: every number has some value as its root.
  enum class Roots { of_squares, of_all };
  PointValues(std::uint64_t seed, Roots roots) : point_(seed), roots_(roots) {}

  // Draws a small whole number, as angles require.
  void put(const ex& symbol) { values_[symbol] = Modular(point_.small()); }
  void put_direction(const std::vector<ex>& unit_vector);

  Modular of(const ex& e);
  bool holds_for_reals() const { return point_.holds_for_reals(); }

 private:
  Modular compound(const ex& e);
  Modular power(Modular base, const numeric& exponent);
  Modular function(const ex& e);

  ModularPoint point_;
  Roots roots_;
  std::unordered_map<ex, Modular, std::hash<ex>, SameExpression> values_;
};

}  // namespace cdot::derive
