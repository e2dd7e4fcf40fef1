// GiNaC's expressions at one random point modulo a prime. The values decide the zero-test, up to a vanishing
// probability, and sort terms in the same way on every run.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "derive/numbers/modular_point.hpp"
#include "derive/proof/ginac_functions.hpp"

namespace cdot::derive {

// Expressions as steps, operands before their users, each part once: quicker than trees where many points and
// expressions follow.
class Steps {
 public:
  std::size_t place_of(const ex& e);  // of its last step
  // The places of all parts of the expression at `last`, operands first; not those that are known, nor their parts.
  std::vector<std::size_t> parts_of(std::size_t last, const std::function<bool(std::size_t)>& known = {});
  // The expression at this place, if it has no operands; else 0.
  ex leaf(std::size_t place) const { return steps_[place].kind == Kind::leaf ? steps_[place].e : 0; }
  // The place of d/dsymbol of the step at `last`: steps of its own, without GiNaC's normal forms.
  std::size_t slope(std::size_t last, const ex& symbol);
  // From now on the symbol is a step of its own, with the value of the step at `place`; returns its place.
  std::size_t define(const ex& symbol, std::size_t place) {
    return places_[symbol] = add(Kind::sum, std::span(&place, 1));
  }
  // Powers and functions may have no value.
  bool is_partial(std::size_t place) const { return steps_[place].kind >= Kind::power; }
  bool is_root(std::size_t place) const { return steps_[place].root; }
  // The number of roots nested in this step, itself included.
  std::size_t level(std::size_t place) const { return steps_[place].level; }
  std::span<const std::size_t> operands(std::size_t place) const {
    return std::span(operands_).subspan(steps_[place].begin, steps_[place].end - steps_[place].begin);
  }
  std::size_t size() const { return steps_.size(); }
  // The value of the last of these parts where symbols have these values, with GiNaC's present number of digits. Throws
  // where it has none.
  numeric in_decimals(std::span<const std::size_t> parts, const GiNaC::exmap& symbols) const;

 private:
  friend class PointValues;
  enum class Kind { leaf, sum, product, power, function };
  struct Step {
    Kind kind;
    ex e;                    // of a leaf, power or function
    std::optional<Fn> fn;    // none of a function that no table knows
    std::size_t begin, end;  // its operands
    bool root;               // a power k/2
    bool constant;           // without symbols
    std::size_t level;
    std::optional<Modular> number;  // the value of a leaf that is one
  };

  numeric in_decimals(const Step& step, const std::vector<numeric>& values, const GiNaC::exmap& symbols) const;
  void put(const ex& symbol, std::size_t place) { places_[symbol] = place; }
  std::size_t add(Kind kind, std::span<const std::size_t> operands, const ex& e = 0);
  std::size_t sum(std::span<const std::size_t> terms);
  std::size_t product(std::span<const std::size_t> factors);
  std::map<std::size_t, std::size_t> gradient(std::size_t last);
  std::vector<std::size_t> factors_of_slopes(const Step& step, std::span<const std::size_t> operands);

  std::vector<Step> steps_;
  std::vector<std::size_t> operands_;
  std::unordered_map<ex, std::size_t, std::hash<ex>, SameExpression> places_;
  std::unordered_map<std::size_t, std::map<std::size_t, std::size_t>> gradients_;  // slopes by step and symbol
  std::vector<std::size_t> visits_;                                                // by place: the last one
  std::size_t visit_ = 0;
};

class PointValues {
 public:
  // `of_squares`: only squares have roots, as among the reals. `of_all`: every number has some value as its root.
  enum class Roots { of_squares, of_all };
  PointValues(std::uint64_t seed, Roots roots) : point_(seed), roots_(roots) {}

  void draw_by(std::uint64_t seed) { point_.draw_by(seed); }
  // Draws a small whole number, as angles require.
  void put(const ex& symbol) { values_[symbol] = Modular(point_.small()); }
  void put_direction(const std::vector<ex>& unit_vector);
  void forget(const ex& symbol) { values_.erase(symbol); }

  Modular of(const ex& e);
  // The values of steps by place, and whether they hold for the reals. Values of other generations are none.
  struct Known {
    Modular value;
    std::uint32_t generation = 0;
    bool holds_for_reals = true;
  };
  struct KnownValues {
    std::vector<Known> values;
    std::uint32_t generation = 1;
    std::uint32_t last = 0;  // in which a value was added
    bool any() const { return last == generation; }
    bool has(std::size_t place) const { return place < values.size() && values[place].generation == generation; }
  };
  // Adds the values of these parts. Of the parts without a value those are told whose operands have one.
  struct Undefined {
    std::vector<std::size_t> roots;  // of non-squares
    std::vector<std::size_t> never;  // a divisor is zero, or no rule is known: another point is unlikely to help
    bool empty() const { return roots.empty() && never.empty(); }
  };
  // `source` puts a symbol that has no value yet.
  using Source = std::function<void(const ex&)>;
  Undefined evaluate(const Steps& all, std::span<const std::size_t> parts, KnownValues& known, const Source& source);

 private:
  Modular compound(const ex& e);
  Modular power(Modular base, const numeric& exponent);
  Modular function(const std::optional<Fn>& fn, std::span<const Modular> args);
  Modular of_step(const Steps& all, const Steps::Step& step, const KnownValues& known);

  ModularPoint point_;
  Roots roots_;
  std::unordered_map<ex, Modular, std::hash<ex>, SameExpression> values_;
};

}  // namespace cdot::derive
