// Row blocks as a solver sees them: arrays of numbers and functions that loop over them. Which
// joint, coordinate or immovable variant stands behind a block is not known here.
#pragma once

#include <cmath>
#include <vector>

#include <cdot/detail/bodies.hpp>
#include <cdot/kernel.hpp>
#include <cdot/settings.hpp>

namespace cdot {

template <class S>
struct Batch;

// The loops of one row block over the slots [begin, end) of a batch, made by
// runtime/include/cdot/detail/block_loops.hpp.
template <class S>
struct BlockOps {
  using T = typename S::Scalar;
  using Real = ExactNumber<T>;
  using Velocity = typename S::Velocity;
  using Slots = Batch<S>&;

  int bodies, rows;
  int parameter_size, jacobian_size;  // in numbers of type T
  int counters;                       // of whole turns, per slot
  bool explicit_time;

  // Starts to count the turns of one slot at the present poses. Null: no counters.
  void (*start_counting)(Slots, int slot, const Bodies<S>&, T time);
  // C and J, and the rows' drift dC/dt where C depends on the time.
  void (*evaluate)(Slots, int begin, int end, const Bodies<S>&, T time);
  // C alone, at the present poses.
  void (*position)(Slots, int begin, int end, const Bodies<S>&, T time);
  // gamma = -Jdot v - d/dt(dC/dt) at the present poses and velocities.
  void (*gamma)(const Batch<S>&, int begin, int end, const Bodies<S>&, T time, T* gamma);
  // K from J, one triangle, into `factor`; or in its place its factorisation.
  void (*effective_mass)(Slots, int begin, int end, const Bodies<S>&);
  void (*factorize)(Slots, int begin, int end, const Bodies<S>&);
  // J velocity.
  void (*velocity)(const Batch<S>&, int begin, int end, const Velocity* velocity, T* Jv);
  // velocity += M^-1 J^T lambda, lambda laid out like the batch's.
  void (*apply)(const Batch<S>&, int begin, int end, const Bodies<S>&, const T* lambda, Velocity*);
  // One sweep of sequential impulses over exact rows, added to `lambda` and to the velocities.
  void (*iterate)(const Batch<S>&, int begin, int end, const Bodies<S>&, Velocity*, T* lambda);
  // One sweep of Newton on C, with the J and K of the step: displaces by what K lambda = -C says.
  void (*correct)(Slots, int begin, int end, Bodies<S>&, T time);
  // Moves the poses of one slot by M^-1 J^T lambda; collects the moves in displacement, lambda in correction.
  void (*displace)(Slots, int slot, Bodies<S>&, const T* lambda);
  // J and (M^-1 J^T)^T of one slot, [rows][freedom * bodies], and the lower triangle of K, row by
  // row `stride` apart, all computed in what K is formed in.
  void (*dense)(const Batch<S>&, int slot, const Bodies<S>&, Real* J, Real* weighted, Real* K, int stride);
  // stiffness -= what d(J^T lambda)/dq says of each body's own turning, lambda from the last step
  // with its drift correction.
  void (*add_stiffness)(const Batch<S>&, int begin, int end, const Bodies<S>&, T time,
                        typename S::Stiffness* stiffness);
  // d(J^T lambda)/dq of one slot, [freedom * bodies] square, with any lambda.
  void (*stiffness)(const Batch<S>&, int slot, const Bodies<S>&, T time, const T* lambda, T* H);
  // The same block with its rows solved otherwise; null where that is no different.
  const BlockOps *fast, *robust;

