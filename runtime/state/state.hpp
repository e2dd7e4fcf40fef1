// All that a run is made of: who has these numbers, and the Model, can go on with the same bits. StateNumbers and
// StateArrays lie in one block of bytes (runtime/state/block.hpp); the state of bodies is in <cdot/detail/bodies.hpp>,
// that of rows in <cdot/detail/block.hpp>, that of a system in runtime/direct/system.hpp.
#pragma once

#include <limits>

#include <cdot/detail/state_array.hpp>
#include <cdot/step_counts.hpp>

namespace cdot {

struct JointState {
  StateNumber<bool> broken = false;  // or removed
  StateArray<double> parameters;
};

// Of rows that come and go: smaller differences of C [m, rad], of its rate and of its force count as none.
template <class T>
struct Resolution {
  T C, rate, force;
};

// Memory of the Runge-Kutta methods. Poses and velocities are numbers by body, [S::pose_numbers + S::freedom].
template <class S>
struct FlowState {
  using T = typename S::Scalar;
  StateArray<Resolution<T>> resolution;  // [guarded], as the three that follow
  StateArray<T> row_rates;               // J v + dC/dt
  StateArray<T> margins;                 // how far rows are from their next event
  StateArray<T> margins_chosen;          // the same when their modes were chosen
  StateNumber<T> next_step = T(0);       // [s] that the error control proposes; 0: none yet
  StateNumber<T> longest = T(0);         // [s] of the steps so far
  StateNumber<int> slivers = 0;          // steps in a row that were far shorter
  StateNumber<bool> known = false;       // C, J, forces and dv/dt belong to the end of the last step
  // A step of its own length may end beyond the time asked for. The bodies then stand between its ends.
  StateNumber<T> ahead = T(0);         // [s] how far beyond; 0: they stand at its end
  StateNumber<T> length = T(0);        // [s] of that step
  StateNumber<bool> end_kept = false;  // `end` and `end_forces` belong to it
  StateArray<T> start, end;            // of that step, as numbers
  StateArray<T> end_forces;            // of the joints, by row
  StateArray<T> rates;                 // of the numbers, [stage][...]
  StateArray<T> further_terms;         // of the interpolant, [term][...]

  // The present state is not one that the last step led to.
  void forget() {
    known = end_kept = false;
    ahead = T(0);
  }
};

template <class S>
struct IslandState {
  using T = typename S::Scalar;
  StateNumber<T> size = T(1);  // its longest arm or distance between joined bodies [m]
  // Ten times that, but at most 1: by how much less than for others C must be to be small.
  StateNumber<T> scale = T(1);
  StateNumber<T> residual = std::numeric_limits<T>::infinity();  // largest C left by the last correction
  StateNumber<T> evaluated_at = T(0);                            // [s]
  StateNumber<bool> evaluated = false;                           // C and J belong to the present poses
  StateNumber<bool> factored = false;                            // and the system to that J, all rows free
  StateNumber<bool> continuous = false;  // integrated from event to event: rows under a law go by their mode
  StateNumber<bool> asleep = false;
  StateNumber<double> rested = 0.0;     // [s]
  StateNumber<int> redundant_rows = 0;  // of the last factorisation
};

template <class S>
struct State {
  StateNumber<double> time = 0.0;
  StateNumber<double> last_step =
      0.0;  // [s], the substep before: impulses kept for warm starting are scaled by h / last_step
  StateNumber<StepCounts> counts;
  StateArray<typename S::Gyroscope> gyroscopes;  // of Model::turning
};

}  // namespace cdot
