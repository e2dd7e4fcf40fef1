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

void Aim::store(Factoring& f, const std::string& name, int op) {
  stored_[name] = f.algebra.constant(op);
  if (stored_[name]) return;
  f.algebra.output("B." + name, op);
  f.constants.at_start["B." + name] = f.algebra.at_start(op);
}

Program Aim::factor(Constants& constants, std::vector<std::string>& stored) {
  Algebra algebra(constants);
  Factoring f{algebra, constants, assembled(algebra), {}, {}};
  const std::size_t n = f.B.size();
  f.L = f.DU = Grid(n, std::vector<int>(n, -1));
  for (std::size_t j = 0; j < n; j += system().begins_block(j) ? 2 : 1) {
    if (system().begins_block(j)) eliminate_pair(f, j);
    else eliminate(f, j);
  }
  for (const auto& [name, constant] : stored_)
    if (!constant) stored.push_back(name);
  return algebra.finish();
}

// B_ij less what the places before k take from it.
int Aim::left(Factoring& f, std::size_t i, std::size_t j, std::size_t k, const std::string& name) const {
  Summands terms;
  if (f.B[i][j] >= 0) terms.add(1, f.B[i][j]);
  for (std::size_t m = 0; m < k; ++m)
    if (f.L[i][m] >= 0 && f.DU[m][j] >= 0) terms.add(-1, f.algebra.times(f.L[i][m], f.DU[m][j]));
  return f.algebra.sum(terms, name);
}

// A row that moves nothing has no entry: bodies that cannot turn.
int Aim::own(Factoring& f, std::size_t j) const { return f.B[j][j] >= 0 ? f.B[j][j] : f.algebra.value(0); }

void Aim::eliminate(Factoring& f, std::size_t j) {
  const int inverse = system().inverse_pivot(f.algebra, j, left(f, j, j, j, fmt::format("D_{}", j)), own(f, j));
  store(f, diagonal(j), inverse);
  for (std::size_t i = j + 1; i < f.B.size(); ++i) {
    const int below = left(f, i, j, j, ""), beside = left(f, j, i, j, "");
    if (!f.algebra.is_zero(below)) store(f, lower(i, j), f.L[i][j] = f.algebra.times(below, inverse, lower(i, j)));
    if (f.algebra.is_zero(beside)) continue;
    f.DU[j][i] = beside;
    store(f, upper(j, i), f.algebra.times(beside, inverse, upper(j, i)));
  }
}

void Aim::eliminate_pair(Factoring& f, std::size_t j) {
  Algebra& algebra = f.algebra;
  const std::size_t k = j + 1;
  const auto [first, beside, below, second] = system().inverse_block(
      algebra, j, {left(f, j, j, j, ""), left(f, j, k, j, ""), left(f, k, j, j, ""), left(f, k, k, j, "")},
      {own(f, j), own(f, k)});
  store(f, diagonal(j), first), store(f, diagonal(k), second);
  store(f, upper(j, k), beside), store(f, lower(k, j), below);
  const auto both = [&](int x, int of_x, int y, int of_y, const std::string& name) {
    return algebra.sum({{algebra.times(x, of_x), algebra.times(y, of_y)}, {1, 1}}, name);
  };
  for (std::size_t i = k + 1; i < f.B.size(); ++i) {
    const int x = left(f, i, j, j, ""), y = left(f, i, k, j, ""), u = left(f, j, i, j, ""), w = left(f, k, i, j, "");
    if (!algebra.is_zero(x) || !algebra.is_zero(y)) {
      store(f, lower(i, j), f.L[i][j] = both(x, first, y, below, lower(i, j)));
      store(f, lower(i, k), f.L[i][k] = both(x, beside, y, second, lower(i, k)));
    }
    if (algebra.is_zero(u) && algebra.is_zero(w)) continue;
    f.DU[j][i] = u, f.DU[k][i] = w;
    store(f, upper(j, i), both(u, first, w, beside, upper(j, i)));
    store(f, upper(k, i), both(u, below, w, second, upper(k, i)));
  }
}

Program Aim::solve(Constants& constants) const {
  Algebra algebra(constants);
  const std::size_t n = system().size();
  const auto read = [&](const std::string& name) {
    const std::optional<double>& constant = stored_.at(name);
    return constant ? algebra.value(*constant) : algebra.input("B." + name);
  };
  const auto pairs = [&](std::size_t i, std::size_t k) { return k == i + 1 && system().begins_block(i); };
  std::vector<int> y(n), x(n), lambda(n);
  for (std::size_t i = 0; i < n; ++i) {
    Summands terms{{algebra.input(element("b", system().order()[i]))}, {1}};
    for (std::size_t k = 0; k < i; ++k)
      if (stored_.contains(lower(i, k)) && !pairs(k, i)) terms.add(-1, algebra.times(read(lower(i, k)), y[k]));
    y[i] = algebra.sum(terms, fmt::format("y_{}", i));
  }
  for (std::size_t i = n; i-- > 0;) {
    Summands terms{{algebra.times(read(diagonal(i)), y[i])}, {1}};
    if (i > 0 && pairs(i - 1, i)) terms.add(1, algebra.times(read(lower(i, i - 1)), y[i - 1]));
    if (pairs(i, i + 1)) terms.add(1, algebra.times(read(upper(i, i + 1)), y[i + 1]));
    for (std::size_t k = i + 1; k < n; ++k)
      if (stored_.contains(upper(i, k)) && !pairs(i, k)) terms.add(-1, algebra.times(read(upper(i, k)), x[k]));
    lambda[system().order()[i]] = x[i] = algebra.sum(terms, fmt::format("x_{}", i));
  }
  for (std::size_t row = 0; row < n; ++row) algebra.output(element("lambda", row), lambda[row]);
  system().write_changes(algebra, lambda, [&](std::size_t k) { return joints_.inputs(algebra, k); });
  return algebra.finish();
}

}  // namespace cdot::compile
