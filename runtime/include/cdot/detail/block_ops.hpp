// The table of functions that solvers call for a row block, one constant for each: its loops and, where they exist,
// other ways to solve the same rows. A joint with coordinates only has no loops.
#pragma once

#include <cdot/detail/block_loops.hpp>

namespace cdot {

template <class... Arguments>
void do_nothing(Arguments...) {}

// The table of a joint with coordinates only.
template <class S, class Joint>
constexpr BlockOps<S> ops_without_rows() {
  using Parameters = typename Joint::template Parameters<typename S::Scalar>;
  BlockOps<S> ops{};
  ops.bodies = Joint::bodies;
  ops.parameter_size = sizeof(Parameters) / sizeof(typename S::Scalar);
  ops.evaluate = ops.position = do_nothing;
  ops.gamma = do_nothing;
  ops.effective_mass = do_nothing;
  ops.factorize = do_nothing;
  ops.velocity = do_nothing;
  ops.apply = do_nothing;
  ops.iterate = do_nothing;
  ops.soften = do_nothing;
  ops.correct = do_nothing;
  ops.displace = do_nothing;
  ops.dense = do_nothing;
  ops.add_stiffness = do_nothing;
  ops.stiffness = do_nothing;
  return ops;
}

// Only the functions that solve differ.
template <class S, class Joint, class Block, Kernels kernels>
constexpr BlockOps<S> make_other_ops() {
  using Other = BlockLoops<S, Joint, Block, kernels>;
  BlockOps<S> ops = BlockLoops<S, Joint, Block>::ops();
  ops.factorize = Other::factorize;
  if constexpr (kernels == Kernels::robust) ops.soften = Other::soften;
  if constexpr (kernels == Kernels::fast) {
    ops.iterate = Other::iterate;
    ops.correct = Other::correct;
  }
  return ops;
}

template <class S, class Joint, class Block, Kernels kernels>
inline constexpr BlockOps<S> other_ops = make_other_ops<S, Joint, Block, kernels>();

template <class S, class Joint, class Block>
constexpr BlockOps<S> make_block_ops() {
  if constexpr (Block::rows == 0) {
    return ops_without_rows<S, Joint>();
  } else {
    BlockOps<S> ops = BlockLoops<S, Joint, Block>::ops();
    constexpr int forms = is_extended<typename S::Scalar> ? 1 : Block::rows;  // extended precision needs one form only
    if constexpr (forms == 2) ops.fast = &other_ops<S, Joint, Block, Kernels::fast>;
    if constexpr (forms > 1) ops.robust = &other_ops<S, Joint, Block, Kernels::robust>;
    return ops;
  }
}

template <class S, class Joint, class Block>
inline constexpr BlockOps<S> block_ops = make_block_ops<S, Joint, Block>();

}  // namespace cdot
