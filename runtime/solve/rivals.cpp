#include "runtime/solve/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <cdot/spaces.hpp>

namespace cdot {
namespace {

// Rows of a joint are the same up to a factor if their K is, to this share.
template <class T>
constexpr double parallel = by_precision<T>(1e-4, 1e-9);
// Rates that differ by this share agree.
template <class T>
constexpr double agree = by_precision<T>(1e-4, 1e-9);

template <class S>
struct RowOfBodies {
  Batch<S>* batch;
  int home;
  std::vector<int> bodies;  // in order
};

template <class S>
std::span<const int> bodies_of(const Batch<S>& batch, int slot) {
  const size_t bodies = static_cast<size_t>(batch.ops->bodies);
  return {&batch.body[static_cast<size_t>(slot) * bodies], bodies};
}

template <class S>
struct DenseRow {
  Batch<S>* batch;
  int slot;
  typename System<S>::Real J[S::freedom * most_bodies], weighted[S::freedom * most_bodies], K;
};

template <class S>
DenseRow<S> row_of(const WorldData<S>& world, Batch<S>* batch, int home) {
  DenseRow<S> row{batch, batch->slot_of[static_cast<size_t>(home)], {}, {}, 0};
  batch->ops->dense(*batch, row.slot, world.bodies, row.J, row.weighted, &row.K, 1);
  return row;
}

// Rates, in units of those of the first row of a pair.
struct Range {
  double least = -std::numeric_limits<double>::infinity(), most = -least;
};

// The rates J v of a row that it lets a motion have; `turns`: its J by that of the first row.
template <class S>
Range allowed(const DenseRow<S>& row, double turns) {
  const double rate = -double(row.batch->bias[row.slot]) / turns;
  Range range;
  const bool pushes = std::isinf(row.batch->upper[row.slot]), pulls = std::isinf(row.batch->lower[row.slot]);
  if (turns > 0 ? pushes : pulls) range.least = rate;
  if (turns > 0 ? pulls : pushes) range.most = rate;
  return range;
}

template <class S>
bool contradict(const DenseRow<S>& one, const DenseRow<S>& other) {
  using T = typename S::Scalar;
  double across = 0;  // J_one M^-1 J_other^T
  const auto bodies = bodies_of(*one.batch, one.slot), others = bodies_of(*other.batch, other.slot);
  for (size_t k = 0; k < bodies.size(); ++k) {
    const size_t l = static_cast<size_t>(std::ranges::find(others, bodies[k]) - others.begin());
    for (size_t i = 0; i < S::freedom; ++i)
      across += double(one.J[S::freedom * k + i]) * double(other.weighted[S::freedom * l + i]);
  }
  if (!(across * across > (1 - parallel<T>)*double(one.K) * double(other.K)) || across == 0) return false;
  const Range a = allowed(one, 1), b = allowed(other, across / double(one.K));
  const double gap = std::max(a.least - b.most, b.least - a.most);
  const double scale =
      std::max(std::abs(double(one.batch->bias[one.slot])), std::abs(double(other.batch->bias[other.slot])));
  return gap > agree<T> * scale;
}

template <class S>
bool may_be_rival(const Batch<S>& batch) {
  return is_motor(batch) && batch.ops->rows == 1 && !batch.law->force && !batch.law->by_load;
}

}  // namespace

template <class S>
void list_rivals(Island<S>& island) {
  island.rivals.clear();
  std::vector<RowOfBodies<S>> rows;
  for (const auto& [batch, begin, end, whole] : island.segments)
    for (int slot = begin; may_be_rival(*batch) && slot < end; ++slot) {
      const auto bodies = bodies_of(*batch, slot);
      rows.push_back({batch, batch->home[slot], {bodies.begin(), bodies.end()}});
      std::ranges::sort(rows.back().bodies);
    }
  const auto fewer = [](const auto& a, const auto& b) {
    return std::ranges::lexicographical_compare(a.bodies, b.bodies);
  };
  std::ranges::stable_sort(rows, fewer);
  for (size_t k = 0; k < rows.size(); ++k)
    for (size_t l = k; l-- > 0 && !fewer(rows[l], rows[k]);)
      island.rivals.push_back({rows[l].batch, rows[k].batch, rows[l].home, rows[k].home});
}

template <class S>
void count_rivals(WorldData<S>& world, System<S>& system) {
  const auto [row, other] = system.rivals();
  if (row < 0 || world.at_once) return;
  if (world.counts->contradicted++ > 0) return;
  system.each_row([&, row = row, other = other](int r, const Batch<S>& batch, int i) {
    if (r == row) world.counts->contradicted_joint = batch.joint[i / batch.ops->rows];
    if (r == other) world.counts->contradicting_joint = batch.joint[i / batch.ops->rows];
  });
}

template <class S>
void count_rivals(WorldData<S>& world, const Island<S>& island) {
  const auto joint = [](const Batch<S>& batch, int home) {
    return batch.joint[static_cast<size_t>(batch.slot_of[static_cast<size_t>(home)])];
  };
  const auto unlimited = [](const Batch<S>& batch, int home) {
    return is_unlimited(batch, batch.slot_of[static_cast<size_t>(home)]);
  };
  for (const RivalRows<S>& rows : island.rivals) {
    const int one = joint(*rows.one, rows.home), other = joint(*rows.other, rows.other_home);
    if (world.at_once || world.joints[one].broken || world.joints[other].broken) continue;
    if (!unlimited(*rows.one, rows.home) || !unlimited(*rows.other, rows.other_home)) continue;
    if (!contradict(row_of(world, rows.one, rows.home), row_of(world, rows.other, rows.other_home))) continue;
    if (world.counts->contradicted++ > 0) continue;
    world.counts->contradicted_joint = one, world.counts->contradicting_joint = other;
  }
}

#define CDOT_INSTANTIATE(S)                              \
  template void list_rivals(Island<S>&);                 \
  template void count_rivals(WorldData<S>&, System<S>&); \
  template void count_rivals(WorldData<S>&, const Island<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
