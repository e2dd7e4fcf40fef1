#include "derive/compile/rows/row_system.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>

#include "derive/compile/rows/components.hpp"
#include "derive/kernel/factor.hpp"
#include "runtime/direct/elimination_order.hpp"
#include "runtime/direct/ldlt.hpp"

namespace cdot::compile {

using derive::element;
using derive::triangle_element;

RowSystem::RowSystem(const RowBlocks& rows, std::vector<RowBlock> blocks) : rows_(rows) {
  for (RowBlock& block : blocks) {
    if (block.rows->count() == 0) continue;
    first_.push_back(names_.size());
    for (const std::string& row : block.rows->names) names_.push_back(block.name + "_" + row);
    blocks_.push_back(std::move(block));
  }
  dense_.resize(blocks_.size());
  K_.assign(size(), std::vector<int>(size(), -1));
  L_.assign(size(), std::vector<bool>(size(), false));
  is_second_.assign(size(), false);
}

// Blocks of constants that are coupled to one other at most come first: their elimination costs nothing, so no pivot
// waits for them.
void RowSystem::order_rows(const Algebra& algebra) {
  std::vector<int> left, rows;
  for (std::size_t i = 0; i < blocks_.size(); ++i) left.push_back(static_cast<int>(i));
  const auto at = [](int block) { return static_cast<std::size_t>(block); };
  const auto couples = [&](int i, int k) { return i != k && share_a_body(at(i), at(k)); };
  const auto take = [&](int block) {
    for (std::size_t r = 0; r < blocks_[at(block)].rows->count(); ++r) order_.push_back(first_[at(block)] + r);
  };
  for (std::size_t i = 0; i < left.size(); ++i) {
    const int block = left[i];
    const auto of_it = [&](int other) { return couples(block, other); };
    if (!is_constant(algebra, at(block)) || std::ranges::count_if(left, of_it) > 1) continue;
    take(block);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i--));
  }
  std::vector<std::vector<int>> neighbours(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    rows.push_back(static_cast<int>(blocks_[at(left[i])].rows->count()));
    for (std::size_t k = 0; k < left.size(); ++k)
      if (couples(left[i], left[k])) neighbours[i].push_back(static_cast<int>(k));
  }
  for (const Elimination& one : minimum_degree_order(rows, neighbours, 1))
    for (const int taken : one.blocks) take(left[at(taken)]);
}

// Its rows of K.
bool RowSystem::is_constant(const Algebra& algebra, std::size_t block) const {
  for (std::size_t r = 0; r < blocks_[block].rows->count(); ++r)
    for (std::size_t i = 0; i < size(); ++i)
      if (const int entry = K(first_[block] + r, i); entry >= 0 && !algebra.constant(entry)) return false;
  return true;
}

bool RowSystem::share_a_body(std::size_t i, std::size_t k) const {
  for (const int a : *blocks_[i].bodies)
    for (const int b : *blocks_[k].bodies)
      if (a == b && rows_.mechanism().bodies[static_cast<std::size_t>(a)].moves) return true;
  return false;
}

void RowSystem::add_block(Algebra& algebra, std::size_t block, const Values& in) {
  const RowBlock& rows = blocks_[block];
  const std::size_t first = first_[block];
  const Values K = rows_.call(algebra, rows, "effective_mass", in);
  dense_[block] = rows_.call(algebra, rows, "dense", in);
  note_pulls(algebra, block);
  for (std::size_t r = 0; r < rows.rows->count(); ++r)
    for (std::size_t c = 0; c <= r; ++c)
      K_[first + r][first + c] = has_pulls(block, r) && has_pulls(block, c) ? entry(algebra, block, r, block, c)
                                                                            : K.at(triangle_element("K", r, c));
}

void RowSystem::note_pulls(const Algebra& algebra, std::size_t block) {
  for (std::size_t row = 0; row < blocks_[block].rows->count(); ++row)
    for (std::size_t a = 0; a < blocks_[block].bodies->size(); ++a)
      if (rows_.turns_inertia((*blocks_[block].bodies)[a]))
        if (const std::optional<Pull> pull = pull_of(algebra, block, row, a)) pulls_[{block, row, a}] = *pull;
}

