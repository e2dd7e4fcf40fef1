// Row blocks as a solver sees them: arrays of numbers and functions that loop over them. Solvers do not know the joint,
// coordinate or immovable variant behind a block.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <cdot/detail/bodies.hpp>
#include <cdot/kernel.hpp>
#include <cdot/profile.hpp>
#include <cdot/settings.hpp>

namespace cdot {

template <class S>
struct Batch;

// How a soft sweep solves exact rows: for J v = -(bias + rate C), with the softness share K_rr of each row.
template <class T>
struct SoftSweep {
  T rate = 0, share = 0;
};

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
  bool lacks_position;  // rows of velocities: C is 0

  // Starts counting the whole turns of one slot at the present poses. Null: no counters.
  void (*start_counting)(Slots, int slot, const Bodies<S>&, T time);
  // C, J and, in the bias, dC/dt (0 unless C depends on t explicitly).
  void (*evaluate)(Slots, int begin, int end, const Bodies<S>&, T time);
  // C alone, at the present poses.
  void (*position)(Slots, int begin, int end, const Bodies<S>&, T time);
  // gamma = -Jdot v - d/dt(dC/dt) at the present poses and velocities.
  void (*gamma)(const Batch<S>&, int begin, int end, const Bodies<S>&, T time, T* gamma);
  // K = J M^-1 J^T into `factor` (lower triangle), or the factorisation of K.
  void (*effective_mass)(Slots, int begin, int end, const Bodies<S>&);
  void (*factorize)(Slots, int begin, int end, const Bodies<S>&);
  // J velocity.
  void (*velocity)(const Batch<S>&, int begin, int end, const Velocity* velocity, T* Jv);
  // velocity += M^-1 J^T lambda, lambda laid out like the batch's.
  void (*apply)(const Batch<S>&, int begin, int end, const Bodies<S>&, const T* lambda, Velocity*);
  // One sweep of sequential impulses over exact rows, added to `lambda` and to the velocities.
  void (*iterate)(const Batch<S>&, int begin, int end, const Bodies<S>&, Velocity*, T* lambda);
  // The same for soft rows, with K in place of its factors.
  void (*soften)(const Batch<S>&, int begin, int end, const Bodies<S>&, Velocity*, T* lambda, SoftSweep<T>);
  // One sweep of Newton on C with the step's J and K: K lambda = -C, then displace().
  void (*correct)(Slots, int begin, int end, Bodies<S>&, T time);
  // Moves the poses of one slot by M^-1 J^T lambda; adds the moves to displacement and lambda to correction.
  void (*displace)(Slots, int slot, Bodies<S>&, const T* lambda);
  // J and (M^-1 J^T)^T of one slot, [rows][freedom * bodies], and the lower triangle of K with rows `stride` apart, all
  // computed in K's number type.
  void (*dense)(const Batch<S>&, int slot, const Bodies<S>&, Real* J, Real* weighted, Real* K, int stride);
  // stiffness -= the part of d(J^T lambda)/dq that concerns each body's own rotation. lambda is that of the last step,
  // with its drift correction.
  void (*add_stiffness)(const Batch<S>&, int begin, int end, const Bodies<S>&, T time,
                        typename S::Stiffness* stiffness);
  // d(J^T lambda)/dq of one slot for the given lambda, [freedom * bodies] square.
  void (*stiffness)(const Batch<S>&, int slot, const Bodies<S>&, T time, const T* lambda, T* H);
  // The same block with other ways to solve K lambda = rhs; null if there is no difference.
  const BlockOps *fast, *robust;
  // The object behind a block that is no generated struct; else null.
  const void* context;

  const BlockOps* with(Kernels kernels) const {
    const BlockOps* const other = kernels == Kernels::fast ? fast : kernels == Kernels::robust ? robust : nullptr;
    return other ? other : this;
  }
};

// The mode of a row under a law between two events, for integrators at acceleration level.
enum class Mode : char {
  bounded,  // for the other integrators: every step solves within the bounds
  off,      // out of reach or let go: no force
  held,     // the rate is prescribed, the force lies within its bounds
  pushed,   // the force is known: its upper bound
  pulled,   // the same at the lower bound
  pressed,  // an end that a motor of unlimited force presses on: held, by a force of any sign
  gripped,  // by RATTLE: a motor, clutch or friction held at the end of the last step; an end presses at its start, too
};

