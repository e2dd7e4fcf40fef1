#include "derive/compile/foresight/aim.hpp"

#include <fmt/format.h>

#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

using derive::element;

std::string lower(std::size_t i, std::size_t j) { return fmt::format("L_{}_{}", i, j); }
std::string upper(std::size_t i, std::size_t j) { return fmt::format("U_{}_{}", i, j); }
std::string diagonal(std::size_t i) { return fmt::format("inv_D_{}", i); }

}  // namespace

// B_ik = sum over columns of J'_i M^-1 J_k.
int Aim::coupling(Algebra& algebra, std::size_t i, std::size_t r, const Values& of_i, std::size_t k, std::size_t s,
                  const Values& of_k) const {
  const std::vector<int>&bodies_i = *system().blocks()[i].bodies, &bodies_k = *system().blocks()[k].bodies;
  const std::size_t columns = blocks_.mechanism().columns();
  Summands terms;
  for (std::size_t a = 0; a < bodies_i.size(); ++a)
    for (std::size_t b = 0; b < bodies_k.size(); ++b)
      for (std::size_t c = 0; bodies_i[a] == bodies_k[b] && c < columns; ++c) {
        const auto y = [&](std::size_t column) { return of_k.at(element(element("D", s), columns * b + column)); };
        const int x = of_i.at(element(element("D", r), columns * a + c));
        terms.add(1, algebra.times(x, blocks_.weighted(algebra, bodies_i[a], c, y)));
      }
  return algebra.sum(terms);
}

Aim::Grid Aim::assembled(Algebra& algebra) const {
  const std::size_t n = system().size(), count = system().blocks().size();
  std::vector<Values> at_end, at_start;
  for (std::size_t k = 0; k < count; ++k) {
    const RowBlock& block = system().blocks()[k];
    at_end.push_back(blocks_.call(algebra, block, "dense", blocks_.inputs_with_jacobian(algebra, block)));
    at_start.push_back(blocks_.call(algebra, block, "dense", joints_.inputs(algebra, k)));
  }
  std::vector<std::size_t> place(n);
  for (std::size_t i = 0; i < n; ++i) place[system().order()[i]] = i;
  Grid B(n, std::vector<int>(n, -1));
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < system().blocks()[i].rows->count(); ++r)
        for (std::size_t s = 0; s < system().blocks()[k].rows->count(); ++s) {
          const int entry = coupling(algebra, i, r, at_end[i], k, s, at_start[k]);
          if (!algebra.is_zero(entry)) B[place[system().first_row(i) + r]][place[system().first_row(k) + s]] = entry;
        }
  return B;
}

void Aim::store(Algebra& algebra, Constants& constants, const std::string& name, int op) {
  stored_[name] = algebra.constant(op);
  if (stored_[name]) return;
  algebra.output("B." + name, op);
  constants.at_start["B." + name] = algebra.at_start(op);
}

Program Aim::factor(Constants& constants, std::vector<std::string>& stored) {
  Algebra algebra(constants);
  const Grid B = assembled(algebra);
  const std::size_t n = B.size();
  Grid L(n, std::vector<int>(n, -1)), DU(L);
  // B_ij less what the places before k take from it.
  const auto left = [&](std::size_t i, std::size_t j, std::size_t k, const std::string& name) {
    Summands terms;
    if (B[i][j] >= 0) terms.add(1, B[i][j]);
    for (std::size_t m = 0; m < k; ++m)
      if (L[i][m] >= 0 && DU[m][j] >= 0) terms.add(-1, algebra.times(L[i][m], DU[m][j]));
    return algebra.sum(terms, name);
  };
  for (std::size_t j = 0; j < n; ++j) {
    // A row that moves nothing has no entry: bodies that cannot turn.
    const int own = B[j][j] >= 0 ? B[j][j] : algebra.value(0);
    const int inverse = system().inverse_pivot(algebra, j, left(j, j, j, fmt::format("D_{}", j)), own);
    store(algebra, constants, diagonal(j), inverse);
    for (std::size_t i = j + 1; i < n; ++i) {
      const int below = left(i, j, j, ""), beside = left(j, i, j, "");
      if (!algebra.is_zero(below))
        store(algebra, constants, lower(i, j), L[i][j] = algebra.times(below, inverse, lower(i, j)));
      if (algebra.is_zero(beside)) continue;
      DU[j][i] = beside;
      store(algebra, constants, upper(j, i), algebra.times(beside, inverse, upper(j, i)));
    }
  }
  for (const auto& [name, constant] : stored_)
    if (!constant) stored.push_back(name);
  return algebra.finish();
}

Program Aim::solve(Constants& constants) const {
  Algebra algebra(constants);
  const std::size_t n = system().size();
  const auto read = [&](const std::string& name) {
    const std::optional<double>& constant = stored_.at(name);
    return constant ? algebra.value(*constant) : algebra.input("B." + name);
  };
  std::vector<int> y(n), x(n), lambda(n);
  for (std::size_t i = 0; i < n; ++i) {
    Summands terms{{algebra.input(element("b", system().order()[i]))}, {1}};
    for (std::size_t k = 0; k < i; ++k)
      if (stored_.contains(lower(i, k))) terms.add(-1, algebra.times(read(lower(i, k)), y[k]));
    y[i] = algebra.sum(terms, fmt::format("y_{}", i));
  }
  for (std::size_t i = n; i-- > 0;) {
    Summands terms{{algebra.times(read(diagonal(i)), y[i])}, {1}};
    for (std::size_t k = i + 1; k < n; ++k)
      if (stored_.contains(upper(i, k))) terms.add(-1, algebra.times(read(upper(i, k)), x[k]));
    lambda[system().order()[i]] = x[i] = algebra.sum(terms, fmt::format("x_{}", i));
  }
  for (std::size_t row = 0; row < n; ++row) algebra.output(element("lambda", row), lambda[row]);
  system().write_changes(algebra, lambda, [&](std::size_t k) { return joints_.inputs(algebra, k); });
  return algebra.finish();
}

}  // namespace cdot::compile
