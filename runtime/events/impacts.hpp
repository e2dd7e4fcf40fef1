// Inelastic impacts of rows under a law.
#pragma once

#include <limits>

#include "runtime/state/world_data.hpp"

namespace cdot {

// A blow lasts so long [s] where the method chooses its steps (Settings::local_error), otherwise one step.
inline constexpr double impact_time = 1e-3;

// The row that strikes hardest, and the kinetic energy of the island [J] that is not booked yet. source -1: no blow.
struct Blow {
  int source = -1, joint = -1;
  double left = 0;
  double follower = std::numeric_limits<double>::infinity();  // how hard the last one struck that followed
};

// Rows that close at contact stop by impulses: J v >= 0 with impulses >= 0. Joints take part, motors with a bounded
// force do not. The row that strikes hardest takes the energy of all. The load of such a blow is its impulse over h,
// the length of step(h), or over impact_time. By it a joint may break and a latch
// open, at once: true if one does. Choose modes again then. Writes `blow` if there is one.
template <class S>
bool stop_what_hits(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h, Blow& blow);

// True if the projection of the velocities after a blow makes a row that is off strike: a rope that the blow slackened
// is taut again, and pulls the bodies against an end that they have met. Choose modes again then.
template <class S>
bool another_follows(Island<S>& island, Blow& blow);

// Books what the projection of the velocities after a blow takes. Beside a body that is much lighter than its
// neighbours, round-off leaves it a part of what the blow takes.
template <class S>
void end_blow(WorldData<S>& world, const Island<S>& island, Blow& blow);

// Ends that are met and stop motors of unlimited force, whatever moves and whatever the forces are: `pressed`, and
// these motors `pushed` or `pulled`.
template <class S>
void find_pressed_ends(WorldData<S>& world, Island<S>& island);

// The other such motors that lack their rates reach them by impulses. True if these end a joint or a row: choose again.
template <class S>
bool start_motors(WorldData<S>& world, Island<S>& island, typename S::Scalar time, typename S::Scalar h);

}  // namespace cdot