// True if the rate is prescribed.
constexpr bool holds(Mode mode) { return mode == Mode::held || mode == Mode::pressed; }

// True if every step solves within the bounds.
constexpr bool within_bounds(Mode mode) { return mode == Mode::bounded || mode == Mode::gripped; }

// The events of a row so far: it acts after `began`, if its law waits for that, and until `ended`.
enum class Event : char { none = 0, began = 1, ended = 2, both = 3 };

// The conditions under which a row under a law acts. A row with one bound at 0 is one-sided: it acts where C has
// reached `end`, with a force away from the end.
template <class T>
struct Guard {
  T off_by;               // C - end: the error while the row is held; 0 for rows without an end
  T rate;                 // J v + dC/dt while the row is held
  T lower, upper;         // of its force
  T acceleration = T(0);  // the derivative of `rate` by time
  bool of_rate = false;   // it has no end, though one bound may be 0: a clutch that drives one way
  bool one_sided() const { return !of_rate && (lower == T(0)) != (upper == T(0)); }
  bool bilateral() const { return std::isinf(lower) && std::isinf(upper); }
  // Distance from acting, for one-sided rows only.
  T gap() const { return lower == T(0) ? off_by : -off_by; }
};

// Stiffness and damping of a row that is a spring: force = -k C - d dC/dt.
template <class T>
struct SpringNumbers {
  T k, d;
};

// The largest numbers of rows and of bodies in a row block.
inline constexpr int most_rows = 8, most_bodies = 8;

// Gives rows their bias, softness and bounds. Each effect defines one constant Law. Exact rows have no law and none of
// these numbers.
template <class S>
struct Law {
  using T = typename S::Scalar;
  int constants;  // numbers per slot that the law keeps in Batch::constants
  bool reported;  // true for joints, false for effects: the error counts in worst_position_error()
  // Fills bias, softness, lower and upper of [begin, end) from C, K and the constants.
  void (*fill)(Batch<S>&, int begin, int end, T h, const Settings&);
  // The part of one slot's C that the projection removes, by row. Null: none.
  void (*error)(const Batch<S>&, int slot, T* error);
  // Potential energy of one slot. Null: none.
  double (*energy)(const Batch<S>&, int slot);
  // For one slot, by row, from C and its rate: a spring's force; if `force` is null, the guards.
  void (*force)(const Batch<S>&, int slot, const T* rate, T* force);
  void (*guard)(const Batch<S>&, int slot, Guard<T>* guards);
  // Stiffness and damping of one slot, by row, from C and K; both 0 where no spring acts. Null: no row is a spring.
  void (*spring)(const Batch<S>&, int slot, SpringNumbers<T>*) = nullptr;
  // Of an effect: the part of `force` that no energy stores. Its `fill` and `spring` read Batch::rate. Null: the laws
  // of springs and constant forces, whose dampers are all that is not stored.
  void (*unstored)(const Batch<S>&, int slot, const T* rate, T* force) = nullptr;
  bool stores_part = false;  // an energy stores a part of the force, and not all of it
  bool in_time = false;      // the force depends on the time: its island never sleeps
  // Of an effect whose force has limits: stiffness and damping within these. Null: no limits.
  void (*within_limits)(const Batch<S>&, int slot, SpringNumbers<T>*) = nullptr;
  bool moving = false;  // of a bounded row: its bounds may change with C or with the time
  // Of a row whose bounds grow with a load: what each newton of it adds to them. Null: they do not.
  void (*by_load)(const Batch<S>&, int slot, T* lower, T* upper) = nullptr;
  // The rows of the same joint that carry that load; null: the joint's own, whose resultant force it is.
  const Law<S>* load_of = nullptr;
  // Of a row of a cone: rows of the same joint, in order, that one force of bounded size prescribes together. Its place
  // among them, and their number; 0: the row is alone. The last constant of each row is its part of a direction, that
  // of the force where the rows slip (runtime/solve/loads.hpp).
  int cone_row = 0, cone_rows = 0;
  // Of a row with events, given the rate of C and the force: how far the row is from its begin and its end, negative
  // beyond. A condition that the law lacks is infinitely far. Null: no events.
  void (*distance)(const Batch<S>&, int slot, T rate, T force, T (&from)[2]) = nullptr;
  // True if the energy of one slot changes with K. Null: never.
  bool (*by_mass)(const Batch<S>&, int slot) = nullptr;
  // dE/dt of one slot at the present C, as its parameters follow functions of time. Null: as `energy`.
  double (*power)(const Batch<S>&, int slot) = nullptr;
  // The object behind a law that is of no generated struct; else null.
  const void* context = nullptr;

