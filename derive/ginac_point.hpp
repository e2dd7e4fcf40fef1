// GiNaC's expressions at one random point modulo a prime: what decides, up to a vanishing
// probability, where algebra would take too long, and what sorts terms in the same way on every run.
#pragma once

#include <ginac/ginac.h>

#include <map>
#include <vector>

#include "derive/modular_point.hpp"

namespace cdot::derive {

class PointValues {
 public:
  // Only squares have roots, as among the reals; or everything has some value as its root.
  enum class Roots { of_squares, of_all };
  PointValues(std::uint64_t seed, Roots roots) : point_(seed), roots_(roots) {}

  // Small whole numbers, which angles have to be.
  void put(const GiNaC::ex& symbol) { values_[symbol] = Modular(point_.small()); }
  void put_direction(const std::vector<GiNaC::ex>& unit_vector);

  Modular of(const GiNaC::ex& e);

 private:
  Modular compound(const GiNaC::ex& e);
  Modular power(Modular base, const GiNaC::numeric& exponent) const;
  Modular function(const GiNaC::ex& e);

  ModularPoint point_;
  Roots roots_;
  std::map<GiNaC::ex, Modular, GiNaC::ex_is_less> values_;
};

}  // namespace cdot::derive
