// Joints that break by effects of specs (Bond). These add no rows: they read the load on the joint's own rows.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// The joint of the island that carries most beyond its strength, by its impulses over the last substep of h, which ends
// at `time`; -1 if none breaks.
template <class S>
int overloaded_joint(const WorldData<S>& world, const Island<S>& island, double time, double h);

// How far a joint is from breaking by the last substep, which ended at `time`; infinite if it is broken.
template <class S>
double distance_from_break(const WorldData<S>& world, const Bond& bond, double time);

// Takes the rows of the joint out of its island. It does not allocate. Evaluate anew afterwards.
template <class S>
void break_joint(WorldData<S>& world, Island<S>& island, int joint, double time);

// Breaks the joint that carries most beyond its strength and evaluates the others. Batch::lambda holds the forces, then
// `over` is 1, or the impulses of a blow that lasts so long. False if none breaks.
template <class S>
bool break_by_lambda(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar over);

// Updates the places of rows from BatchState::home and the broken joints, after slots changed places.
template <class S>
void find_rows(WorldData<S>& world, Island<S>& island);

// Flow::margins of the island's bonds, after those of its guarded rows.
template <class S>
void measure_margins_of_bonds(const WorldData<S>& world, Island<S>& island, double time);

}  // namespace cdot
