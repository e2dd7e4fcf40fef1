// Solves K lambda = rhs symbolically: K = L D L^T and both substitutions, unrolled, without entries that vanish at
// every pose.
#include "derive/kernel/factor.hpp"

#include "derive/expression/components.hpp"

namespace cdot::derive {
namespace {

Expr opaque(Expr e, const std::string& name) {
  e->pool->name(e, name, false);
  return e;
}

// An entry of L vanishes at every pose if that of K does and no fill arises.
bool is_zero_in_factor(const Block& block, std::size_t i, std::size_t j) {
  if (!is_zero(block.K[i][j])) return false;
  for (std::size_t k = 0; k < j; ++k) {
    if (!is_zero_in_factor(block, i, k) && !is_zero_in_factor(block, j, k)) return false;
  }
  return true;
}

}  // namespace

std::string element(const std::string& array, std::size_t i) { return array + "[" + std::to_string(i) + "]"; }

std::string triangle_element(const std::string& array, std::size_t i, std::size_t j) {
  return element(array, i * (i + 1) / 2 + j);
}

std::vector<NamedExpr> factor_outputs(const Block& block) {
  const std::size_t n = block.rows.size();
  if (n == 0) return {};
  Pool& pool = *block.K[0][0]->pool;
  std::vector<std::vector<Expr>> L(n, std::vector<Expr>(n));
  std::vector<Expr> D(n), D_inverse(n);
  std::vector<NamedExpr> factor;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const Expr K = is_zero(block.K[i][j]) ? pool.number(0) : pool.symbol(triangle_element("K", i, j), Role::given);
      Expr e = K;
      for (std::size_t k = 0; k < j; ++k) e = e - L[i][k] * L[j][k] * D[k];
      if (i == j) {
        D[i] = opaque(e, "D" + std::to_string(i + 1));
        const Expr pivot[] = {D[i], K};
        D_inverse[i] = opaque(call(Fn::pivot, pivot), "inv_D" + std::to_string(i + 1));
      } else {
        L[i][j] = opaque(e * D_inverse[j], "L" + std::to_string(i + 1) + std::to_string(j + 1));
      }
      factor.push_back({triangle_element("F", i, j), i == j ? D_inverse[i] : L[i][j]});
    }
  }
  return factor;
}

std::vector<NamedExpr> solve_outputs(const Block& block) {
  const std::size_t n = block.rows.size();
  if (n == 0) return {};
  Pool& pool = *block.K[0][0]->pool;
  const auto L = [&](std::size_t i, std::size_t j) {
    return is_zero_in_factor(block, i, j) ? pool.number(0) : pool.symbol(triangle_element("F", i, j), Role::given);
  };
  std::vector<Expr> y(n), x(n);
  for (std::size_t i = 0; i < n; ++i) {
    y[i] = pool.symbol(element("rhs", i), Role::given);
    for (std::size_t k = 0; k < i; ++k) y[i] = y[i] - L(i, k) * y[k];
    y[i] = opaque(y[i], "y" + std::to_string(i + 1));
  }
  for (std::size_t i = n; i-- > 0;) {
    x[i] = L(i, i) * y[i];
    for (std::size_t k = i + 1; k < n; ++k) x[i] = x[i] - L(k, i) * x[k];
    x[i] = opaque(x[i], "x" + std::to_string(i + 1));
  }
  std::vector<NamedExpr> outputs;
  for (std::size_t i = 0; i < n; ++i) outputs.push_back({element("lambda", i), x[i]});
  return outputs;
}

}  // namespace cdot::derive