// r x u in the world's axes has the numbers sum of e_cik r_i u_k, with r_i = sum of A_ij p_j.
std::optional<RowSystem::Pull> RowSystem::pull_of(const Algebra& algebra, std::size_t block, std::size_t row,
                                                  std::size_t body) const {
  Pull pull{{}, {}, 1};
  double turns[3][3][3];
  for (std::size_t c = 0; c < 3; ++c) {
    const std::optional<double> u = algebra.constant(dense_[block].at(element(element("D", row), 6 * body + c)));
    if (!u || !of_rotation(algebra, block, row, body, c, turns[c])) return std::nullopt;
    pull.along[c] = *u;
  }
  const auto smaller = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto most = std::ranges::max_element(pull.along, smaller);
  if (*most == 0) return std::nullopt;
  const auto k = static_cast<std::size_t>(most - pull.along.begin());
  for (std::size_t j = 0; j < 3; ++j) pull.point[j] = turns[(k + 1) % 3][(k + 2) % 3][j] / *most;
  const double slight = 1e-14 * std::abs(*most * *std::ranges::max_element(pull.point, smaller));
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double side = c == i ? 0 : (i == (c + 1) % 3 ? 1 : -1) * pull.along[3 - c - i];
        if (std::abs(turns[c][i][j] - side * pull.point[j]) > slight) return std::nullopt;
      }
  for (std::array<double, 3>* v : {&pull.point, &pull.along}) {
    const auto first = std::ranges::find_if(*v, [](double x) { return x != 0; });
    if (first == v->end() || *first > 0) continue;
    for (double& x : *v) x = -x;
    pull.sign = -pull.sign;
  }
  return pull;
}

// A number of D as the sum of m_ij A_ij of that body; false if it is none.
bool RowSystem::of_rotation(const Algebra& algebra, std::size_t block, std::size_t row, std::size_t body,
                            std::size_t axis, double (&m)[3][3]) const {
  const auto sum = algebra.linear(dense_[block].at(element(element("D", row), 6 * body + 3 + axis)));
  if (!sum) return false;
  std::size_t found = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const auto of_A = sum->find(rows_.rotation_name((*blocks_[block].bodies)[body], i, j));
      m[i][j] = of_A == sum->end() ? 0 : of_A->second;
      found += of_A != sum->end();
    }
  return found == sum->size();
}

// In every body of the block whose inertia turns, if there is one.
bool RowSystem::has_pulls(std::size_t block, std::size_t row) const {
  bool some = false;
  for (std::size_t a = 0; a < blocks_[block].bodies->size(); ++a) {
    if (!rows_.turns_inertia((*blocks_[block].bodies)[a])) continue;
    if (!pulls_.contains({block, row, a})) return false;
    some = true;
  }
  return some;
}

void RowSystem::couple(Algebra& algebra) {
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (share_a_body(i, k)) couple(algebra, i, k);
}

void RowSystem::couple(Algebra& algebra, std::size_t i, std::size_t k) {
  for (std::size_t r = 0; r < blocks_[i].rows->count(); ++r)
    for (std::size_t s = 0; s < blocks_[k].rows->count(); ++s)
      if (const int K = entry(algebra, i, r, k, s); !algebra.is_zero(K)) K_[first_[i] + r][first_[k] + s] = K;
}