  const BlockOps* with(Kernels kernels) const {
    const BlockOps* const other = kernels == Kernels::fast ? fast : kernels == Kernels::robust ? robust : nullptr;
    return other ? other : this;
  }
};

// What a row under a law does between two events, for integrators at acceleration level.
enum class Mode : char {
  bounded,  // whatever its bounds allow, found anew in every step: for the other integrators
  off,      // out of reach or letting go: no force
  held,     // keeps its rate, with a force within its bounds
  pushed,   // its force is known: that of a spring, or a bound that it has reached
};

// When a row under a law acts, and what it then does. One bound at 0 makes it one-sided: it acts where C has come to
// `end`, and its force then pushes away from there.
template <class T>
struct Guard {
  T off_by;        // C - end: what is to be corrected while the row is held; 0 for rows without an end
  T rate;          // that J v + dC/dt has while the row is held
  T lower, upper;  // of its force
  bool one_sided() const { return (lower == T(0)) != (upper == T(0)); }
  bool bilateral() const { return std::isinf(lower) && std::isinf(upper); }
  // How far from acting; only for one-sided rows.
  T gap() const { return lower == T(0) ? off_by : -off_by; }
};

// No row block has more rows, nor more bodies.
inline constexpr int most_rows = 8, most_bodies = 8;

// How rows that are not plainly exact get their bias, softness and bounds: one constant per effect,
// defined where the effect is. A batch under no law has none of these numbers.
template <class S>
struct Law {
  using T = typename S::Scalar;
  int constants;  // numbers per slot that the law keeps in Batch::constants
  bool reported;  // its error counts in worst_position_error(): the joint's own rows, not an
                  // effect's
  // Fills bias, softness, lower and upper of [begin, end) from C, K and the constants.
  void (*fill)(Batch<S>&, int begin, int end, T h, const Settings&);
  // What the drift correction shall remove of one slot's C, row by row. Null: nothing.
  void (*error)(const Batch<S>&, int slot, T* error);
  // Potential energy of one slot. Null: none.
  double (*energy)(const Batch<S>&, int slot);
  // Of one slot, row by row, from C and its rate: the force of a spring; or, where that is null, when the row acts.
  void (*force)(const Batch<S>&, int slot, const T* rate, T* force);
  void (*guard)(const Batch<S>&, int slot, Guard<T>* guards);
};

template <class S>
struct BatchModel {
  const BlockOps<S>* ops = nullptr;
  const Law<S>* law = nullptr;  // null: exact rows, J v = -bias
  std::vector<RowKind> kinds;   // [rows]
};

// By slot. Breaking joints exchange slots.
template <class S>
struct BatchState {
  using T = typename S::Scalar;
  StateArray<int> home;      // the slot's number when islands were last analysed
  StateArray<int> joint;     // that it belongs to
  StateArray<int> body;      // [slot][bodies]
  StateArray<T> parameters;  // [slot][parameter_size]
  StateArray<T> counters;    // [slot][ops->counters]
  StateArray<T> lambda;      // [slot][rows] impulse of the velocity solve, kept for the next step
  StateArray<T> correction;  // [slot][rows] impulse of the drift correction
  // [slot][rows], only under a law. In continuous time the bounds go with the mode, from event to event.
  StateArray<Mode> mode;
  StateArray<T> softness, lower, upper;
  StateArray<T> constants;  // [slot][law->constants]
};

template <class S>
struct BatchWorkspace {
  using T = typename S::Scalar;
  std::vector<int> slot_of;  // by home
  std::vector<T> jacobian;   // [slot][jacobian_size]
  std::vector<T> factor;     // [slot][rows (rows + 1) / 2]
  std::vector<T> C, bias;    // [slot][rows], as all below
  std::vector<T> rate;       // J times the velocities last asked about
  std::vector<T> error;      // the part of C that a projection is to remove
  std::vector<T> impulse;    // of one round of a projection, or a force that is known
};

// All blocks of one kind under one law, slot by slot. Slots of an island are neighbours.
template <class S>
struct Batch : BatchModel<S>, BatchState<S>, BatchWorkspace<S> {
  using T = typename S::Scalar;
  int count() const { return static_cast<int>(this->joint.size()); }
  int triangle() const { return this->ops->rows * (this->ops->rows + 1) / 2; }
};

// The slots of a batch that belong to one island: those of broken joints lie between `end` and `whole_end`.
template <class S>
struct Segment {
  Batch<S>* batch;
  int begin, end, whole_end;
};

}  // namespace cdot
