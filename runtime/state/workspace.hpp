// Intermediate results of a step: J, K, factors, stages. A step computes them from the State.
#pragma once

#include <limits>
#include <vector>

#include <cdot/step_result.hpp>

#include "runtime/direct/system.hpp"
#include "runtime/number/broyden.hpp"
#include "runtime/number/lu.hpp"

namespace cdot {

// Of an implicit Runge-Kutta method (step/collocation.hpp). m: velocity components of the island's bodies.
template <class T>
struct CollocationWorkspace {
  std::vector<double> by_pose, by_velocity;  // d(dv/dt) by displacements and by velocities at the start, m x m by rows
  std::vector<double> turns;                 // d(pose numbers)/dt of a unit velocity, by body and component
  bool differentiated = false;               // these belong to Flow::start
  // Known forces, those of springs and dampers, by row: their accelerations; their own derivatives.
  std::vector<double> by_force, force_by_pose, force_by_velocity;
  std::vector<double> base, base_forces;  // accelerations and forces at the start
  std::vector<char> base_within;          // of each of these forces: it is not at a limit; empty if none has limits
  std::vector<T> forces, laws;            // forces taken at the stages and those of their laws, [stage][row]
  Lu<double> real;
  Lu<Complex> complex;
  std::vector<double> real_side, real_turned;  // right-hand sides, by numbers and by velocity components
  std::vector<Complex> complex_side, complex_turned;
  std::vector<T> increments, changes;  // of the numbers at the stages, [stage][...]
  std::vector<T> slopes;               // of the last step, [power][...]; for the first guess of the increments
  bool foresees = false;               // slopes is set
  std::vector<T> error;                // estimated, of the numbers at the end
};

// C of a guarded row and its rate at the start of a step.
template <class T>
struct StartOfWay {
  T C = T(0), rate = T(0);
  bool near = false;                                  // the way comes near an event
  double least = std::numeric_limits<double>::max();  // margin at the stages, of rows that these tell of
  double past = 1;                                    // share of the step, at the earliest stage beyond the event
  T met = T(0);  // Resolution::rate by which its event was met at the end of the step before; 0: it was not
};

template <class S>
struct FlowWorkspace {
  using T = typename S::Scalar;
  // Euler's methods and RATTLE, by body: poses at the start of the step; velocities there, or before RATTLE's second
  // kick.
  std::vector<typename S::Pose> pose;
  std::vector<typename S::Velocity> velocity;
  Broyden<ExactNumber<T>> search;  // RATTLE: search for the impulses of its first half
  std::vector<T> kept;             // midpoint rule: impulses at the start of a part
  // Runge-Kutta:
  std::vector<T> now;               // numbers of a stage, laid out like FlowState::start
  std::vector<T> low, high;         // margins at the start of a step, then on both sides of an event
  std::vector<StartOfWay<T>> ways;  // [guarded]
  std::vector<T> at_stages;         // forces of held rows, rates of others, [guarded][stage]
  std::vector<double> first_kick;   // of rows with bounds: [J] in the first of two kicks
  int guarded = 0;                  // number of guarded rows
  float alike = 0;                  // the smaller error estimate of the last attempt, as a share of the other
  T fixed_step = 0;                 // its length; 0: the error chooses the steps
  bool projects_stages = false;     // in steps near a loss of rank
  bool locates = false;             // this step locates all loads in time, so its end need not look for them
  bool motors_struck = false;       // in this step of RATTLE, before its drift: begin_kick_drift()
  bool astray = false;              // the last attempt at a step reversed a joint's direction
  // Pivots of K at the stages of a step, as shares of their diagonals, and these, [stage][row]; of one row
  // (step/rank_loss.hpp).
  std::vector<double> pivots, diagonals, of_row;
  T start_residual = 0;                   // largest C at the start of the step
  std::vector<T> start_left;              // Island::left there
  std::vector<T> start_turns, end_turns;  // counters of whole turns there, and at its end
  CollocationWorkspace<T> collocation;
};

// A row whose bounds grow with the load that other rows of its joint carry, or a row of a cone (solve/loads.hpp).
template <class S>
struct LoadedRow {
  using T = typename S::Scalar;
  Batch<S>*batch, *carrier;  // carrier: null without a load
  int home, carrier_home;    // Batch::slot_of[home]
  int block = -1;            // of the row, in System::blocks; -1: without a system
  int carrier_block = -1;
  T lower, upper;         // its bounds without the load; of a cone, of the whole force
  T by_lower, by_upper;   // what each unit of the load adds to them
  T arms[3 * most_rows];  // of the force on the last body, by row of the carrier; unused for a single row
  T load = 0, found = 0;  // as assumed, and as the solution has it
  // Of a cone whose direction is to be found: the bound of the force along this row, with the sign of that force, as
  // assumed and as the solution has it.
  bool turns = false;
  T corner = 0, corner_found = 0;
  T before = 0;  // impulse of the row before the present solution that is a part of the same force
  T share = 0;   // of a cone whose direction is known, at acceleration level: the part of this row in it