// K_ik = sum over columns of J_i M^-1 J_k.
int RowSystem::entry(Algebra& algebra, std::size_t i, std::size_t r, std::size_t k, std::size_t s) const {
  const std::vector<int>&of_i = *blocks_[i].bodies, &of_k = *blocks_[k].bodies;
  const std::size_t columns = rows_.mechanism().columns();
  Summands terms;
  for (std::size_t a = 0; a < of_i.size(); ++a)
    for (std::size_t b = 0; b < of_k.size(); ++b) {
      if (of_i[a] != of_k[b]) continue;
      const auto x = pulls_.find({i, r, a}), y = pulls_.find({k, s, b});
      const bool by_pulls = x != pulls_.end() && y != pulls_.end();
      if (by_pulls) terms.add(x->second.sign * y->second.sign, turning(algebra, of_i[a], x->second, y->second));
      for (std::size_t c = 0; c < (by_pulls ? rows_.mechanism().linear() : columns); ++c) {
        const auto of_y = [&](std::size_t column) {
          return dense_[k].at(element(element("D", s), columns * b + column));
        };
        const int of_x = dense_[i].at(element(element("D", r), columns * a + c));
        terms.add(1, algebra.times(of_x, rows_.weighted(algebra, of_i[a], c, of_y)));
      }
    }
  return algebra.sum(terms);
}

// u^T A G A^T u', G = [p x]^T I^-1 [p' x] of the body, which does not turn.
int RowSystem::turning(Algebra& algebra, int body, const Pull& x, const Pull& y) const {
  if (x.point == y.point && x.along < y.along) return turning(algebra, body, y, x);  // the same bits
  const auto along = [&](const Pull& pull, std::size_t k) {
    Summands terms;
    for (std::size_t i = 0; i < 3; ++i)
      terms.add(1, algebra.times(algebra.value(pull.along[i]), algebra.input(rows_.rotation_name(body, i, k))));
    return algebra.sum(terms);
  };
  // p x e_k
  const auto side = [](const Pull& pull, std::size_t k) {
    std::array<double, 3> v{};
    v[(k + 1) % 3] = pull.point[(k + 2) % 3], v[(k + 2) % 3] = -pull.point[(k + 1) % 3];
    return v;
  };
  Summands sum;
  for (std::size_t k = 0; k < 3; ++k) {
    Summands of_k;
    for (std::size_t l = 0; l < 3; ++l)
      of_k.add(1, algebra.times(algebra.value(rows_.weighed(body, side(x, k), side(y, l))), along(y, l)));
    sum.add(1, algebra.times(along(x, k), algebra.sum(of_k)));
  }
  return algebra.sum(sum);
}

void RowSystem::soften(Algebra& algebra, std::size_t row, int by) {
  for (std::size_t i = 0; i < size(); ++i) {
    int& entry = K_[std::max(i, row)][std::min(i, row)];
    if (entry < 0) continue;
    if (i != row) entry = algebra.times(entry, by);
    else entry = algebra.sum({{algebra.product({entry, by}, {1, 2}), algebra.value(1)}, {1, 1}});
  }
}

int RowSystem::inverse_pivot(Algebra& algebra, std::size_t j, int D, int diagonal) const {
  const std::string name = "inv_D_" + std::to_string(j);
  if (!redundant_[j]) return algebra.function(Fn::pivot, {D, diagonal}, name);
  const int share = algebra.times(algebra.value(dense::lasting_share), diagonal), zero = algebra.value(0);
  return algebra.function(Fn::select, {algebra.sum({{D, share}, {1, -1}}), algebra.function(Fn::inverse, {D}), zero},
                          name);
}

// U of a row, and of its own pivot, less what the places before m take of it.
int RowSystem::reduced(Factoring& f, std::size_t i, std::size_t j, std::size_t m, const std::string& name) const {
  Summands terms;
  if (const int k = K(order_[i], order_[j]); k >= 0) terms.add(1, k);
  for (std::size_t k = 0; k < m; ++k)
    if (f.U[i][k] >= 0 && f.L[j][k] >= 0) terms.add(-1, f.algebra.times(f.U[i][k], f.L[j][k]));
  return f.algebra.sum(terms, name);
}

bool RowSystem::is_noise(Factoring& f, std::size_t j, double pivot, double noise) const {
  return !(pivot > noise + dense::pivot_noise<double> * f.algebra.at_start(K(order_[j], order_[j])));
}

