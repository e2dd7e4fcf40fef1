// Cones at acceleration level: rows of one force of bounded size (solve/loads.hpp) between two events. They are `held`,
// or they slip and are `pushed`: their force has the size of its bound and the direction against the slip.
//
// Batch::share_of_cone() of rows that slip is a vector along the force: its size is the speed of the slip when the
// modes were chosen. The slower a slip, the faster its direction may change, and past its end it is that of the way
// back. So an event is where the slip along the vector has become a hundred times slower or faster: from there it is
// noted anew. The end of a slip thus takes a few events, and the force is smooth between them.
#pragma once

#include "runtime/solve/loads.hpp"

namespace cdot {

// The directions of forces at the present velocities, into LoadedRow::share; dC/dt must be in the bias. The second
// function bounds the rows by them, without a load.
template <class S>
void aim_cones(const WorldData<S>& world, Island<S>& island);
template <class S>
void bound_aimed_cones(Island<S>& island);

// A first mode, from the rates in the batches, and bounds without a load. True if the forces must decide.
template <class S>
bool offer_bounds_to_cones(Island<S>& island);
// `pushed` where the force has reached its bound, else `held` without bounds.
template <class S>
void decide_about_cones(Island<S>& island);

// Lowers Flow::margins of their rows, which are those of events of specs: held, to the force from its bound; pushed, to
// the speed that is left before it is noted anew.
template <class S>
void measure_margins_of_cones(Island<S>& island);

}  // namespace cdot
