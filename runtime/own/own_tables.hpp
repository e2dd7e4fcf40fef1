// The rows of a kernel of tapes as the table of functions that solvers call.
#pragma once

#include <cdot/detail/block.hpp>

#include "derive/own/own_kernel.hpp"

namespace cdot {

// The largest joint whose loops are compiled in.
inline constexpr int most_own_bodies = 4, most_own_rows = most_rows;

// Valid for ever, as is `kernel`, of which `block` is a part.
template <class S>
const BlockOps<S>* own_block_ops(const OwnKernel& kernel, const OwnBlock& block);

// The laws of its effect, valid for ever too: along its own rows, of its bounded rows in their order, and on the
// coordinate of any joint.
template <class S>
const Law<S>* own_law(const OwnKernel& kernel);
template <class S>
std::vector<const Law<S>*> own_bounded_laws(const OwnKernel& kernel);
template <class S>
const Law<S>* own_law_on_coordinate(const OwnKernel& kernel);

}  // namespace cdot