  bool is_of_effect() const { return unstored != nullptr; }
};

// A number of a slot that follows a function of time.
struct Drive {
  int number;  // of its parameters or, of_row, of its constants
  bool of_row;
  Profile profile;
  double offset;        // added to the profile: the origin of a point in the world
  double above, below;  // its range; outside it becomes NaN, at which the step fails
  ProfileValue now{};   // without the offset
};

template <class S>
struct BatchModel {
  const BlockOps<S>* ops = nullptr;
  const Law<S>* law = nullptr;  // null: exact rows, J v = -bias
  std::vector<RowKind> kinds;   // [rows]
  size_t source = 0;            // of the work of these rows, in Model::sources
  bool own = false;             // rows of joints, not of what acts on their coordinates
};

// Arrays by slot. Slots change places when a joint breaks.
template <class S>
struct BatchState {
  using T = typename S::Scalar;
  StateArray<int> home;      // the slot's number at the last analysis of islands
  StateArray<int> joint;     // joint of the slot
  StateArray<int> body;      // [slot][bodies]
  StateArray<T> parameters;  // [slot][parameter_size]
  StateArray<T> counters;    // [slot][ops->counters]
  StateArray<T> lambda;      // [slot][rows] impulse of the velocity solve, start of the next step
  StateArray<T> correction;  // [slot][rows] impulse of the drift correction
  // [slot][rows], only under a law. For integrators at acceleration level the mode sets the bounds, from event to
  // event.
  StateArray<Mode> mode;
  StateArray<T> softness, lower, upper;
  StateArray<T> constants;     // [slot][law->constants]
  StateArray<Event> happened;  // [slot], of laws with events
  // [slot][from, until] the span of the step for numbers in time (cdot/profile.hpp); empty if there are none.
  StateArray<double> spans;
};

template <class S>
struct BatchWorkspace {
  using T = typename S::Scalar;
  std::vector<int> slot_of;  // by home
  std::vector<T> jacobian;   // [slot][jacobian_size]
  std::vector<T> factor;     // [slot][rows (rows + 1) / 2]
  std::vector<T> C, bias;    // [slot][rows], as all below
  std::vector<T> rate;       // J v of the last velocities
  std::vector<T> error;      // the part of C that a projection removes
  std::vector<T> impulse;    // of one round of a projection, or a known force
  // RATTLE: forces of the last kick, those at rest, and what no energy stores of them where Law::stores_part.
  std::vector<T> at_rest, unstored_at_rest;
  std::vector<T> acted;  // J v at which known forces acted, at acceleration level
  std::vector<T> load;   // [slot] force that bounds grow with (runtime/solve/loads.hpp), at acceleration level
  T time = 0;            // of C
  // Numbers in time, those of a slot from first_drive[home] to first_drive[home + 1]; both empty if there are none.
  std::vector<Drive> drives;
  std::vector<int> first_drive;
};

// All blocks of one kind under one law, by slot. The slots of an island are contiguous.
template <class S>
struct Batch : BatchModel<S>, BatchState<S>, BatchWorkspace<S> {
  using T = typename S::Scalar;
  int count() const { return static_cast<int>(this->joint.size()); }
  int triangle() const { return this->ops->rows * (this->ops->rows + 1) / 2; }
  bool driven() const { return !this->drives.empty(); }
  bool explicit_time() const { return this->ops->explicit_time || driven(); }
  // Of a row of a cone: its part of a direction (Law::cone_rows).
  T& share_of_cone(int slot) { return this->constants[(slot + 1) * this->law->constants - 1]; }
  std::span<Drive> drives_of(int slot) { return range(this->drives, this->first_drive, slot); }
  std::span<const Drive> drives_of(int slot) const { return range(this->drives, this->first_drive, slot); }

 private:
  template <class Drives>
  auto range(Drives& drives, const std::vector<int>& first, int slot) const {
    const auto home = static_cast<size_t>(this->home[static_cast<size_t>(slot)]);
    return std::span(drives.data() + first[home], drives.data() + first[home + 1]);
  }
};

// The slots of a batch in one island. Slots of broken joints lie between `end` and `whole_end`.
template <class S>
struct Segment {
  Batch<S>* batch;
  int begin, end, whole_end;
};

}  // namespace cdot
