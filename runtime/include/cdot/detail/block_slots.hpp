// How the loops of a block read the numbers of a slot: bodies, parameters, J.
#pragma once

#include <algorithm>
#include <type_traits>

#include <cdot/detail/block.hpp>

namespace cdot {

// A generated block is a struct of static functions. A block that a program makes while it runs has an object behind
// it, and arrays of Parameters and Jacobian with fewer numbers than these structs.
template <class Block>
inline constexpr bool is_made_by_program = !std::is_empty_v<Block>;
template <class Block, class S>
Block block_of(const Batch<S>& batch) {
  if constexpr (is_made_by_program<Block>) return Block(batch.ops->context);
  else return {};
}

// Joint defines the parameters. Block is the joint, a coordinate, or one of these with an immovable body.
template <class S, class Joint, class Block>
struct BlockSlots {
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;
  using Parameters = typename Joint::template Parameters<T>;
  using Jacobian = typename Block::template Jacobian<T>;
  static constexpr int bodies = Block::bodies;

  // An empty struct (all entries of J are known) has size 1 but no numbers.
  template <class Struct>
  static constexpr int numbers() {
    return std::is_empty_v<Struct> ? 0 : static_cast<int>(sizeof(Struct) / sizeof(T));
  }

  // Generated structs consist of numbers of type T only; this reads them from arrays of T.
  template <class Struct, class Number>
  static auto& as(Number* numbers_of, int slot, [[maybe_unused]] int stride) {
    using Target = std::conditional_t<std::is_const_v<Number>, const Struct, Struct>;
    if constexpr (std::is_empty_v<Struct>) {
      static Struct nothing;  // no array contains it
      return static_cast<Target&>(nothing);
    } else if constexpr (is_made_by_program<Block>) {
      return *reinterpret_cast<Target*>(numbers_of + slot * stride);
    } else {
      return *reinterpret_cast<Target*>(numbers_of + slot * numbers<Struct>());
    }
  }
  static const Parameters& parameters(const Batch<S>& batch, int slot) {
    return as<Parameters>(batch.parameters.data(), slot, batch.ops->parameter_size);
  }
  template <class AnyBatch>
  static auto& entries(AnyBatch& batch, int slot) {
    return as<Jacobian>(batch.jacobian.data(), slot, batch.ops->jacobian_size);
  }

  static const int* bodies_of(const Batch<S>& batch, int slot) { return batch.body.data() + slot * bodies; }

  template <class Item>
  static void gather(const StateArray<Item>& from, const int* body, Item (&to)[bodies]) {
    for (int k = 0; k < bodies; ++k) to[k] = from[static_cast<size_t>(body[k])];
  }

  // The numbers of J in K's number type.
  static auto exact_entries(const Batch<S>& batch, int slot) {
    using Exact = typename Block::template Jacobian<Real>;
    if constexpr (is_made_by_program<Block>) {
      Exact numbers;
      const int count = batch.ops->jacobian_size;
      std::copy_n(batch.jacobian.data() + slot * count, count, numbers.number);
      return numbers;
    } else {
      return exact<Exact, T>(entries(batch, slot));
    }
  }
};

}  // namespace cdot
