// All of a World that no step changes: its settings, who is connected with whom, and in which order it is solved. A
// World of many equal mechanisms has one Model and a State for each of them.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <cdot/detail/block.hpp>
#include <cdot/integrators.hpp>
#include <cdot/settings.hpp>
#include <cdot/step_result.hpp>

#include "runtime/number/hash.hpp"

namespace cdot {

template <class S>
struct WorldData;
// How an island's rows are solved (runtime/solve/solver.hpp).
template <class S>
struct RowSolver;

// Where a joint's rows stand, or those of an effect on it.
struct Place {
  int batch;
  int home;  // BatchState::home of its slot, which is Batch::slot_of[home]
};

struct JointModel {
  int type;  // index into joint_types()
  std::vector<int> bodies;
  std::vector<Place> places;  // its own rows first, then its effects; none if all its bodies are immovable
  Hash added;                 // of what it was added as, with its effects
};

template <class S>
struct Drag {
  using T = typename S::Scalar;
  int body;
  T linear, angular;  // [1/s]
};

template <class S>
struct IslandModel {
  std::vector<int> bodies;  // movable ones
  std::vector<typename S::PointSpring> springs;
  std::vector<Drag<S>> drags;
  std::vector<int> gyroscopes;  // into Model::turning
  bool restless = false;        // driven by time: never sleeps
};

template <class S>
struct Model {
  using T = typename S::Scalar;
  // Looks at the World after every substep, as breaking loads do.
  using Hook = void (*)(WorldData<S>&, T h);

  Settings settings;
  OnFailure on_failure = OnFailure::stop;
  std::array<double, 3> origin{};  // [m] where the poses are counted from
  int ground = -1;
  std::vector<typename S::PointSpring> springs;
  std::vector<Drag<S>> drags;
  std::vector<int> turning;                            // bodies whose inertia tensor turns with them
  std::vector<std::pair<int, double>> breaking_loads;  // by joint
  std::vector<Hook> after_substep;
  std::vector<Note> notes;

  bool prepared = false;       // the following, and the order of slots, are those of the present joints
  std::vector<int> island_of;  // by body; -1: immovable

  // Steps are linearly implicit: effective masses change.
  bool may_stiffen() const { return row_of(settings.integrator).stiffens; }
  // The direct solver works on islands, or may have to.
  bool needs_systems() const { return !sweeps(settings.solver) || on_failure == OnFailure::retry; }
};

}  // namespace cdot
