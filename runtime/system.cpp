#include "runtime/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "runtime/spaces.hpp"

namespace cdot {

template <class S>
void System<S>::build(const std::vector<Segment<S>>& segments, const Bodies<S>& bodies) {
  blocks.clear();
  offset_.clear();
  rows_ = 0;
  lawful_ = false;
  int numbers = 0;
  for (const Segment<S>& segment : segments) {
    lawful_ |= segment.batch->law != nullptr;
    for (int slot = segment.begin; slot < segment.end; ++slot) {
      blocks.push_back({segment.batch, slot, rows_});
      offset_.push_back(numbers);
      rows_ += segment.batch->ops->rows;
      numbers += segment.batch->ops->rows * segment.batch->ops->bodies * S::freedom;
    }
  }
  jacobian_.assign(static_cast<size_t>(numbers), 0.0);
  weighted_ = jacobian_;
  const auto n = static_cast<size_t>(rows_);
  for (auto* vector : {&b, &lambda, &softness, &right_side_, &product_}) vector->assign(n, 0.0);
  lower.assign(n, -std::numeric_limits<double>::infinity());
  upper.assign(n, std::numeric_limits<double>::infinity());
  for (auto* flags : {&fixed, &broken, &out_, &held_}) flags->assign(n, 0);
  list_products(bodies);
  built_ = true;
}

template <class S>
void System<S>::list_products(const Bodies<S>& bodies) {
  struct Use {
    int block, position;
  };
  std::map<int, std::vector<Use>> uses;  // by movable body
  for (int i = 0; i < static_cast<int>(blocks.size()); ++i) {
    const Batch<S>& batch = *blocks[i].batch;
    for (int k = 0; k < batch.ops->bodies; ++k) {
      const int body = batch.body[blocks[i].slot * batch.ops->bodies + k];
      if (!bodies.immovable(body)) uses[body].push_back({i, k});
    }
  }
  products_.clear();
  std::vector<std::pair<int, int>> entries;
  for (const auto& [body, list] : uses) {
    for (const Use& u : list) {
      for (const Use& v : list) {
        if (v.block > u.block) continue;
        products_.push_back({u.block, v.block, u.position, v.position, 0});
        for (int r = 0; r < blocks[u.block].batch->ops->rows; ++r)
          for (int s = 0; s < blocks[v.block].batch->ops->rows; ++s)
            entries.emplace_back(blocks[u.block].first + r, blocks[v.block].first + s);
      }
    }
  }
  ldlt_.analyse(rows_, entries);
  targets_.clear();
  for (Product& product : products_) {
    product.target = static_cast<int>(targets_.size());
    for (int r = 0; r < blocks[product.i].batch->ops->rows; ++r)
      for (int s = 0; s < blocks[product.j].batch->ops->rows; ++s)
        targets_.push_back(
            product.i == product.j && s > r
                ? -1
                : ldlt_.entry(blocks[product.i].first + r, blocks[product.j].first + s));
  }
}

template <class S>
void System<S>::assemble(const Bodies<S>& bodies) {
  for (size_t i = 0; i < blocks.size(); ++i)
    blocks[i].batch->ops->dense(*blocks[i].batch, blocks[i].slot, bodies,
                                jacobian_.data() + offset_[i], weighted_.data() + offset_[i]);
  std::vector<double>& K = ldlt_.values();
  std::fill(K.begin(), K.end(), 0.0);
  for (const Product& product : products_) {
    const BlockOps<S>& ops_i = *blocks[product.i].batch->ops;
    const BlockOps<S>& ops_j = *blocks[product.j].batch->ops;
    const int width_i = S::freedom * ops_i.bodies, width_j = S::freedom * ops_j.bodies;
    const double* J = jacobian_.data() + offset_[product.i] + S::freedom * product.body_i;
    const double* W = weighted_.data() + offset_[product.j] + S::freedom * product.body_j;
    const int* target = targets_.data() + product.target;
    for (int r = 0; r < ops_i.rows; ++r) {
      for (int s = 0; s < ops_j.rows; ++s, ++target) {
        if (*target < 0) continue;
        double sum = 0;
        for (int c = 0; c < S::freedom; ++c) sum += J[r * width_i + c] * W[s * width_j + c];
        K[*target] += sum;
      }
    }
  }
}

template <class S>
void System<S>::remove(const Batch<S>* batch, int slot, int last) {
  for (Block& block : blocks) {
    if (block.batch != batch || (block.slot != slot && block.slot != last)) continue;
    const bool removed = block.slot == slot;
    block.slot = removed ? last : slot;
    if (removed) std::fill_n(broken.begin() + block.first, batch->ops->rows, 1);
  }
}

template <class S>
void System<S>::load_laws() {
  each_row([&](int row, const Batch<S>& batch, int i) {
    if (!batch.law) return;
    softness[row] = batch.softness[i];
    lower[row] = batch.lower[i];
    upper[row] = batch.upper[i];
  });
}

template <class S>
int System<S>::factor() {
  for (int r = 0; r < rows_; ++r) out_[r] = fixed[r] | broken[r];
  return ldlt_.factor(softness.data(), out_.data());
}

template <class S>
void System<S>::solve() {
  bool any_fixed = false;
  for (int r = 0; r < rows_; ++r) {
    if (broken[r]) lambda[r] = 0.0;
    right_side_[r] = out_[r] ? lambda[r] : 0.0;
    any_fixed |= right_side_[r] != 0.0;
  }
  if (any_fixed) {
    ldlt_.multiply(right_side_.data(), product_.data());
    for (int r = 0; r < rows_; ++r)
      if (!out_[r]) right_side_[r] = -product_[r];
  }
  for (int r = 0; r < rows_; ++r)
    if (!out_[r]) right_side_[r] += b[r];
  ldlt_.solve(right_side_.data(), lambda.data());
}

// Moves rows that left their bounds onto them, and lets rows go whose bound pushes the wrong way.
// True if none had to.
template <class S>
bool System<S>::revise_active_set(bool one_by_one) {
  ldlt_.multiply(lambda.data(), product_.data());
  double scale = 0;
  for (int r = 0; r < rows_; ++r) scale = std::max(scale, std::abs(b[r]));
  const double tolerance = 1e-12 * scale;
  bool settled = true;
  for (int r = rows_ - 1; r >= 0; --r) {
    if (broken[r]) continue;
    if (!fixed[r]) {
      if (lambda[r] >= lower[r] && lambda[r] <= upper[r]) continue;
      fixed[r] = lambda[r] < lower[r] ? at_lower : at_upper;
      lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
    } else {
      const double excess = product_[r] + softness[r] * lambda[r] - b[r];  // J v + bias after it
      const bool holds = fixed[r] == at_lower ? excess >= -tolerance : excess <= tolerance;
      if (holds || lower[r] == upper[r]) continue;
      fixed[r] = free;
    }
    settled = false;
    if (one_by_one) return false;
  }
  return settled;
}

// The largest share of b by which a row within its bounds may miss it.
constexpr double missed = 1e-9;
// Of its own diagonal: what makes a row that depends on others one of its own.
constexpr double slight_softness = 1e-8;

// A motor and the limit that it runs into are one row twice: whichever elimination meets last is
// dropped as dependent, whatever it asks for. Where that leaves a row with a bound unsatisfied,
// such rows become slightly soft, so that the weaker of the two reaches its bound. True if there
// were any.
template <class S>
bool System<S>::part_contradicting_rows() {
  const auto bounded = [&](int r) { return std::isfinite(lower[r]) || std::isfinite(upper[r]); };
  double scale = 0;
  for (int r = 0; r < rows_; ++r) scale = std::max(scale, std::abs(b[r]));
  bool any = false;
  for (int r = 0; r < rows_; ++r)
    any |= bounded(r) && !fixed[r] && !broken[r] &&
           std::abs(product_[r] + softness[r] * lambda[r] - b[r]) > missed * scale;
  for (int r = 0; any && r < rows_; ++r)
    if (bounded(r)) softness[r] += slight_softness * ldlt_.values()[ldlt_.entry(r, r)];
  return any;
}

template <class S>
int System<S>::find_active_set() {
  // Exchanging all offenders at once is fast but may cycle; one at a time, always the last, does
  // not (Murty's rule).
  const int fast = 10, slow = std::min(2 * rows_, 200);
  int dependent = 0;
  for (int round = 0; round < fast + slow; ++round) {
    dependent = factor();
    solve();
    if (revise_active_set(round >= fast)) break;
  }
  return dependent;
}

template <class S>
int System<S>::solve_bounded() {
  fixed = held_;  // the rows that were held back in the step before
  for (int r = 0; r < rows_; ++r) {
    if (fixed[r]) lambda[r] = fixed[r] == at_lower ? lower[r] : upper[r];
    if (!std::isfinite(lambda[r])) fixed[r] = free;
  }
  int dependent = find_active_set();
  if (dependent > 0 && part_contradicting_rows()) dependent = find_active_set();
  held_ = fixed;
  for (int r = 0; r < rows_; ++r) lambda[r] = std::clamp(lambda[r], lower[r], upper[r]);
  return dependent;
}

#define CDOT_INSTANTIATE(S) template class System<S>;
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