// In the plane, where most blocks have two rows, both are eliminated at once: no number waits for the division of the
// first one, and the solution of one not for that of the other.
bool RowSystem::begins_pair(Factoring& f, std::size_t j, int D) const {
  if (rows_.mechanism().spatial() || j + 1 == order_.size() || redundant_[j]) return false;
  if (order_[j + 1] != order_[j] + 1 || std::ranges::find(first_, order_[j + 1]) != first_.end()) return false;
  const int U = reduced(f, j + 1, j, j, "");
  if (f.algebra.is_zero(U)) return false;
  const double of_U = f.algebra.at_start(U), share = of_U / f.algebra.at_start(D);
  const double second = f.algebra.at_start(reduced(f, j + 1, j + 1, j, "")) - share * of_U;
  return !is_noise(f, j + 1, second, f.noise[j + 1] + share * share * f.noise[j]);
}

void RowSystem::factor(Algebra& algebra, const Store& store) {
  order_rows(algebra);
  const std::size_t n = order_.size();
  Factoring f{algebra, store, std::vector<std::vector<int>>(n, std::vector<int>(n, -1)), {}, std::vector<double>(n)};
  f.L = f.U;
  while (redundant_.size() < n) {
    const std::size_t j = redundant_.size();
    const int D = reduced(f, j, j, j, fmt::format("D_{}", j));
    redundant_.push_back(is_noise(f, j, algebra.at_start(D), f.noise[j]));
    f.noise[j] += dense::pivot_noise<double> * algebra.at_start(K(order_[j], order_[j]));
    if (begins_pair(f, j, D)) eliminate_pair(f, j, D);
    else eliminate(f, j, D);
  }
}

void RowSystem::eliminate(Factoring& f, std::size_t j, int D) {
  const int inverse = inverse_pivot(f.algebra, j, D, K(order_[j], order_[j]));
  f.store(fmt::format("inv_D_{}", j), inverse);
  for (std::size_t i = j + 1; i < order_.size(); ++i) {
    const std::string place = fmt::format("{}_{}", i, j);
    const int entry = reduced(f, i, j, j, "U_" + place);
    if (f.algebra.is_zero(entry)) continue;
    f.U[i][j] = entry;
    f.L[i][j] = f.algebra.times(entry, inverse, "L_" + place);
    L_[i][j] = true;
    const double share = f.algebra.at_start(f.L[i][j]);
    f.noise[i] += share * share * f.noise[j];
    f.store("L_" + place, f.L[i][j]);
  }
}

// The inverse of (a b; c d) is (d -b; -c a) / (a d - b c), but (1/a 0; 0 0) or (0 0; 0 1/d) where a row depends on
// others.
std::array<int, 4> RowSystem::inverse_block(Algebra& algebra, std::size_t j, const std::array<int, 4>& block,
                                            const std::array<int, 2>& diagonal) const {
  const auto [a, b, c, d] = block;
  const int zero = algebra.value(0), one = algebra.value(1);
  const int counts = algebra.sum({{a, algebra.times(algebra.input("T(64 * epsilon)"), diagonal[0])}, {1, -1}});
  const int determinant = algebra.sum({{algebra.times(a, d), algebra.times(b, c)}, {1, -1}});
  const int scale = algebra.function(Fn::select, {counts, a, one});
  const int pivot = algebra.function(Fn::select, {counts, determinant, d});
  const int rest = algebra.function(Fn::pivot, {pivot, algebra.times(diagonal[1], scale)});
  const int of_both = algebra.function(Fn::select, {counts, rest, zero});
  const int alone = algebra.function(Fn::pivot, {a, diagonal[0]});
  return {algebra.function(Fn::select, {of_both, algebra.times(d, of_both), alone}, fmt::format("inv_D_{}", j)),
          algebra.sum({{algebra.times(b, of_both)}, {-1}}), algebra.sum({{algebra.times(c, of_both)}, {-1}}),
          algebra.times(scale, rest, fmt::format("inv_D_{}", j + 1))};
}

