// Gives a joint, or an effect on one, its slot in the batch of its kind.
#pragma once

#include <span>

#include "runtime/state/world_data.hpp"

namespace cdot {

template <class S>
void add_rows(WorldData<S>& world, int joint, const BlockOps<S>* ops, const Law<S>* law, std::vector<RowKind> kinds,
              std::span<const double> constants);

// The one row of a joint's coordinate under an effect's law. Returns its index into JointRecord::places. Throws Error
// if there is no such joint or coordinate; does nothing, and returns -1, for a joint between immovable bodies.
template <class S>
int add_coordinate_row(WorldData<S>& world, int joint, std::string_view coordinate, const Law<S>* law,
                       std::span<const double> constants);

// Throws Error if there is no such joint.
template <class S>
void check_joint(const WorldData<S>& world, int joint);

// Index into JointType::coordinates. Throws Error, listing those there are.
template <class S>
int coordinate_index(int type, std::string_view name);

}  // namespace cdot
