#include "derive/proof/ginac_point.hpp"

#include <array>
#include <cstdlib>

namespace cdot::derive {

namespace {

Modular modular(const numeric& n) {
  if (!n.is_rational()) throw UndefinedHere{};
  if (n.is_integer() && abs(n) < numeric(1 << 28)) return Modular(n.to_long());
  const numeric p(static_cast<long>(Modular::prime));
  const auto rest = [&](const numeric& whole) { return Modular(GiNaC::mod(whole, p).to_long()); };
  const Modular denominator = rest(n.denom());
  if (denominator.is_zero()) throw UndefinedHere{};
  return rest(n.numer()) * inverse(denominator);
}

}  // namespace

// By stereographic projection: (1 - t.t, 2 t)/(1 + t.t).
void PointValues::put_direction(const std::vector<ex>& unit_vector) {
  std::vector<Modular> t(unit_vector.size());
  Modular square(0);
  for (std::size_t k = 1; k < t.size(); ++k) {
    t[k] = point_.any();
    square = square + t[k] * t[k];
  }
  const Modular inv = point_.inverse(Modular(1) + square);
  values_[unit_vector[0]] = (Modular(1) - square) * inv;
  for (std::size_t k = 1; k < t.size(); ++k) values_[unit_vector[k]] = (t[k] + t[k]) * inv;
}

Modular PointValues::of(const ex& e) {
  if (is_a<numeric>(e)) return modular(ex_to<numeric>(e));
  if (is_a<GiNaC::constant>(e)) return point_.pi();
  const auto found = values_.find(e);
  if (found != values_.end()) return found->second;
  const Modular value = compound(e);
  values_.emplace(e, value);
  return value;
}

Modular PointValues::compound(const ex& e) {
  if (is_a<GiNaC::add>(e)) {
    Modular total(0);
    for (const ex& term : e) total = total + of(term);
    return total;
  }
  if (is_a<GiNaC::mul>(e)) {
    Modular total(1);
    for (const ex& factor : e) total = total * of(factor);
    return total;
  }
  if (is_a<GiNaC::power>(e) && is_a<numeric>(e.op(1))) {
    return power(of(e.op(0)), ex_to<numeric>(e.op(1)));
  }
  return function(e);
}

Modular PointValues::power(Modular base, const numeric& exponent) {
  const bool whole = exponent.is_integer();
  const numeric times = whole ? exponent : 2 * exponent;
  if (!times.is_integer() || abs(times) > 1000000) throw UndefinedHere{};
  if (!whole)
    base = roots_ == Roots::of_all ? point_.any_for(5, base, base) : point_.call(Fn::sqrt, std::span(&base, 1));
  if (times.is_negative()) base = point_.inverse(base);
  return pow(base, static_cast<std::uint64_t>(std::abs(times.to_int())));
}

Modular PointValues::function(const ex& e) {
  const std::optional<Fn> fn = function_in(e);
  if (!fn) throw UndefinedHere{};
  std::vector<Modular> args;
  for (const ex& arg : e) args.push_back(of(arg));
  return point_.call(*fn, args);
}

}  // namespace cdot::derive