void RowSystem::eliminate_pair(Factoring& f, std::size_t j, int D) {
  Algebra& algebra = f.algebra;
  const int U = reduced(f, j + 1, j, j, fmt::format("U_{}_{}", j + 1, j)), S = reduced(f, j + 1, j + 1, j, "");
  const auto [first, beside, same, second] =
      inverse_block(algebra, j, {D, U, U, S}, {K(order_[j], order_[j]), K(order_[j + 1], order_[j + 1])});
  f.store(fmt::format("inv_D_{}", j), first), f.store(fmt::format("inv_D_{}", j + 1), second);
  f.store(fmt::format("L_{}_{}", j + 1, j), beside);
  redundant_.push_back(false), is_second_[j + 1] = true;
  const double share = algebra.at_start(U) / algebra.at_start(D);
  f.noise[j + 1] +=
      share * share * f.noise[j] + dense::pivot_noise<double> * algebra.at_start(K(order_[j + 1], order_[j + 1]));
  for (std::size_t i = j + 2; i < order_.size(); ++i) {
    const int a = reduced(f, i, j, j, fmt::format("U_{}_{}", i, j)),
              b = reduced(f, i, j + 1, j, fmt::format("U_{}_{}", i, j + 1));
    if (algebra.is_zero(a) && algebra.is_zero(b)) continue;
    f.U[i][j] = a, f.U[i][j + 1] = b;
    for (const auto& [place, of_a, of_b] : {std::tuple(j, first, beside), std::tuple(j + 1, beside, second)}) {
      const std::string name = fmt::format("L_{}_{}", i, place);
      f.L[i][place] = algebra.sum({{algebra.times(a, of_a), algebra.times(b, of_b)}, {1, 1}}, name);
      L_[i][place] = true;
      f.store(name, f.L[i][place]);
    }
    const double of_b = algebra.at_start(f.L[i][j + 1]), of_a = algebra.at_start(a) / algebra.at_start(D);
    f.noise[i] += of_a * of_a * f.noise[j] + of_b * of_b * f.noise[j + 1];
  }
}

std::vector<int> RowSystem::solve(Algebra& algebra, const std::vector<int>& b, const Read& read) const {
  const std::size_t n = order_.size();
  const auto L = [&](std::size_t i, std::size_t j) { return read(fmt::format("L_{}_{}", i, j)); };
  std::vector<int> y(n), x(n), lambda(n);
  for (std::size_t i = 0; i < n; ++i) {
    Summands terms{{b[order_[i]]}, {1}};
    for (std::size_t k = 0; k < i; ++k)
      if (L_[i][k]) terms.add(-1, algebra.times(L(i, k), y[k]));
    y[i] = algebra.sum(terms, "y_" + std::to_string(i));
  }
  for (std::size_t i = n; i-- > 0;) {
    Summands terms{{algebra.times(read("inv_D_" + std::to_string(i)), y[i])}, {1}};
    if (i > 0 && is_second_[i]) terms.add(1, algebra.times(L(i, i - 1), y[i - 1]));
    if (i + 1 < n && is_second_[i + 1]) terms.add(1, algebra.times(L(i + 1, i), y[i + 1]));
    for (std::size_t k = i + 1; k < n; ++k)
      if (L_[k][i]) terms.add(-1, algebra.times(L(k, i), x[k]));
    lambda[order_[i]] = x[i] = algebra.sum(terms, "lambda_" + names_[order_[i]]);
  }
  return lambda;
}

void RowSystem::write_changes(Algebra& algebra, const std::vector<int>& lambda,
                              const std::function<Values(std::size_t)>& inputs) const {
  Forces forces;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const auto first = lambda.begin() + static_cast<std::ptrdiff_t>(first_[k]);
    rows_.add_forces(algebra, blocks_[k], inputs(k),
                     {first, first + static_cast<std::ptrdiff_t>(blocks_[k].rows->count())}, forces);
  }
  each_component(rows_, [&](const Component& component, double, double) {
    algebra.output(component.in("d"), change_of(rows_, algebra, component, forces));
  });
}

}  // namespace cdot::compile
