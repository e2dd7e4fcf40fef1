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
  void put(const ex& symbol) { values_[symbol] = {Modular(point_.small())}; }
  void put_direction(const std::vector<ex>& unit_vector);

  // Throws UndefinedHere, also of an earlier call.
  Modular of(const ex& e);
  // True of the latest value of(e), as in ModularPoint.
  bool holds_for_reals() const { return holds_for_reals_; }
  std::size_t values() const { return values_.size(); }  // known so far: the work that was done

 private:
  struct Value {
    Modular value;
    bool holds_for_reals = true, defined = true;
  };

  Modular part(const ex& e);
  Modular judged(Fn fn, std::span<const Modular> args);
  Modular compound(const ex& e);
  Modular power(Modular base, const numeric& exponent);
  Modular function(const ex& e);

  ModularPoint point_;
  Roots roots_;
  bool holds_for_reals_ = true;
  std::unordered_map<ex, Value, std::hash<ex>, SameExpression> values_;
};

}  // namespace cdot::derive
