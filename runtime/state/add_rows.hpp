// Adds a joint, or an effect on one, as a slot to the batch of its kind.
#pragma once

#include <span>

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
void add_rows(WorldData<S>& world, int joint, const BlockOps<S>* ops, const Law<S>* law, std::vector<RowKind> kinds,
              std::span<const double> constants, std::string_view source = {});

// Adds the one row of a coordinate under an effect's law. `source` names its work, if not its joint or its kind.
// Returns the index into JointRecord::places; -1 without a row if all bodies are immovable. Throws Error if the joint
// or the coordinate does not exist.
template <class S>
int add_coordinate_row(WorldData<S>& world, int joint, std::string_view coordinate, const Law<S>* law,
                       std::span<const double> constants, std::string_view source = {});

// Adds the bounded rows of an effect.
template <class S>
void add_bounded_rows(WorldData<S>& world, int joint);

// Throws Error if the joint does not exist.
template <class S>
void check_joint(const WorldData<S>& world, int joint);

// Index into JointType::coordinates. Throws Error with a list of the coordinates.
template <class S>
int coordinate_index(int type, std::string_view name);

}  // namespace cdot
