// All data of a World, by value and in arrays, for the stages that step() lists. Nobody outside
// runtime/ includes this.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <cdot/detail/block.hpp>
#include <cdot/detail/bodies.hpp>
#include <cdot/gyroscope.hpp>
#include <cdot/settings.hpp>
#include <cdot/step_counts.hpp>
#include <cdot/step_result.hpp>

#include "runtime/direct/system.hpp"
#include "runtime/number/broyden.hpp"
#include "runtime/number/hash.hpp"

namespace cdot {

// A slot of a batch: where a joint's rows, or those of an effect on it, are kept.
struct Place {
  int batch;
  int slot;
  int before_breaking = -1;  // the slot that a broken joint's rows had
};

struct JointRecord {
  int type;  // index into joint_types()
  std::vector<int> bodies;
  std::vector<double> parameters;
  std::vector<Place> places;  // its own rows first, then its effects; none if all its bodies are immovable
  bool broken = false;        // or removed
  Hash added{};               // of what it was added as, with its effects
};

template <class S>
struct Drag {
  using T = typename S::Scalar;
  int body;
  T linear, angular;  // [1/s]
};

// How an island's rows are solved (runtime/solve/solver.hpp).
template <class S>
struct RowSolver;

// What an integrator keeps of an island from one stage of a step to the next.
template <class S>
struct Flow {
  using T = typename S::Scalar;
  // Euler's methods and RATTLE: at the start of the step, [body]
  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  Broyden<ExactNumber<T>> search;  // RATTLE: for the impulses of its first half
  // Runge-Kutta:
  std::vector<T> start, now;  // poses and velocities as numbers, [body][S::pose_numbers + S::freedom]
  std::vector<T> rates;       // of them, [stage][...]
  int guarded = 0;            // rows that come and go at events
  // [guarded] What is not told apart of a row: of C [m, rad], of its rate, of its force.
  struct Told {
    T C, rate, force;
  };
  std::vector<Told> told;
  std::vector<T> row_rates;                // [guarded] J v + dC/dt
  std::vector<T> margins, margins_chosen;  // [guarded] how far from their next event; when their modes were chosen
  std::vector<T> low, high;                // the same at the start of a step, then on both sides of an event
  T residual = 0;                          // of C where the step starts
  T next_step = 0;                         // [s] that the error control proposes; 0: none yet
  T longest = 0;                           // [s] of the steps so far
  int slivers = 0;                         // steps in a row that were far shorter
  bool known = false;                      // C, J, forces and dv/dt belong to the end of the last step
  // A step of its own length may end beyond the time asked for. The bodies then stand between its ends.
  T ahead = 0;                     // [s] how far beyond; 0: they stand at its end
  T length = 0;                    // [s] of that step
  bool end_kept = false;           // the following belong to it
  std::vector<T> end, end_forces;  // the end, as `now`, and the joints' forces there, [row]
  std::vector<T> further_terms;    // of the interpolant, [term][...]
  // The present state is not one that the last step led to.
  void forget() {
    known = end_kept = false;
    ahead = 0;
  }
};

// What a step that fails goes back to.
template <class S>
struct Kept {
  using T = typename S::Scalar;
  // A body whose inertia tensor turns with it.
  struct Turning {
    typename std::conditional_t<S::has_gyroscopes, spatial::Vector<T>, int> momentum, spin;
    typename S::Velocity acceleration;
  };
  std::vector<std::pair<int, int>> runs;  // of the island's bodies that follow each other: first, count
  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  std::vector<typename S::InverseMass> effective_mass;  // where geometric stiffness adds to inertias; else none
  std::vector<Turning> gyroscopes;
  std::vector<T> rows;  // impulses, corrections and counters, segment by segment
  std::vector<unsigned char> dependent;
  T residual = 0;
  int redundant_rows = 0;
  bool evaluated = false;
};

// Bodies that push each other through joints and springs: solved together, and asleep together.
template <class S>
struct Island {
  using T = typename S::Scalar;
  std::vector<int> bodies;  // movable ones
  std::vector<Segment<S>> segments;
  std::vector<typename S::PointSpring> springs;
  std::vector<Drag<S>> drags;
  std::vector<int> gyroscopes;  // into WorldState::gyroscopes
  System<S> system;             // of the direct solver and of projections
  // The same with rows of tension, for steps that a method at acceleration level leaves to the linearly implicit one;
  // built where there are such rows.
  System<S> rescue;
  System<S>& at_work() { return stiffened && rescue.built() ? rescue : system; }
  const System<S>& at_work() const { return stiffened && rescue.built() ? rescue : system; }
  const RowSolver<S>* solver = nullptr;  // that of the settings, but where a step that failed is tried again
  bool stiffened = false;                // effective masses are more than masses: those of a linearly implicit step
  int redundant_rows = 0;                // of the last factorisation
  T size = 1;                            // its longest arm or distance between joined bodies [m]
  T scale = 1;            // ten times that, but at most 1: by how much less than for others C must be to be small
  bool restless = false;  // driven by time: never sleeps
  T residual = std::numeric_limits<T>::infinity();  // largest C left by the last correction
  bool evaluated = false;                           // C and J belong to the present poses
  bool factored = false;                            // and system to that J, all rows free
  // Integrated in continuous time, from event to event: rows under a law go by their mode.
  bool continuous = false;
  Flow<S> flow;
  bool asleep = false;
  double rested = 0;  // [s]
  Kept<S> kept;
  StepProblem trouble = StepProblem::none;  // that a stage of the step ran into
};

template <class S>
struct WorldState {
  using T = typename S::Scalar;
  // Something that must be looked at after every substep, such as breaking loads.
  struct Hook {
    void (*run)(WorldState&, T h);
    void (*undo)(WorldState&);  // of all since keep_state()
  };

