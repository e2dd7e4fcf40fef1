// The row by which an island comes nearest to a loss of rank.
#pragma once

#include <cdot/world.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {

// As the last factor of the system has it.
template <class S>
WeakestRow weakest_row(System<S>& system) {
  WeakestRow weakest;
  system.each_row([&](int row, const Batch<S>& batch, int i) {
    if (system.fixed[row] || system.broken[row] || system.dependent(row)) return;
    const double share = double(system.pivot(row) / system.diagonal(row));
    if (share < weakest.share) weakest = {share, batch.joint[i / batch.ops->rows], i % batch.ops->rows};
  });
  return weakest;
}

}  // namespace cdot
