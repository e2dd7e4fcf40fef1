#include "derive/proof/ginac_walks.hpp"

#include <algorithm>
#include <cmath>

namespace cdot::derive {

Partials::Partials(const ex& f) {
  for (std::size_t i = 0; i < f.nops(); ++i) symbols.push_back(GiNaC::realsymbol());
  const ex call = is_a<GiNaC::power>(f) ? pow(symbols[0], symbols[1])
                                        : ex(GiNaC::function(ex_to<GiNaC::function>(f).get_serial(), symbols));
  for (const ex& symbol : symbols) slopes.push_back(call.diff(ex_to<GiNaC::symbol>(symbol)));
}

void Slope::spend(std::size_t operands) {
  left_ -= std::min(left_, static_cast<std::int64_t>(operands));
  if (left_ == 0) throw TooLong{};
}

ex Slope::of(const ex& e) {
  if (e.is_equal(symbol_)) return 1;
  if (is_a<GiNaC::symbol>(e)) return of_leaf_(e);
  if (e.nops() == 0) return 0;
  if (const auto found = done_.find(e); found != done_.end()) return found->second;
  const ex slope = compound(e);
  done_.emplace(e, slope);
  return slope;
}

ex Slope::compound(const ex& e) {
  spend(e.nops());
  if (is_a<GiNaC::add>(e)) {
    GiNaC::exvector terms;
    for (const ex& term : e) terms.push_back(of(term));
    return GiNaC::add(terms);
  }
  if (is_a<GiNaC::mul>(e)) return of_product(e);
  if (is_a<GiNaC::power>(e) && is_a<numeric>(e.op(1))) {
    const ex slope = of(e.op(0));
    return slope.is_zero() ? slope : e.op(1) * pow(e.op(0), e.op(1) - 1) * slope;
  }
  return of_function(e);
}

// (x y z)' = x' y z + x y' z + x y z'
ex Slope::of_product(const ex& e) {
  const GiNaC::exvector factors(e.begin(), e.end());
  GiNaC::exvector terms;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    GiNaC::exvector term = factors;
    term[i] = of(factors[i]);
    if (term[i].is_zero()) continue;
    spend(factors.size() + term[i].nops());
    terms.push_back(GiNaC::mul(term));
  }
  return GiNaC::add(terms);
}

ex Slope::of_function(const ex& e) {
  const Partials partials(e);
  GiNaC::exmap arguments;
  for (std::size_t i = 0; i < e.nops(); ++i) arguments.emplace(partials.symbols[i], e.op(i));
  GiNaC::exvector terms;
  for (std::size_t i = 0; i < e.nops(); ++i) {
    const ex slope = of(e.op(i));
    if (!slope.is_zero()) terms.push_back(partials.slopes[i].subs(arguments, GiNaC::subs_options::no_pattern) * slope);
  }
  return GiNaC::add(terms);
}

namespace {

// Rebuilds an expression from its leaves, each part once.
class Rebuilt final : public GiNaC::map_function {
 public:
  explicit Rebuilt(const GiNaC::exmap& symbols) : symbols_(symbols) {}

  ex operator()(const ex& e) override {
    if (e.nops() == 0) return leaf(e);
    if (const auto found = done_.find(e); found != done_.end()) return found->second;
    const ex rebuilt = e.map(*this);
    done_.emplace(e, rebuilt);
    return rebuilt;
  }

 private:
  ex leaf(const ex& e) const {
    const auto found = symbols_.find(e);
    return found == symbols_.end() ? e : found->second;
  }

  const GiNaC::exmap& symbols_;
  std::unordered_map<ex, ex, std::hash<ex>, SameExpression> done_;
};

// Bounds on what multiplying out takes: the terms of the result, and of all parts on all paths to them.
class Expansion {
 public:
  struct Bound {
    double terms = 1, work = 1;
  };

  Bound of(const ex& e) {
    if (e.nops() == 0) return {};
    if (const auto found = done_.find(e); found != done_.end()) return found->second;
    const Bound bound = compound(e);
    done_.emplace(e, bound);
    return bound;
  }

 private:
  Bound compound(const ex& e) {
    const bool sum = is_a<GiNaC::add>(e), product = is_a<GiNaC::mul>(e);
    if (is_a<GiNaC::power>(e) && e.op(1).info(GiNaC::info_flags::posint)) {
      const Bound base = of(e.op(0));
      const double terms = std::pow(base.terms, ex_to<numeric>(e.op(1)).to_double());
      return {terms, base.work + terms};
    }
    Bound bound{sum ? 0. : 1., 1};
    for (const ex& part : e) {
      const Bound of_part = of(part);
      if (sum) bound.terms += of_part.terms;
      if (product) bound.terms *= of_part.terms;
      bound.work += of_part.work;
    }
    bound.work += bound.terms;
    return bound;
  }

  std::unordered_map<ex, Bound, std::hash<ex>, SameExpression> done_;
};

class NumericSlope {
 public:
  explicit NumericSlope(const ex& symbol) : symbol_(symbol) {}

  std::optional<numeric> of(const ex& e) {
    if (e.nops() == 0) return numeric(e.is_equal(symbol_) ? 1 : 0);
    if (const auto found = done_.find(e); found != done_.end()) return found->second;
    const std::optional<numeric> slope = compound(e);
    done_.emplace(e, slope);
    return slope;
  }

 private:
  std::optional<numeric> compound(const ex& e) {
    numeric total(0);
    bool constant = true;
    for (const ex& part : e) {
      const std::optional<numeric> slope = of(part);
      if (!slope) return std::nullopt;
      total = total.add(*slope);
      constant = constant && slope->is_zero();
    }
    if (constant || is_a<GiNaC::add>(e)) return total;
    const bool scaled = is_a<GiNaC::mul>(e) && e.nops() == 2 && is_a<numeric>(e.op(1));
    return scaled ? std::optional(total.mul(ex_to<numeric>(e.op(1)))) : std::nullopt;
  }

  const ex& symbol_;
  std::unordered_map<ex, std::optional<numeric>, std::hash<ex>, SameExpression> done_;
};

}  // namespace

std::optional<numeric> numeric_slope(const ex& e, const ex& symbol) { return NumericSlope(symbol).of(e); }

std::optional<ex> expanded_if_short(const ex& e) {
  constexpr double most_terms = 20000;
  return Expansion().of(e).work > most_terms ? std::nullopt : std::optional(e.expand());
}

ex substituted(const ex& e, const GiNaC::exmap& symbols) { return Rebuilt(symbols)(e); }

std::set<ex, GiNaC::ex_is_less> symbols_of(const ex& e) {
  std::set<ex, GiNaC::ex_is_less> symbols;
  std::set<ex, GiNaC::ex_is_less> seen;
  const auto visit = [&](auto&& self, const ex& part) -> void {
    if (is_a<GiNaC::symbol>(part)) symbols.insert(part);
    if (part.nops() == 0 || !seen.insert(part).second) return;
    for (const ex& operand : part) self(self, operand);
  };
  visit(visit, e);
  return symbols;
}

}  // namespace cdot::derive
