// The zero-test. Compounds (roots, quotients, sines) become symbols with the relations that they obey. The relations
// reduce a polynomial in the symbols, last symbol first.
#include <algorithm>
#include <fmt/format.h>
#include <stdexcept>

#include "derive/expression/shared.hpp"
#include "derive/proof/ginac.hpp"

namespace cdot::derive {

namespace {

constexpr int digits = 80;       // of the decimals that decide where algebra does not
constexpr int random_poses = 6;  // at which they are taken

ex random_fraction(Random& random) { return numeric(static_cast<long>(random.bits() % 2001) - 1000) / numeric(487); }

// A rational point of the unit circle or sphere, by stereographic projection: (1 - t.t, 2 t)/(1 + t.t).
std::vector<ex> random_direction(Random& random, std::size_t dimension) {
  std::vector<ex> t;
  ex square = 0;
  for (std::size_t k = 1; k < dimension; ++k) {
    t.push_back(random_fraction(random));
    square += t.back() * t.back();
  }
  std::vector<ex> point = {(1 - square) / (1 + square)};
  for (const ex& component : t) point.push_back(2 * component / (1 + square));
  return point;
}

ex numeric_factor(const ex& term) {
  if (is_a<numeric>(term)) return term;
  if (!is_a<GiNaC::mul>(term)) return 1;
  for (const ex& factor : term) {
    if (is_a<numeric>(factor)) return factor;
  }
  return 1;
}

}  // namespace

// A symbol for a compound without known relations.
ex Algebra::symbol_for(const ex& compound) {
  const auto found = known_.find(compound);
  if (found != known_.end()) return found->second;
  const ex symbol = fresh_symbol();
  meanings_.emplace_back(symbol, compound);
  known_.emplace(compound, symbol);
  return symbol;
}

void Algebra::relate(Atom::Kind kind, const ex& symbol, const ex& operand) {
  atoms_.push_back({kind, ex_to<GiNaC::realsymbol>(symbol), operand, polynomials_.of_expanded(operand)});
}

// The change of variables is made at the leaves, and each compound is converted once.
ex Algebra::atomised(const ex& e) {
  if (is_a<numeric>(e)) return e;
  if (is_a<GiNaC::symbol>(e)) {
    const auto changed = change_.find(e);
    return changed == change_.end() ? e : atomised(changed->second);
  }
  const auto found = atomised_.find(e);
  if (found != atomised_.end()) return found->second;
  ex result;
  if (is_a<GiNaC::add>(e)) {
    result = 0;
    for (const ex& term : ordered(e)) result += atomised(term);
  } else if (is_a<GiNaC::mul>(e)) {
    result = 1;
    for (const ex& factor : ordered(e)) result *= atomised(factor);
  } else if (is_a<GiNaC::power>(e)) {
    result = atomised_power(e.op(0), e.op(1));
  } else {
    result = atomised_function(e);
  }
  atomised_.emplace(e, result);
  return result;
}

// x^(-k) = (1/x)^k;  x^(k/2) = root(x)^k;  1/root(x) = root(x)/x
ex Algebra::atomised_power(const ex& base, const ex& exponent) {
  const ex b = atomised(base);
  if (!is_a<numeric>(exponent)) return symbol_for(pow(b, exponent));
  const numeric& k = ex_to<numeric>(exponent);
  if (k.is_integer()) return k.is_positive() ? pow(b, k) : pow(inverse_of(b), -k);
  if (!(k * 2).is_integer()) return symbol_for(pow(b, exponent));
  const ex root = root_of(b);
  return k.is_positive() ? pow(root, 2 * k) : pow(root * inverse_of(b), -2 * k);
}

ex Algebra::atomised_function(const ex& e) {
  if (GiNaC::is_the_function<GiNaC::sin_SERIAL>(e)) return turned(false, atomised(e.op(0)));
  if (GiNaC::is_the_function<GiNaC::cos_SERIAL>(e)) return turned(true, atomised(e.op(0)));
  if (!is_a<GiNaC::function>(e)) return symbol_for(e);
  GiNaC::exvector args;
  for (const ex& arg : e) args.push_back(reduced(atomised(arg)));
  return symbol_for(GiNaC::function(ex_to<GiNaC::function>(e).get_serial(), args));
}

ex Algebra::inverse_of(const ex& base) {
  const ex operand = reduced(base);
  if (operand.is_zero()) throw std::domain_error("division by zero");
  if (is_a<numeric>(operand)) return 1 / operand;
  if (is_a<GiNaC::mul>(operand)) {
    ex result = 1;
    for (const ex& factor : ordered(operand)) result *= inverse_of(factor);
    return result;
  }
  if (is_a<GiNaC::power>(operand)) return pow(inverse_of(operand.op(0)), operand.op(1));
  if (fingerprint(operand).centred() < 0) return -inverse_of(-operand);
  const auto found = inverses_.find(operand);
  if (found != inverses_.end()) return found->second;
  for (const Atom& atom : atoms_) {
    if (atom.kind == Atom::Kind::square && operand.is_equal(atom.symbol)) {
      return operand * inverse_of(atom.operand);
    }
  }
  const GiNaC::realsymbol symbol = fresh_symbol();
  relate(Atom::Kind::inverse, symbol, operand);
  inverses_.emplace(operand, symbol);
  return symbol;
}

ex Algebra::root_of(const ex& base) {
  const ex operand = reduced(base);
  if (is_a<numeric>(operand)) {
    const ex root = GiNaC::sqrt(operand);
    if (root.info(GiNaC::info_flags::rational)) return root;
  }
  for (const auto& [other, symbol] : roots_) {
    if (other.is_equal(operand)) return symbol;
  }
  for (const auto& [other, symbol] : roots_) {
    if (reduced(polynomial(operand - other), true).is_zero()) return symbol;
  }
  const GiNaC::realsymbol symbol = fresh_symbol();
  relate(Atom::Kind::square, symbol, operand);
  meanings_.emplace_back(symbol, GiNaC::sqrt(operand));
  roots_.emplace_back(operand, symbol);
  return symbol;
}

// cos or sin of an angle; of a sum of angles by the addition theorems. c^2 + s^2 = 1 for the angle of each term.
ex Algebra::turned(bool cosine, const ex& angle) {
  const ex angle_sum = reduced(angle);
  ex c = 1, s = 0;
  const auto turn_by = [&](const ex& c_by, const ex& s_by) {
    const ex c_before = c;
    c = c * c_by - s * s_by;
    s = c_before * s_by + s * c_by;
  };
  const bool split = is_a<GiNaC::add>(angle_sum) && std::all_of(angle_sum.begin(), angle_sum.end(), [](const ex& term) {
                       return is_a<GiNaC::symbol>(term / numeric_factor(term));
                     });
  const GiNaC::exvector terms = split ? ordered(angle_sum) : GiNaC::exvector{angle_sum};
  for (const ex& term : terms) {
    if (term.is_zero()) continue;
    const numeric factor = ex_to<numeric>(numeric_factor(term));
    const bool few = factor.is_integer() && abs(factor) <= 4;
    const int times = few ? abs(factor).to_int() : 1;
    const bool negative = factor.is_negative();
    const ex base = term / (negative ? -times : times);
    auto known = turns_.begin();
    while (known != turns_.end() && !known->first.is_equal(base)) ++known;
    if (known == turns_.end()) {
      const GiNaC::realsymbol c_base = fresh_symbol(), s_base = fresh_symbol();
      relate(Atom::Kind::square, c_base, 1 - s_base * s_base);
      meanings_.emplace_back(c_base, cos(base));
      meanings_.emplace_back(s_base, sin(base));
      known = turns_.insert(known, {base, {c_base, s_base}});
    }
    for (int i = 0; i < times; ++i) {
      turn_by(known->second[0], negative ? -known->second[1] : known->second[1]);
    }
  }
  return reduced(cosine ? c : s);
}

// Larger sums have no use as variables: multiplied out, they lengthen polynomials.
constexpr double most_written = 200;  // nodes

// A change of variables shortens polynomials: for u = x_a + ra - x_b - rb in the joint, u replaces x_a. Then |u|^2 has
// two terms, not twenty.
void Algebra::shorten(Expr root) {
  for (const Expr u : topological(std::span(&root, 1))) {
    if (!u->vector || u->kind != Kind::sum) continue;
    if (written_size(u, [](Expr) { return false; }) > most_written) continue;
    const Triple<ex> components = of_vector(u);
    for (const Expr part : u->args) {
      if (part->kind != Kind::symbol || part->role != Role::position) continue;
      const Triple<ex> x = of_vector(part);
      const std::string name = u->name;
      bool all = true;
      for (int k = 0; k < joint_.dimension && all; ++k) {
        const auto i = static_cast<std::size_t>(k);
        all = replace(x[i], components[i], name.empty() ? "" : name + "_" + "xyz"[k]);
      }
      if (all) break;
    }
  }
}

// Makes `compound` a variable in place of x, if it contains x times a number. Messages do not show a variable without a
// name.
bool Algebra::replace(const ex& x, const ex& compound, const std::string& name) {
  if (change_.contains(x)) return false;
  const std::optional<ex> now = expanded_if_short(substituted(compound, change_));
  if (!now) return false;
  const ex slope = now->coeff(x);
  if (!is_a<numeric>(slope) || slope.is_zero()) return false;
  const ex symbol = fresh_symbol(name);
  if (name.empty()) meanings_.emplace_back(symbol, compound);
  const ex value = (symbol - *now) / slope + x;
  for (auto& [symbol, earlier] : change_) {
    earlier = earlier.subs(x == value, GiNaC::subs_options::no_pattern);
  }
  change_[x] = value.expand();
  atomised_.clear();
  return true;
}

std::optional<Polynomial> Algebra::numerator_of(const ex& e, bool cancelled) try {
  left_for_test_ = std::min(allowance_, left_in_all_);
  Polynomial p = polynomial(atomised(e));
  if (cancelled) p = without_common_factors(reduced(std::move(p), false));
  return reduced(std::move(p), true);
} catch (const std::exception&) {  // too long; or GiNaC's own complaints, say of a pole
  return std::nullopt;
}

std::optional<ex> Algebra::numerator(const ex& e, bool cancelled) {
  const std::optional<Polynomial> p = numerator_of(e, cancelled);
  return p ? std::optional(polynomials_.expression(*p)) : std::nullopt;
}

// Signs, logarithms and angles need the order of the reals. So long decimals at a random rational pose decide where
// arithmetic modulo the prime does not; a reader can check them. Empty if e is zero or undefined there.
std::string Algebra::difference_at(const ex& e, std::span<const std::size_t> parts, std::uint64_t seed) try {
  Random random(seed);
  GiNaC::exmap pose;
  for (const auto& [name, leaf] : leaves_) pose[leaf.symbol] = random_fraction(random);
  for (const std::vector<ex>& u : units_) {
    const std::vector<ex> direction = random_direction(random, u.size());
    for (std::size_t k = 0; k < u.size(); ++k) pose[u[k]] = direction[k];
  }
  const numeric value = steps_.in_decimals(parts, pose);
  if (abs(value) < pow(numeric(10), -60)) return "";
  const auto shown = [](const ex& x) { return fmt::format("{:.4g}", real(ex_to<numeric>(x)).to_double()); };
  std::string witness = "by " + shown(value) + " at";
  const auto symbols = symbols_of(e);
  for (const auto& [name, leaf] : leaves_) {
    if (symbols.contains(leaf.symbol)) witness += " " + name + " = " + shown(pose[leaf.symbol]) + ",";
  }
  witness.pop_back();
  return witness;
} catch (const std::exception&) {  // undefined at this pose
  return "";
}

std::string Algebra::witness(const ex& e) {
  constexpr std::int64_t work_of_decimals = 100;  // in steps modulo the prime
  const long before = GiNaC::Digits;
  GiNaC::Digits = digits;
  std::string witness;
  const std::uint64_t poses = left_for_points_ > 0 ? random_poses : 1;
  const std::vector<std::size_t> parts = steps_.parts_of(steps_.place_of(e));
  const auto work = work_of_decimals * static_cast<std::int64_t>(parts.size());
  for (std::uint64_t seed = 1; seed <= poses && witness.empty(); ++seed) {
    left_for_points_ -= work;
    witness = difference_at(e, parts, seed);
  }
  GiNaC::Digits = before;
  return witness;
}

Algebra::Zero Algebra::is_zero(const ex& e) {
  if (e.is_zero()) return Zero::yes;
  const std::vector<std::size_t> parts = steps_.parts_of(steps_.place_of(e));
  const Nullity nullity = nullity_of(parts);
  if (nullity == Nullity::differs) return Zero::no;
  const bool at_points = !places_of_slopes_.empty() &&
                         std::ranges::any_of(parts, [&](std::size_t p) { return places_of_slopes_.contains(p); });
  const std::optional<Polynomial> p = at_points ? std::nullopt : numerator_of(e, false);
  if (p && p->is_zero()) return Zero::yes;
  if (nullity == Nullity::zero) return Zero::shown;
  return witness(e).empty() ? Zero::undecided : Zero::no;
}

}  // namespace cdot::derive
