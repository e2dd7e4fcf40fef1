// Every registered joint as row blocks: joint, coordinates and immovable variants. One template makes the table from
// the generated structs. A World looks a joint up by number.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <cdot/detail/block_ops.hpp>
#include <cdot/detail/bounded_law.hpp>
#include <cdot/detail/effect_law.hpp>
#include <cdot/joints.hpp>

namespace cdot {

// A row block for general bodies and its variants with one immovable body: (index of that body, loops). Coordinates and
// extended precision have only the general block: their variants would be a fifth of the library. The general block
// gives the same bits, because an immovable body's inverse mass is 0.
template <class S>
struct BlockVariants {
  const BlockOps<S>* general;
  std::vector<std::pair<int, const BlockOps<S>*>> immovable;

  // The cheapest block for these bodies. With several immovable bodies the first variant is enough: the other inverse
  // masses are 0.
  const BlockOps<S>* choose(const Bodies<S>& bodies, std::span<const int> body) const {
    for (const auto& [index, ops] : immovable)
      if (bodies.immovable(body[static_cast<size_t>(index)])) return ops;
    return general;
  }
  // True for every form in which the rows are solved.
  bool has(const BlockOps<S>* ops) const {
    const auto is = [&](const BlockOps<S>* one) {
      return ops == one || (ops && (ops == one->fast || ops == one->robust));
    };
    return is(general) ||
           std::any_of(immovable.begin(), immovable.end(), [&](const auto& one) { return is(one.second); });
  }
};

// A bounded row of an effect, on one of its coordinates.
template <class S>
struct BoundedEntry {
  using T = typename S::Scalar;
  int coordinate;
  std::string_view name;
  const Law<S>* law;
  std::function<void(T C, const T* parameters, T time, RowBounds<T>&)> bounds;
};

template <class S>
struct JointEntry {
  BlockVariants<S> rows;
  std::vector<BlockVariants<S>> coordinates;  // in the order of JointType::coordinates
  // Writes the default of parameter `index`, computed from the poses, the earlier parameters and the time.
  std::function<void(int index, const typename S::Pose* q, typename S::Scalar* parameters, typename S::Scalar time)>
      default_value;
  const Law<S>* law = nullptr;  // of an effect
  std::vector<BoundedEntry<S>> bounded{};
};

template <class S, class Effect, class Row>
BoundedEntry<S> bounded_entry() {
  using T = typename S::Scalar;
  return {Row::coordinate, Row::name, &bounded_law<S, Effect, Row>,
          [](T C, const T* parameters, T time, RowBounds<T>& B) {
            const T value[1] = {C};
            Row::bounds(value, *reinterpret_cast<const typename Effect::template Parameters<T>*>(parameters), time, B);
          }};
}

template <class S, class Joint, class Block>
BlockVariants<S> block_variants() {
  BlockVariants<S> variants{&block_ops<S, Joint, Block>, {}};
  const auto add = [&]<class Variant>(std::type_identity<Variant>) {
    variants.immovable.emplace_back(Variant::immovable_body, &block_ops<S, Joint, Variant>);
  };
  if constexpr (requires { typename Block::Immovable; } && !is_extended<typename S::Scalar>) {
    [&]<class... Variants>(std::type_identity<std::tuple<Variants...>>) {
      (add(std::type_identity<Variants>{}), ...);
    }(std::type_identity<typename Block::Immovable>{});
  }
  return variants;
}

template <class S, class Joint>
JointEntry<S> joint_entry() {
  using T = typename S::Scalar;
  JointEntry<S> entry{block_variants<S, Joint, Joint>(), {}, nullptr, nullptr};
  if constexpr (requires { Joint::is_effect; } && Joint::rows > 0) entry.law = &effect_law<S, Joint>;
  if constexpr (requires { typename Joint::Bounded; }) {
    [&]<class... Rows>(std::type_identity<std::tuple<Rows...>>) {
      (entry.bounded.push_back(bounded_entry<S, Joint, Rows>()), ...);
    }(std::type_identity<typename Joint::Bounded>{});
  }
  [&]<class... Coordinates>(std::type_identity<std::tuple<Coordinates...>>) {
    (entry.coordinates.push_back({&block_ops<S, Joint, Coordinates>, {}}), ...);
  }(std::type_identity<typename Joint::Coordinates>{});
  entry.default_value = [](int index, const typename S::Pose* q, T* parameters, T time) {
    using Parameters = typename Joint::template Parameters<T>;
    using Poses = const typename S::Pose[Joint::bodies];
    Joint::default_value(index, reinterpret_cast<Poses&>(*q), *reinterpret_cast<Parameters*>(parameters), time);
  };
  return entry;
}

// In the order of joint_types(). One file per space and scalar defines this function: in the library for the whole
// catalogue, or in a program that chose its joints (cdot_use_joints). cdot/detail/add_joints.hpp appends entries.
template <class S>
std::vector<JointEntry<S>>& joint_entries();

template <class S, class... Joints, class... Effects>
std::vector<JointEntry<S>> make_joint_entries(std::type_identity<std::tuple<Joints...>>,
                                              std::type_identity<std::tuple<Effects...>> = {}) {
  return {joint_entry<S, Joints>()..., joint_entry<S, Effects>()...};
}

}  // namespace cdot
