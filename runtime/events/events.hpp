// Rows under a law at acceleration level. Between two events each has a mode: off, held, or pushed with a known force.
// A step that passes an event is shortened to the event, and the modes are chosen again. Rows with such events are
// guarded rows.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Allocates the numbers of the island's guarded rows and of its bonds, the joints that may break.
template <class S>
void count_guarded_rows(Island<S>& island);

// Chooses the mode of each guarded row, after drop_modes(), for steps of about h. C and J must be those of the present
// poses. Impacts stop rows by impulses. Joints that carry too much break, one after the other. Leaves consistent
// velocities, accelerations and margins.
template <class S>
void choose_modes(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h);

// Writes J v + dC/dt of the guarded rows to Flow::row_rates, after an evaluation of C and J.
template <class S>
void note_rates(WorldData<S>& world, Island<S>& island);

// Writes each row's distance from its next event to Flow::margins, in units of the resolution. off: C - end. held:
// distance of the force from its bounds. pushed: the missing rate. Then each bond's from its event.
template <class S>
void measure_margins(const WorldData<S>& world, Island<S>& island, typename S::Scalar time);

// The distance of one row at its present C and this rate.
template <class S>
typename S::Scalar margin_of_row(const Batch<S>& batch, int i, const Resolution<typename S::Scalar>& resolution,
                                 typename S::Scalar rate);

// Sets all modes to `bounded`, as the other integrators need them.
template <class S>
void drop_modes(Island<S>& island);

}  // namespace cdot
