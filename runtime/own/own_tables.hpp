// The rows of a kernel of tapes as the table of functions that solvers call.
#pragma once

#include <cdot/detail/block.hpp>

#include "derive/own/own_kernel.hpp"

namespace cdot {

// The largest joint whose loops are compiled in.
inline constexpr int most_own_bodies = 4, most_own_rows = 6;

// Valid for ever, as is `kernel`, of which `block` is a part.
template <class S>
const BlockOps<S>* own_block_ops(const OwnKernel& kernel, const OwnBlock& block);

}  // namespace cdot
