// One slot of a batch under a law, for queries.
#pragma once

#include <cdot/detail/block.hpp>

namespace cdot {

// The numbers of one slot, in a batch of its own: queries leave the World's rows unchanged, since the next step may
// start from them.
template <class S>
void copy_slot(const Batch<S>& from, int slot, Batch<S>& to) {
  const auto copy = [&](const auto& array, int width, auto& numbers) {
    numbers.assign(array.begin() + slot * width, array.begin() + (slot + 1) * width);
  };
  to.ops = from.ops;
  to.law = from.law;
  to.kinds.assign(from.kinds.begin(), from.kinds.end());
  copy(from.body, from.ops->bodies, to.body);
  copy(from.parameters, from.ops->parameter_size, to.parameters);
  copy(from.counters, from.counters.empty() ? 0 : from.ops->counters, to.counters);
  copy(from.constants, from.law->constants, to.constants);
  copy(from.happened, from.law->distance ? 1 : 0, to.happened);
  to.drives.clear();
  if (from.driven()) {
    const auto drives = from.drives_of(slot);
    to.drives.assign(drives.begin(), drives.end());
    to.first_drive = {0, static_cast<int>(drives.size())};
    to.home.assign(1, 0);
    copy(from.spans, 2, to.spans);
  }
  to.jacobian.resize(static_cast<size_t>(from.ops->jacobian_size));
  to.factor.resize(static_cast<size_t>(from.triangle()));
  to.C.resize(static_cast<size_t>(from.ops->rows));
  to.bias.resize(static_cast<size_t>(from.ops->rows));
}

}  // namespace cdot
