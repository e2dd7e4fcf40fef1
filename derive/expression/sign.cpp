#include "derive/expression/sign.hpp"

#include "derive/expression/functions.hpp"

namespace cdot::derive {

bool is_never_negative(Expr e) {
  switch (e->kind) {
    case Kind::number: return e->value.sign() >= 0;
    case Kind::norm: return true;
    case Kind::dot: return e->args[0] == e->args[1];
    case Kind::function: return e->fn == Fn::sqrt || e->fn == Fn::abs || e->fn == Fn::exp;
    case Kind::sum:
      for (std::size_t i = 0; i < e->args.size(); ++i)
        if (e->coefs[i].sign() < 0 || !is_never_negative(e->args[i])) return false;
      return true;
    case Kind::product:
      for (std::size_t i = 0; i < e->args.size(); ++i)
        if (e->exponents[i] % 2 != 0 && !is_never_negative(e->args[i])) return false;
      return true;
    default: return false;
  }
}

}  // namespace cdot::derive