  int place() const { return batch->slot_of[static_cast<size_t>(home)]; }
};

// Two rows over the same bodies that may ask for different rates (solve/rivals.hpp).
template <class S>
struct RivalRows {
  Batch<S>*one, *other;
  int home, other_home;  // Batch::slot_of[home]
};

template <class S>
struct IslandWorkspace {
  std::vector<Segment<S>> segments;
  std::vector<size_t> working;  // of these, whose rows may do work without a potential
  bool by_mass = false;         // energies of some may change with K
  System<S> system;             // of the direct solver and of projections
  // The same with rows of tension, for steps in which a Runge-Kutta method falls back to an implicit one. Built
  // only if such rows exist.
  System<S> rescue;
  std::vector<LoadedRow<S>> loads;
  std::vector<typename S::Scalar> load_changes;
  Broyden<typename S::Scalar> load_search;
  std::vector<RivalRows<S>> rivals;
  // Shares: of the impulses in Batch::correction that loads count, and of a load in the bounds of a kick.
  typename S::Scalar corrections_in_loads = 0, loads_in_kick = 1;
  // Share of the impulses in Batch::correction that belong to the present force of a cone and to its load.
  typename S::Scalar corrections_in_cones = 0;
  // The source of a joint whose number in time has just passed a kink, until the velocities follow; -1: none.
  int kinked = -1;
  bool latched = false;                     // an event of a row has happened at the end of this substep
  bool jams = false;                        // no load was found that bounds the forces which it comes from
  const RowSolver<S>* solver = nullptr;     // that of the settings, except in a retry
  bool stiffened = false;                   // linearly implicit step: effective masses include stiffness
  StepProblem trouble = StepProblem::none;  // problem found by a stage of the step
  // With StepProblem::moved_far: the error, the way and the body of the projection.
  double misfit = 0, moved = 0;
  int moved_body = -1;

  System<S>& at_work() { return stiffened && rescue.built() ? rescue : system; }
  const System<S>& at_work() const { return stiffened && rescue.built() ? rescue : system; }
};

class Paces;  // pace.hpp

struct Workspace {
  // Of accelerations, counted as StepCounts::evaluations: beyond them fall_back() finishes every step.
  double most_evaluations = std::numeric_limits<double>::infinity();
  // Of steps that the local error chooses: those of an earlier run, to follow; and where to note those of this one.
  const Paces* paced_by = nullptr;
  Paces* paces = nullptr;
  // [m], [rad] of C: RATTLE's rounds may leave so much in a step that is only compared with others.
  double enough = 0;
  // A longer step, only compared with others: it fails where it would be taken in parts, or by J of other poses.
  bool at_once = false;
  // Of islands' rows by steps on velocities, by the direct solver: their price where rows press on each other.
  long long solves = 0;
  // Steps that the local error chose, but whose error estimates of different orders are alike: forces have kinks within
  // them, or change as quickly.
  long long kinked = 0;
  std::vector<int> awake;  // islands, in order
};

}  // namespace cdot
