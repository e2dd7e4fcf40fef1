// GiNaC's polynomials as text, in an order that depends on names only: they become our own expressions first.
#include <algorithm>
#include <set>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

namespace {

Expr converted(const ex& e, Pool& pool) {
  if (is_a<numeric>(e)) {
    const numeric& n = ex_to<numeric>(e);
    return pool.number(Rational(n.numer().to_long(), n.denom().to_long()));
  }
  if (is_a<GiNaC::symbol>(e)) {
    return pool.symbol(ex_to<GiNaC::symbol>(e).get_name(), Role::given);
  }
  std::vector<Expr> args;
  for (const ex& arg : e) args.push_back(converted(arg, pool));
  if (is_a<GiNaC::power>(e)) {
    const bool root = e.op(1).is_equal(numeric(1) / 2);
    return root ? call(Fn::sqrt, args[0]) : pow(args[0], ex_to<numeric>(e.op(1)).to_int());
  }
  if (const std::optional<Fn> fn = function_in(e)) return call(*fn, args);
  Expr result = pool.number(is_a<GiNaC::mul>(e) ? 1 : 0);
  for (const Expr arg : args) result = is_a<GiNaC::mul>(e) ? result * arg : result + arg;
  return result;
}

}  // namespace

Expr with_leading_sign(Expr e) { return e->kind == Kind::sum && e->coefs[0].sign() < 0 ? -e : e; }

std::vector<ex> Algebra::symbols_in(const ex& e) const {
  const auto found = symbols_of(e);
  return {found.begin(), found.end()};
}

ex Algebra::in_names(ex e) const {
  // Later symbols stand for compounds of earlier ones.
  for (auto meaning = meanings_.rbegin(); meaning != meanings_.rend(); ++meaning) {
    e = e.subs(meaning->first == meaning->second);
  }
  return e;
}

std::vector<std::string> Algebra::factors_of(const ex& polynomial) const {
  const ex factored = GiNaC::factor(polynomial);
  const GiNaC::exvector factors =
      is_a<GiNaC::mul>(factored) ? GiNaC::exvector(factored.begin(), factored.end()) : GiNaC::exvector{factored};
  Pool pool;
  std::set<std::string> names;
  for (const ex& f : factors) {
    const ex base = is_a<GiNaC::power>(f) ? f.op(0) : f;
    if (is_a<numeric>(base)) continue;
    names.insert(text(with_leading_sign(converted(in_names(base), pool))));
  }
  return {names.begin(), names.end()};
}

}  // namespace cdot::derive
