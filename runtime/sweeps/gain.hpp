// Euler's steps by sweeps make no energy up. Few sweeps leave impulses that do not belong to the poses, and move poses
// against loads. The energy that joints gave to an island since the start of the run is taken from the motion of its
// bodies against each other. If they cannot pay for a step, it goes back to its start and is taken more gently.
#pragma once

#include "runtime/state/world_data.hpp"

namespace cdot {

// Call before the poses of a step of h change: measures the energy of an island that changed from outside, or whose
// last step had another length.
template <class S>
void open_level(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double last_step);

// The kinetic energy of closing each gap of the slots [begin, end) in a step of h, (C / h)^2 / 2 K. C must be that of
// these poses; writes K.
template <class S>
double energy_of_gaps(Batch<S>& batch, int begin, int end, const Bodies<S>& bodies, double h);

// The energy of springs, less what was put in and plus what was taken. C must be that of the present poses.
template <class S>
double stored(const WorldData<S>& world, const Island<S>& island);
// The same at the start of a step; evaluates the rows, and K of springs given by their frequency.
template <class S>
double stored_at_start(WorldData<S>& world, Island<S>& island);

// Books the energy that the joints gave to the island in a step of h, or took, and takes out a gain since the start of
// the run. `stored` has risen by that much. False if the bodies cannot pay for it: then the poses or the momentum hold
// energy that the joints made up.
template <class S>
bool take_gain(WorldData<S>& world, Island<S>& island, double h, double stored);

// The start of a step: poses, velocities and whole turns in Flow, and the accounts.
struct Start {
  double put_in, taken, gained, level;
};
template <class S>
Start keep_start(WorldData<S>& world, Island<S>& island);
template <class S>
void go_back(WorldData<S>& world, Island<S>& island, const Start& start);

// The poses at the end of the step, where `speed` is left of the motion of bodies against each other. An island that
// spins freely turns, or keeps its orientation.
template <class S>
void move_slowly(WorldData<S>& world, Island<S>& island, typename S::Scalar h, double speed, bool turning = true);

// A step from that start in which no row acts: the bodies stand against each other.
template <class S>
void stand(WorldData<S>& world, Island<S>& island, typename S::Scalar h, const Start& start);

}  // namespace cdot
