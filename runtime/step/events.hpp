// Rows under a law in continuous time. Between two events each has a mode: out of reach, held, or pushed with a known
// force. A step that ends where a mode no longer holds is shortened to the event, and the modes are chosen anew.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Makes room for the island's rows that come and go.
template <class S>
void count_guarded_rows(Island<S>& island);

// What each row does from here on, in steps of about h, after drop_modes(); C and J are evaluated at the present poses.
// What hits something stops there, by impulses. Ends with velocities that fit, with accelerations, and with the
// margins.
template <class S>
void choose_modes(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h);

// J v + dC/dt of these rows into Flow::row_rates, where C and J were just evaluated.
template <class S>
void note_rates(WorldData<S>& world, Island<S>& island);

// Into Flow::margins, from these rates and the forces found since, how far each row is from its next event, in units of
// the resolution: C - end where it is out of reach, the force short of its bounds where it is held, the rate still
// missing where it is pushed.
template <class S>
void measure_margins(Island<S>& island);

// The rows are left to their bounds again, as the other integrators want them.
template <class S>
void drop_modes(Island<S>& island);

}  // namespace cdot
