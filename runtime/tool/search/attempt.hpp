// One run of a search, and its distance from a coarser one.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/tool/run/simulate.hpp"
#include "runtime/tool/search/knobs.hpp"
#include "runtime/tool/search/stiffness.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot {

struct Attempt {
  Try knob;
  RunResult result;
  std::vector<Frame> frames;  // at the ends of the intervals
  std::vector<Frame> rows;
  std::shared_ptr<Paces> paces;           // of its steps
  std::shared_ptr<const Paces> paced_by;  // of the run that it follows; empty: of none
  double energy_share = 0;                // the largest error of the energy so far, see EnergyWatch
  std::vector<double> energy_shares;      // up to each of `frames`
  double price = 0;
  long long left_steps = 0;                                   // to another method, within its bounds
  bool full = false;                                          // it has the outputs asked for
  bool whole = false;                                         // it has ended in time and well
  double apart = std::numeric_limits<double>::infinity();     // distance from a coarser run
  double achieved = std::numeric_limits<double>::infinity();  // as that distance makes sure
  double claimed = std::numeric_limits<double>::infinity();   // Choice::achieved
  double holds_until = 0, of_events = 0;                      // as in Choice
  bool reached = false;
  bool dear = false;         // explicit steps seemed dear, as where a fast oscillation bounds their length
  bool swings = false;       // see swings()
  double damped = 0;         // see see_damped()
  bool knows_means = false;  // it would have reached the accuracy, but equal steps know the mean of a load alone
  // It aimed at the accuracy after a run that ended early, and the run before is too far off to measure it.
  bool unmeasured = false;
  bool disturbed = false;  // its masses: it only measures the next ones
  double foreseen = 0;     // distance from the run before at the end, if it made the run end early
};

struct Distance {
  double largest = 0;      // in the units of the yardstick
  double agree_until = 0;  // [s]: where runs part for good, no gain is sure
};
// At the first `ends` of the coarse run's intervals; all by default.
Distance distance(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine,
                  std::size_t ends = std::numeric_limits<std::size_t>::max());
// The factor by which the error of the fine run is surely smaller, if they are so far apart.
double sure_gain(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine, double apart);
// Two runs by the same steps agree, whatever their error; of bodies that never move there are no steps and no error.
bool same_steps(const Attempt& a, const Attempt& b);
// The same of equal steps: those that are too long are taken in parts, so they take hardly more solves where they are
// shorter.
bool same_parts(const Attempt& a, const Attempt& b);
// Equal steps for which a force with limits is too stiff throw it from limit to limit. Two such runs may agree on that.
// `limited`: StiffStart::limited.
bool swings(const Try& knob, double limited);
// Equal steps damp an oscillation that they do not resolve, and two such runs agree on its mean. Its amplitude at most,
// from the energy that was lost.
void see_damped(const StiffStart& start, double step, Attempt& attempt);
// The energy's error is within the scene's tolerance.
bool balanced(const Scene& scene, const Attempt& attempt);
// The distance of a run from a coarser one has fallen well below the one before.
bool converges(const Attempt& coarse, const Attempt& fine);
// Measures a run by a coarser one, and by one between them that ended early if it has frames; or by one of another
// method.
void judge(const Scene& scene, const Yardstick& yardstick, const Attempt& coarse, const Attempt& between,
           Attempt& fine);
void judge_unlike(const Scene& scene, const Yardstick& yardstick, const Attempt& other, Attempt& now);
// For a quarter of the run bodies stay where they start, as near an unstable equilibrium: then all runs fall alike, by
// the round-off of the start.
bool lingers(const Yardstick& yardstick, const Attempt& attempt);
// The error by round-off of a run up to so many ends of its intervals, by another one from a start that is disturbed by
// `disturbance`. limit_by_round_off() lets the accuracy and the claim of `now` know it.
inline constexpr double disturbance = 1e-13;
double error_by_round_off(const Yardstick& yardstick, const Attempt& run, const Attempt& disturbed,
                          std::size_t ends = std::numeric_limits<std::size_t>::max());
void limit_by_round_off(const Yardstick& yardstick, const Attempt& disturbed, Attempt& now);
// So far apart already that judge_unlike() will not find the accuracy reached.
bool differ(const Yardstick& yardstick, const Attempt& other, const Attempt& now);
// The distance at the end, foreseen from that up to now, if it shows that the two runs will not agree; else 0.
double foreseen_distance(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine);
// The local error that the rest of the fine run may have, if the two runs agree so well that its distance from the
// truth will be surely within the accuracy all the same; else that of its knob.
double looser_error(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine);
// The rest of the fine run gets that.
void loosen(const Yardstick& yardstick, double duration, const Attempt& coarse, Attempt& fine);

// A step took a large part of the time.
bool has_long_steps(const Attempt& now, double duration);
// An implicit method takes over at events without end, up to the end of an interval: only shorter ones make these steps
// shorter. What seems to be a line or a parabola gets steps of any length, whatever the local error: the next run may
// not take such long ones.
Shorter shorter_after(const Attempt& now, double duration);
// The fine run had to take shorter steps, whatever its local error.
bool has_shorter_steps(const Attempt& coarse, const Attempt& fine);
// The knob after a run that ended early by its distance from the run before: the next one aims at an error.
std::optional<Try> after_early_end(double aim, double duration, const Attempt& last, const Attempt& now);

}  // namespace cdot