  Settings settings;
  double time = 0;
  double last_step = 0;  // [s], the substep before: impulses kept for warm starting are scaled by h / last_step
  std::array<double, 3> origin{};  // [m] where the poses are counted from
  Bodies<S> bodies;
  int ground = -1;
  std::vector<JointRecord> joints;
  std::vector<std::unique_ptr<Batch<S>>> batches;
  std::vector<typename S::PointSpring> springs;
  std::vector<Drag<S>> drags;
  std::vector<typename S::Gyroscope> gyroscopes;       // bodies whose inertia tensor turns with them
  std::vector<std::pair<int, double>> breaking_loads;  // by joint
  std::vector<Hook> after_substep;
  std::vector<Note> notes;

  StepCounts counts;
  OnFailure on_failure = OnFailure::stop;
  double kept_time = 0, kept_last_step = 0;  // what a step that fails goes back to, beside Island::kept
  StepCounts kept_counts;
  std::vector<int> broken_in_step;  // joints, in the order in which they broke since then

  bool prepared = false;  // islands, order of slots and patterns are those of the present joints
  std::vector<Island<S>> islands;
  std::vector<int> island_of;  // by body; -1: immovable
  std::vector<int> awake;      // islands, in order

  // The direct solver works on islands, or may have to.
  bool needs_systems() const { return !sweeps(settings.solver) || on_failure == OnFailure::retry; }
};

// One of a joint's bodies that can move, in whose island it is; -1: none can.
template <class S>
int movable_body(const WorldState<S>& world, const JointRecord& record) {
  const auto body = std::find_if_not(record.bodies.begin(), record.bodies.end(),
                                     [&](int body) { return world.bodies.immovable(body); });
  return body == record.bodies.end() ? -1 : *body;
}

// `place` counted from the origin (sign -1), or back in the world (1).
template <class Place>
Place moved_by(Place place, const std::array<double, 3>& origin, double sign) {
  place.x += sign * origin[0];
  place.y += sign * origin[1];
  if constexpr (requires { place.z; }) place.z += sign * origin[2];
  return place;
}

// The ground stands at the origin, whatever that is: its points are counted from there as well.
template <class S>
typename S::Place place_in_world(const WorldState<S>& world, int body) {
  const auto place = S::place_of(world.bodies.pose.at(static_cast<size_t>(body)));
  return body == world.ground ? place : moved_by(place, world.origin, 1);
}

}  // namespace cdot
