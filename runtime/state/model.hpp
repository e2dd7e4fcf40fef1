// The part of a World that no step changes: settings, connections, order of the solution.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <string_view>
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

// The place of the rows of a joint or of an effect.
struct Place {
  int batch;
  int home;  // BatchState::home of its slot, which is Batch::slot_of[home]
};

// A number of a joint's rows that follows a function of time.
struct JointDrive {
  int place;  // of the effect whose constant it is; -1: a parameter of the joint, in all its places
  Drive drive;
};

struct JointModel {
  int type;  // index into joint_types()
  std::vector<int> bodies;
  std::vector<Place> places;  // the joint's rows, then its effects; empty if all bodies are immovable
  Hash added;                 // of its definition and effects at first
  std::vector<JointDrive> drives{};
  int companion = -1;  // a joint that is removed with it: the damper of a spring without length
};

// Who puts work in or takes it. Rows of joints and of generated effects have a source for each joint type, after these.
enum class Source : char { outside, damping, torque, spring, motor, friction, limit, breaking, sleep };
inline constexpr std::string_view source_names[] = {
    "changes from outside", "damping", "torque", "spring", "motor", "friction", "limit", "breaking", "sleep"};

template <class S>
struct Drag {
  using T = typename S::Scalar;
  int body;
  T linear, angular;  // [1/s]
};

// An effect that ends its joint (FunctionsOnCoordinate::breaks).
struct Bond {
  int joint;
  std::string type;
  std::function<double(const double* parameters, double time, double load)> distance;
  std::vector<double> parameters;
  bool in_time;
};

template <class S>
struct IslandModel {
  std::vector<int> bodies;  // movable ones
  std::vector<int> bonds;   // into Model::bonds
  std::vector<Drag<S>> drags;
  std::vector<int> gyroscopes;  // into Model::turning
  bool restless = false;        // depends on t: never sleeps
  bool works = false;           // forces without a potential may act: dampers, motors, limits, joints in time, torques
  bool rows_work = false;       // some of them are more than torques, which in space may be set at any time
  bool driven = false;          // exact rows depend on t
  // Conserves linear momentum, and angular momentum: no immovable body, no drag, every row free of the world.
  bool floats = false, spins_freely = false;
};

template <class S>
struct Model {
  using T = typename S::Scalar;
  // Called after every substep, for example by what breaks joints.
  using Hook = void (*)(WorldData<S>&, T h);

  Settings settings;
  OnFailure on_failure = OnFailure::stop;
  std::array<double, 3> origin{};  // [m] origin of the poses
  int ground = -1;
  std::vector<Drag<S>> drags;
  std::vector<int> turning;  // bodies whose inertia tensor turns with them
  std::vector<Bond> bonds;
  std::vector<Hook> after_substep;
  std::vector<Note> notes;
  std::vector<std::string_view> sources{std::begin(source_names), std::end(source_names)};

  bool driven = false;  // numbers follow functions of time

  bool prepared = false;       // the members below and the order of slots are current
  std::vector<int> island_of;  // by body; -1: immovable

  // True for linearly implicit steps, which change effective masses.
  bool may_stiffen() const { return row_of(settings.integrator).stiffens; }
  // True if the direct solver works on islands, always or in a retry.
  bool needs_systems() const { return !sweeps(settings.solver) || on_failure == OnFailure::retry; }
};

}  // namespace cdot
