// The parts of a mechanism, and lines of a step that methods share, as text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cdot::compile {

// Rows of joints, effects by forces, rows with bounds, and among these some with ends; bodies in space, and among these
// some whose inertia turns with them.
struct Contents {
  bool rows = false, effects = false, bounded = false, ends = false;
  bool events = false;                                       // among rows with bounds some that begin or end to act
  bool late_ends = false;                                    // that wait for an event
  bool numbers_of_J = false;                                 // J is not constant
  bool forces = false;                                       // by the force that a row carries
  bool spatial = false, gyroscopes = false, angles = false;  // angles: that count whole turns
  // By RATTLE: effects act by their rates at the start; rates at the end are looked for; the end solves for more than
  // the joints, and so does the start of a run.
  bool rattle = false, midpoint = false, dampens = false, looks = false, finishes = false, exerts = false;
  bool frees = false;          // by RATTLE, rows of velocities are free in the first half
  bool carries = false;        // by RATTLE, forces at the end read the spin of a body whose inertia turns
  bool ends_drift = false;     // by the midpoint rule, ends move, or coordinates by time alone
  bool modes = false;          // of rows with bounds by Runge-Kutta methods
  bool loads = false;          // bounds of these that grow with loads
  bool cones = false;          // one force along several of these
  bool strong = false;         // motors without a largest force among these
  bool bonds = false;          // some joint may break
  bool snaps = false;          // by Runge-Kutta methods: when it does is located in a step
  bool bears = false;          // among these are effects and soft joints
  bool bears_end = false;      // whose forces act at the end of a step, too
  bool shares = false;         // loads of these are shared among redundant rows
  bool weighs = false;         // by Euler's steps or RATTLE: the impulses of corrections count as loads
  bool clutches = false;       // by RATTLE: rows with bounds among which some drive one way
  bool drags = false;          // some body has drag
  bool foresees = false;       // the multipliers of the next projection, by those of the last steps
  bool one_freedom = false;    // by Euler's steps: they go in a few angles
  bool open = false;           // no step projects its end
  bool feeds = false;          // velocities take a share of C back
  bool turns = false;          // some body does
  bool taut = false;           // by the midpoint rule: tension has rows between bodies
  bool apart = false;          // by explicit Runge-Kutta methods: stages read no centre of mass and no velocity of one
  std::size_t collocated = 0;  // by Radau IIA: components of velocities
  bool strides() const { return modes || snaps; }                             // steps end strides at events
  bool projects() const { return (rows || modes) && !open; }                  // velocities
  bool strikes() const { return exerts && ends; }                             // impacts end what the next step repeats
  bool starts_motors() const { return rattle && loads && strong; }            // by blows that load friction
  bool sticks() const { return rattle && exerts && bounded; }                 // rows may reach their rates in a step
  bool repeats() const { return (weighs || clutches) && exerts && bounded; }  // forces of rows that prescribe a rate
  bool corrects_loads() const { return loads && (weighs || midpoint); }       // by impulses beside those found
  bool carries_over() const { return loads && weighs && !rattle; }            // impulses of the last corrections
  bool weighs_joints() const { return weighs && (bonds || loads) && rows; }
  bool shares_impulses() const { return shares && weighs_joints(); }
  bool closes() const { return (rows || ends) && !open; }
  bool approaches() const { return late_ends && closes(); }
  bool stiffens() const { return midpoint && (rows || bounded) && (turns || taut); }  // by tension
  bool weighs_blows() const { return snaps && modes; }                                // of impacts, as loads of joints
  bool replaces() const {
    return strides() || midpoint || collocated > 0 || approaches() || one_freedom;
  }                                                           // some lanes of a State
  bool pulls() const { return rattle && (rows || bounded); }  // a State has its joints' accelerations
};

// Of the function that steps a State.
inline constexpr std::string_view step_head = "step(State& s, T h = T(default_step))";

inline constexpr const char* evaluates = "    evaluate($ss.q, s.time, s.J);\n";
inline constexpr const char* follows = "    follow(s);\n";

// The numbers of another State in the lanes of `now`.
inline constexpr const char* replaces = R"(
  static void replace(State& s, const State& from, const Mask& now) {
    T* const numbers = reinterpret_cast<T*>(&s);
    const T* const others = reinterpret_cast<const T*>(&from);
    for (unsigned i = 0; i < sizeof s / sizeof(T); ++i) numbers[i] = select(now, others[i], numbers[i]);
  }
)";

// With `moves`.
inline constexpr const char* closes_unforeseen = R"(    T total[rows];
    for (int i = 0; i < bodies; ++i) moves[i] = still();
    for (int i = 0; i < rows; ++i) total[i] = T(0);
    close(s, at, T(0.2), T(1) < T(0), moves, total);
)";

// During h, from the poses of `from`, "s" or "at".
inline std::string drifts(const Contents& has, const std::string& from, const std::string& h = "h") {
  if (has.gyroscopes) return "    drift(s, " + from + ".q, " + h + ");\n";
  return "    for (int i = 0; i < bodies; ++i) move(s.q[i], " + from + ".q[i], " + h + " * s.v[i]);\n    turn(s.q);\n";
}

}  // namespace cdot::compile
