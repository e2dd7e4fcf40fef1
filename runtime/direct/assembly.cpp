// Rows, J and masses of an island -> the pattern and the values of K.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <cdot/spaces.hpp>

#include "runtime/direct/ldlt_kernels.hpp"
#include "runtime/direct/system.hpp"

namespace cdot {
namespace {

// K += J weighted^T over the columns of one body. A and B are the numbers of rows; 0: known only at run time.
template <class S, int A, int B>
void add_product(const typename System<S>::Product& product, const typename System<S>::Real* J,
                 const typename System<S>::Real* weighted, typename System<S>::Real* K) {
  const int rows = A ? A : product.rows, columns = B ? B : product.columns;
  J += product.J;
  weighted += product.weighted;
  K += product.to.at;
  for (int r = 0; r < rows; ++r) {
    for (int s = 0; s < columns; ++s) {
      typename System<S>::Real sum = 0;
      for (int c = 0; c < S::freedom; ++c)
        sum += J[r * product.J_stride + c] * weighted[s * product.weighted_stride + c];
      K[r * product.to.stride + s] += sum;
    }
  }
}

// K = J weighted^T of one block, lower triangle. In float, kernels evaluate K by unit vectors that are not quite so:
// that K and its products with other blocks belong to no J. The difference, 1e-7 and more of the diagonal, takes
// redundant rows for independent ones. Elimination magnifies it by the ratio r of masses, and pivots are 1 / r: from
// r = 4000 on they may be wrong or negative.
template <class S>
void multiply_own(const typename System<S>::Block& block, const typename System<S>::Real* J,
                  const typename System<S>::Real* weighted, typename System<S>::Real* K) {
  const int width = S::freedom * block.batch->ops->bodies;
  for (int r = 0; r < block.rows; ++r)
    for (int s = 0; s <= r; ++s) {
      typename System<S>::Real sum = 0;
      for (int c = 0; c < width; ++c) sum += J[r * width + c] * weighted[s * width + c];
      K[r * block.own.stride + s] = sum;
    }
}
constexpr double much_heavier = 1e3;

template <class S>
using AddProduct = decltype(System<S>::Product::add);

template <class S, int A, int... B>
constexpr std::array<AddProduct<S>, sizeof...(B)> products_of(std::integer_sequence<int, B...>) {
  return {add_product<S, A, B>...};
}
template <class S, int... A>
constexpr std::array<std::array<AddProduct<S>, sizeof...(A)>, sizeof...(A)> all_products(
    std::integer_sequence<int, A...> sizes) {
  return {products_of<S, A>(sizes)...};
}
template <class S>
constexpr auto products = all_products<S>(dense::Sizes{});

}  // namespace

template <class S>
void System<S>::build(const std::vector<Segment<S>>& segments, const Bodies<S>& bodies,
                      const std::vector<int>& tension_rows) {
  blocks.clear();
  tensions.clear();
  rows_ = 0;
  lawful_ = taut_ = false;
  int numbers = 0;
  const auto add = [&](std::vector<Block>& to, Batch<S>* batch, int slot, int rows) {
    to.push_back({batch, slot, slot, 0, rows, numbers, {}});
    rows_ += rows;
    numbers += rows * S::freedom * batch->ops->bodies;
  };
  for (const Segment<S>& segment : segments) {
    lawful_ |= segment.batch->law != nullptr;
    const int rows = segment.batch->ops->rows;
    for (int slot = segment.begin; rows > 0 && slot < segment.end; ++slot) add(blocks, segment.batch, slot, rows);
  }
  tension_of_.clear();
  for (size_t i = 0; i < tension_rows.size(); ++i) {
    if (tension_rows[i] == 0) continue;
    add(tensions, blocks[i].batch, blocks[i].slot, tension_rows[i]);
    tension_of_.push_back(static_cast<int>(i));
  }
  jacobian_.assign(static_cast<size_t>(numbers), 0.0);
  weighted_ = jacobian_;
  const auto n = static_cast<size_t>(rows_);
  for (auto* vector : {&b, &lambda, &softness, &right_side_, &product_, &unmet_, &before_}) vector->assign(n, 0.0);
  for (auto& vector : shared_) vector.assign(n, 0.0);
  lower.assign(n, -std::numeric_limits<Real>::infinity());
  upper.assign(n, std::numeric_limits<Real>::infinity());
  for (auto* flags : {&fixed, &broken, &out_, &passing_}) flags->assign(n, 0);
  active_set_.assign(n, free);
  circle_.reserve(n);
  multiplies_own_ = std::is_same_v<T, float> && (has_light_bodies(bodies) || has_loops(bodies));
  order_rows(bodies);
  each_row([&](int row, const Batch<S>& batch, int) { passing_[row] = batch.law != nullptr; });
  list_products(bodies);
  slacken();
  built_ = true;
}

template <class S>
std::vector<int> System<S>::movable_bodies(const Block& block, const Bodies<S>& bodies) const {
  std::vector<int> movable;
  const int count = block.batch->ops->bodies;
  for (int k = 0; k < count; ++k) {
    const int body = block.batch->body[block.slot * count + k];
    if (!bodies.immovable(body)) movable.push_back(body);
  }
  std::sort(movable.begin(), movable.end());
  return movable;
}

template <class S>
bool System<S>::has_light_bodies(const Bodies<S>& bodies) const {
  double lightest = 0, heaviest = std::numeric_limits<double>::infinity();  // [1/kg]
  for (const Block& block : blocks)
    for (const int body : movable_bodies(block, bodies)) {
      const double inverse = double(bodies.inverse_mass[static_cast<size_t>(body)].m);
      lightest = std::max(lightest, inverse), heaviest = std::min(heaviest, inverse);
    }
  return lightest > much_heavier * heaviest;
}

// True if rows of joints may be redundant: they connect n bodies, the world one of them, by more than n - 1 links, or
// the same bodies twice. A joint over k bodies makes k - 1 links.
template <class S>
bool System<S>::has_loops(const Bodies<S>& bodies) const {
  std::map<std::vector<int>, int> joints_over;
  std::set<int> nodes;
  size_t links = 0;
  for (const Block& block : blocks) {
    std::vector<int> over = movable_bodies(block, bodies);
    if (over.size() < static_cast<size_t>(std::max(2, block.batch->ops->bodies))) over.push_back(-1);  // the world
    const auto [found, is_new] = joints_over.emplace(over, 0);
    if (!block.batch->law && ++found->second > 1) return true;
    if (is_new) links += over.size() - 1;
    nodes.insert(over.begin(), over.end());
  }
  return links >= nodes.size() && !nodes.empty();
}

// Blocks over the same bodies (a joint, its limit, its motor) are eliminated as one group. Rows are numbered in the
// order of elimination.
template <class S>
void System<S>::order_rows(const Bodies<S>& bodies) {
  std::map<std::vector<int>, int> group_over;
  std::map<int, std::vector<int>> groups_at;  // by body
  std::vector<int> rows, group, within;       // rows by group, the others by block
  const auto place = [&](const Block& block) {
    const auto over = movable_bodies(block, bodies);
    const auto [found, is_new] = group_over.emplace(over, static_cast<int>(rows.size()));
    if (is_new) {
      for (int body : over) groups_at[body].push_back(found->second);
      rows.push_back(0);
    }
    group.push_back(found->second);
    within.push_back(rows[found->second]);
    rows[found->second] += block.rows;
  };
  for (const Block& block : blocks) place(block);
  for (const Block& tension : tensions) place(tension);  // after the rows of their joints, which are exact
  std::vector<std::pair<int, int>> coupled;
  for (const auto& [body, groups] : groups_at)
    for (int i : groups)
      for (int j : groups)
        if (j < i) coupled.emplace_back(i, j);
  using Pivots = BasicLdlt<Real>;
  const bool light = std::is_same_v<T, float> && has_light_bodies(bodies);
  ldlt_.analyse(rows, coupled, light ? Pivots::pivot_share_of_products : Pivots::template pivot_share<T>);
  size_t i = 0;
  for (auto* list : {&blocks, &tensions})
    for (Block& block : *list) block.first = ldlt_.first(group[i]) + within[i], ++i;
}

template <class S>
void System<S>::list_products(const Bodies<S>& bodies) {
  struct Use {
    const Block* block;
    int position;
  };
  std::map<int, std::vector<Use>> uses;  // by movable body
  for (auto* list : {&blocks, &tensions}) {
    for (Block& block : *list) {
      const Batch<S>& batch = *block.batch;
      block.own = ldlt_.place(block.first, block.first);
      for (int k = 0; k < batch.ops->bodies; ++k) {
        const int body = batch.body[block.slot * batch.ops->bodies + k];
        if (!bodies.immovable(body)) uses[body].push_back({&block, k});
      }
    }
  }
  products_.clear();
  const auto width = [](const Block& block) { return S::freedom * block.batch->ops->bodies; };
  for (const auto& [body, list] : uses) {
    for (const Use& u : list) {
      for (const Use& v : list) {
        const Block &row = *u.block, &column = *v.block;
        if (row.first <= column.first) continue;
        products_.push_back({products<S>[dense::kind(row.rows)][dense::kind(column.rows)],
                             row.jacobian + S::freedom * u.position, column.jacobian + S::freedom * v.position,
                             width(row), width(column), row.rows, column.rows, ldlt_.place(row.first, column.first)});
      }
    }
  }
}

template <class S>
void System<S>::assemble(const Bodies<S>& bodies) {
  std::vector<Real>& K = ldlt_.values();
  std::fill(K.begin(), K.end(), 0.0);
  for (const Block& block : blocks) {
    Real *const J = jacobian_.data() + block.jacobian, *const weighted = weighted_.data() + block.jacobian,
                *const own = K.data() + block.own.at;
    block.batch->ops->dense(*block.batch, block.slot, bodies, J, weighted, own, block.own.stride);
    if (multiplies_own_) multiply_own<S>(block, J, weighted, own);
  }
  assemble_tensions(bodies);
  for (const Product& product : products_) product.add(product, jacobian_.data(), weighted_.data(), K.data());
}

#define CDOT_INSTANTIATE(S) template class System<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
