#include "derive/proof/ginac_point.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

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

std::optional<Modular> modular_if_any(const numeric& n) {
  try {
    return modular(n);
  } catch (const UndefinedHere&) {
    return std::nullopt;
  }
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
  std::vector<Modular> args;
  for (const ex& arg : e) args.push_back(of(arg));
  return function(function_in(e), args);
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

Modular PointValues::function(const std::optional<Fn>& fn, std::span<const Modular> args) {
  if (!fn) throw UndefinedHere{};
  return point_.call(*fn, args);
}

std::size_t Steps::place_of(const ex& e) {
  if (const auto found = places_.find(e); found != places_.end()) return found->second;
  const bool power = is_a<GiNaC::power>(e) && is_a<numeric>(e.op(1));
  const Kind kind = e.nops() == 0         ? Kind::leaf
                    : is_a<GiNaC::add>(e) ? Kind::sum
                    : is_a<GiNaC::mul>(e) ? Kind::product
                    : power               ? Kind::power
                                          : Kind::function;
  std::vector<std::size_t> operands;
  for (std::size_t i = 0; i < (power ? 1 : e.nops()); ++i) operands.push_back(place_of(e.op(i)));
  const bool whole = kind == Kind::sum || kind == Kind::product;
  return places_[e] = add(kind, operands, whole ? ex(0) : e);
}

std::size_t Steps::add(Kind kind, std::span<const std::size_t> operands, const ex& e) {
  const std::size_t begin = operands_.size();
  operands_.insert(operands_.end(), operands.begin(), operands.end());
  std::size_t level = 0;
  bool constant = !is_a<GiNaC::symbol>(e);
  for (const std::size_t operand : operands) {
    level = std::max(level, steps_[operand].level);
    constant = constant && steps_[operand].constant;
  }
  const bool root =
      kind == Kind::power && !ex_to<numeric>(e.op(1)).is_integer() && (2 * ex_to<numeric>(e.op(1))).is_integer();
  steps_.push_back({kind, e, function_in(e), begin, operands_.size(), root, constant, level + (root ? 1 : 0),
                    kind == Kind::leaf && is_a<numeric>(e) ? modular_if_any(ex_to<numeric>(e)) : std::nullopt});
  return steps_.size() - 1;
}

std::vector<std::size_t> Steps::parts_of(std::size_t last, const std::function<bool(std::size_t)>& known) {
  if (known && known(last)) return {};
  visits_.resize(steps_.size());
  ++visit_;
  std::vector<std::size_t> parts{last};
  visits_[last] = visit_;
  for (std::size_t next = 0; next < parts.size(); ++next) {
    const Step& step = steps_[parts[next]];
    for (std::size_t i = step.begin; i < step.end; ++i) {
      if (visits_[operands_[i]] == visit_) continue;
      visits_[operands_[i]] = visit_;
      if (!known || !known(operands_[i])) parts.push_back(operands_[i]);
    }
  }
  std::ranges::sort(parts);
  return parts;
}

numeric Steps::in_decimals(std::span<const std::size_t> parts, const GiNaC::exmap& symbols) const {
  std::vector<numeric> values(steps_.size());
  for (const std::size_t place : parts) values[place] = in_decimals(steps_[place], values, symbols);
  return values[parts.back()];
}

numeric Steps::in_decimals(const Step& step, const std::vector<numeric>& values, const GiNaC::exmap& symbols) const {
  if (step.kind == Kind::sum || step.kind == Kind::product) {
    numeric total(step.kind == Kind::sum ? 0 : 1);
    for (std::size_t i = step.begin; i < step.end; ++i) {
      const numeric& operand = values[operands_[i]];
      total = step.kind == Kind::sum ? total.add(operand) : total.mul(operand);
    }
    return total;
  }
  ex value = step.e;
  if (step.kind == Kind::power) {
    value = pow(ex(values[operands_[step.begin]]), value.op(1));
  } else if (step.kind == Kind::function) {
    GiNaC::exvector args;
    for (std::size_t i = step.begin; i < step.end; ++i) args.push_back(values[operands_[i]]);
    value = is_a<GiNaC::power>(value) ? pow(args[0], args[1])
                                      : ex(GiNaC::function(ex_to<GiNaC::function>(value).get_serial(), args));
  } else if (const auto known = symbols.find(value); known != symbols.end()) {
    value = known->second;
  }
  value = value.evalf();
  if (!is_a<numeric>(value)) throw std::domain_error("a part has no value");
  return ex_to<numeric>(value);
}

PointValues::Undefined PointValues::evaluate(const Steps& all, std::span<const std::size_t> parts, KnownValues& known,
                                             const Source& source) {
  known.values.resize(all.size());
  known.last = known.generation;
  Undefined undefined;
  for (const std::size_t place : parts) {
    const auto operands = all.operands(place);
    const Steps::Step& step = all.steps_[place];
    if (step.kind == Steps::Kind::leaf && is_a<GiNaC::symbol>(step.e) && !values_.contains(step.e)) source(step.e);
    if (!std::ranges::all_of(operands, [&](std::size_t operand) { return known.has(operand); })) continue;
    point_.begin_anew();
    if (all.is_root(place) && !known.values[operands[0]].value.is_square()) {
      (known.values[operands[0]].value.is_zero() ? undefined.never : undefined.roots).push_back(place);
      continue;
    }
    try {
      const Modular value = of_step(all, step, known);
      const bool real = std::ranges::all_of(operands, [&](std::size_t i) { return known.values[i].holds_for_reals; });
      known.values[place] = {value, known.generation, real && point_.holds_for_reals()};
    } catch (const UndefinedHere&) {
      undefined.never.push_back(place);
    }
  }
  return undefined;
}

Modular PointValues::of_step(const Steps& all, const Steps::Step& step, const KnownValues& known) {
  const auto operand = [&](std::size_t i) { return known.values[all.operands_[i]].value; };
  using Kind = Steps::Kind;
  if (step.kind == Kind::leaf) return step.number ? *step.number : of(step.e);
  if (step.kind == Kind::power) return power(operand(step.begin), ex_to<numeric>(step.e.op(1)));
  if (step.kind == Kind::function) {
    std::vector<Modular> args;
    for (std::size_t i = step.begin; i < step.end; ++i) args.push_back(operand(i));
    return function(step.fn, args);
  }
  const bool sum = step.kind == Kind::sum;
  Modular total(sum ? 0 : 1);
  for (std::size_t i = step.begin; i < step.end; ++i) total = sum ? total + operand(i) : total * operand(i);
  return total;
}

}  // namespace cdot::derive
