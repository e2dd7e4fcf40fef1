// Candidates from the table of integrators, each refined until two of its runs agree.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <optional>
#include <ranges>
#include <tuple>

#include <cdot/methods.hpp>

#include "runtime/tool/run/process.hpp"
#include "runtime/tool/run/trajectory.hpp"
#include "runtime/tool/search/simulate.hpp"
#include "runtime/tool/search/yardstick.hpp"

namespace cdot {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// --- Local errors. The first run is loose: its price is small, and its distance from the second tells how strict the
// third has to be, if one is needed. Measured over all scenes: no other pair of numbers was cheaper by a tenth.
constexpr double first_local_error = 10;         // in units of the accuracy
constexpr double stricter = 1e-3;                // the next local error, as a share; at most a tenth. Of order 8:
double stricter_for(const IntegratorRow& row) {  // others make it at the same ratio of prices
  return std::pow(stricter, row.order / 8.0);
}
constexpr double strictest_local_error = 1e-14;  // below it there is only round-off, of steps
constexpr double round_off = 1e-15;              // and of what is compared
constexpr double least_sure = 1e-12;             // below it, smaller steps gain nothing for sure
constexpr double aim = 0.5;                      // share of the accuracy that a further run aims at

// Intervals bound the steps: those of a method that took over, and those that no estimate bounds.
constexpr int shorter_for_rescued = 4, shorter_for_others = 2, most_parts = 256;
constexpr double long_step = 1.0 / 3;  // of the duration

// --- Fixed steps: as many equal ones in each of the intervals.
constexpr int most_fixed_parts = 1 << 14;
constexpr double converges = 1.5;  // the distances of runs must fall by this, or
constexpr double surely = 1e-3;    // the first must be below this share of the accuracy
constexpr int most_idle = 3;       // refinements in a row without that

// --- Prices, in evaluations of an island's accelerations; measured for steps with fixed length.
constexpr double price_of_step(const IntegratorRow& row) { return row.stiffens ? 4 : row.projects ? 3 : 2; }
// All runs of a search together: about half a minute. RunOptions::search_cpu ends it where prices deceive.
constexpr double most_work = 1e8;  // evaluations times bodies
// Or so many times the price of steps of a millisecond, if
constexpr double most_millisecond_runs = 20;
// that is more than so many times the price of the first run that has ended with steps of its own: 1e-12 of its local
// error costs 32 times as much.
constexpr double most_first_runs = 40;
// A scene is surely stiff if an oscillation of tensions and springs at the start makes explicit steps `dear`. It may be
// if a run has taken `suspicious` evaluations, is on the way to `dear`, and the fastest oscillation explains a share of
// that price. Then methods for stiff scenes get such a share to be cheaper.
constexpr double suspicious = 400, dear = 4000, share_of_stiff = 0.25, share_of_surely_stiff = 0.5;
constexpr double evaluations_per_step = 12;  // of the highest order

struct Try {
  Integrator integrator;
  double local_error = 0;  // 0: fixed steps
  int parts = 1;           // of an interval: its steps; or at their ends, a method that took over has to stop
  const IntegratorRow& row() const { return row_of(integrator); }
  bool adaptive() const { return local_error > 0; }
  bool strictest() const { return adaptive() && local_error < 1.01 * strictest_local_error; }
};

// One run of one knob.
struct Attempt {
  Try knob;
  RunResult result;
  std::vector<Frame> frames;  // at the ends of the intervals
  std::vector<Frame> rows;
  double price = 0;
  bool full = false;           // it has the outputs asked for
  bool whole = false;          // it has ended in time and well
  double achieved = infinity;  // see Choice
  double holds_until = 0;
  bool reached = false;
};

std::string name_of(const Try& knob) {
  const auto name = name_of(integrators, knob.integrator);
  return knob.adaptive() ? fmt::format("{}, local error {:.0e}", name, knob.local_error)
                         : fmt::format("{}, {} steps", name, knob.parts * intervals_of_own_steps);
}

// The factor by which the error is surely smaller, measured over all scenes: the square root of what it should be. A
// tenth of a local error now and then gains less than that.
double sure_gain(double gain, bool adaptive) { return std::pow(gain, adaptive && gain < 11 ? 0.25 : 0.5); }

// The factor by which the error should be smaller than that of a coarser knob.
double gain(const Try& coarse, const Try& fine, bool rescued) {
  const double shorter = static_cast<double>(fine.parts) / coarse.parts;
  if (!fine.adaptive()) return std::pow(shorter, fine.row().order);
  const double smaller = (coarse.local_error + strictest_local_error) / (fine.local_error + strictest_local_error);
  return rescued ? std::min(smaller, shorter) : smaller;  // a method that took over may have order 1
}

// The next knob, with an error of at most this share and shorter intervals; nothing if it is too fine.
std::optional<Try> finer(Try knob, double share, int shorter) {
  if (knob.adaptive()) {
    if (knob.strictest() && shorter == 1) return {};
    // The strictest run is compared with one of ten times its local error: there the gain is small, but sure.
    const bool last = knob.local_error < 11 * strictest_local_error;
    knob.local_error = std::max((last ? 1 : 10) * strictest_local_error, std::min(share, 0.1) * knob.local_error);
    knob.parts *= shorter;
    if (knob.parts > most_parts) return {};
    return knob;
  }
  const double factor = std::pow(1 / share, 1.0 / knob.row().order);
  int times = 2;
  while (times < factor && times < 8) times *= 2;
  knob.parts *= times;
  if (knob.parts > most_fixed_parts) return {};
  return knob;
}

// Two runs by the same steps agree, whatever their error.
bool same_steps(const StepCounts& a, const StepCounts& b) {
  return a.taken == b.taken && a.shortest == b.shortest && a.longest == b.longest;
}

class Search {
 public:
  Search(const Scene& scene, const RunOptions& options, std::string& warnings)
      : scene_(scene), options_(options), warnings_(warnings), yardstick_(scene) {
    const double bodies = std::max<double>(1, static_cast<double>(scene.bodies.size()));
    const double steps = scene.duration / default_step * yardstick_.mechanisms();
    least_left_ = most_millisecond_runs * price_of_step(row_of(Integrator::euler)) * steps;
    left_ = most_work / bodies;
    least_left_ = std::min(left_, least_left_);
  }

  RunResult run();

 private:
  std::optional<double> next_share(const Attempt& last, const Attempt& now, int& idle);
  void try_candidate(Integrator integrator, double most);
  void try_stiff(double most);
  Attempt attempt(const Try& knob, double most);
  double stiff_price(const std::vector<WorstOfIsland>& islands) const;
  std::vector<WorstOfIsland> diagnosis_at_start() const;
  void judge(const Attempt& coarse, Attempt& fine) const;
  void keep(Attempt&& attempt);
  bool balanced(const Attempt& attempt) const {
    return attempt.result.balance.energy.share() <= scene_.energy_tolerance;
  }
  bool out_of_budget() const { return spent_ > options_.search_cpu || left_ <= 0; }
  bool done() const { return stopped_ || best_.reached || out_of_budget(); }
  bool in_reach(const Attempt& now, double most) const;
  double price_of(const Try& knob) const {
    return price_of_step(knob.row()) * knob.parts * intervals_of_own_steps * yardstick_.mechanisms();
  }
  Choice choice_of(const Attempt& attempt) const;

  const Scene& scene_;
  const RunOptions& options_;
  std::string& warnings_;
  Yardstick yardstick_;
  double left_;        // of the budget
  double least_left_;  // for all other candidates, when the first has a price
  Attempt best_;
  double first_price_ = 0;  // foreseen, of explicit steps that became dear; while stiff candidates run
  double stiff_price_ = 0;  // the part of it that stiffness explains
  bool may_be_dear_ = true, stopped_ = false;
  bool sensitive_ = false;  // refined in vain: the motion itself forbids more
  int runs_ = 0;
  double price_ = 0, cpu_ = 0;  // of all runs
  double spent_ = 0;            // by RunOptions::clock [s]
};

Attempt Search::attempt(const Try& knob, double most) {
  Attempt attempt;
  attempt.knob = knob;
  const Scene solved = solved_by(choice_of(attempt), scene_);
  attempt.full = runs_ > 0;
  RunOptions options;
  if (attempt.full) {
    options = options_;
    options.from = {};
    if (options_.row) options.row = [&](const Frame& frame) { attempt.rows.push_back(frame); };
  }
  if (may_be_dear_) options.diagnose_times = {2 * solved.duration};  // only if the run is stopped
  options.progress = options_.progress;
  options.doing = name_of(knob) + ": ";
  const double interval = solved.duration / intervals_of_own_steps, began = options_.clock();
  options.look = [&](const Frame& frame, const StepCounts& counts) {
    if (std::abs(frame.time - static_cast<double>(attempt.frames.size()) * interval) < 1e-6 * interval)
      attempt.frames.push_back(frame);
    if (spent_ + options_.clock() - began > options_.search_cpu) return false;
    if (!knob.adaptive()) return true;
    attempt.price = static_cast<double>(counts.evaluations);
    const double foreseen = frame.time > 0 ? attempt.price * solved.duration / frame.time : 0;
    const double mechanisms = yardstick_.mechanisms();
    if (!may_be_dear_ || attempt.price < suspicious * mechanisms || foreseen < dear * mechanisms)
      return attempt.price <= most;
    first_price_ = foreseen;
    return false;
  };
  std::string ignored;
  attempt.result = run_once(solved, options, runs_ == 0 ? warnings_ : ignored);
  const RunResult& result = attempt.result;
  attempt.price = knob.adaptive() ? static_cast<double>(result.counts.evaluations) : price_of(knob);
  stiff_price_ = stiff_price(result.diagnosis);
  attempt.whole = result.finite && !result.failed_step && !result.stopped && !result.interrupted;
  stopped_ = result.interrupted;
  ++runs_;
  may_be_dear_ = false;
  price_ += attempt.price, left_ -= attempt.price, cpu_ += result.cpu;
  spent_ += options_.clock() - began;
  return attempt;
}

// Of the steps of the highest order that stay stable, over the whole run.
double Search::stiff_price(const std::vector<WorstOfIsland>& islands) const {
  double price = 0;
  for (const WorstOfIsland& island : islands)
    price += evaluations_per_step * scene_.duration * std::sqrt(std::max(0.0, island.island.stiffest.square)) /
             row_of(Integrator::dop853).stable_radians;
  return price;
}

std::vector<WorstOfIsland> Search::diagnosis_at_start() const {
  Scene scene = scene_;
  scene.settings.integrator = Integrator::dop853;  // for which springs are forces
  const auto look = [&]<class S>(S) {
    std::string ignored;
    BasicWorld<S> world = world_at_start<S>(scene, ignored);
    std::vector<WorstOfIsland> worst;
    add_diagnosis(diagnose(world, scene_.duration / intervals_of_own_steps), 0, worst);
    return worst;
  };
  return in_space_of<double>(scene_, look);
}

// Measures a run by a coarser one.
void Search::judge(const Attempt& coarse, Attempt& fine) const {
  double apart = round_off;
  for (std::size_t k = 0; k < std::min(coarse.frames.size(), fine.frames.size()); ++k) {
    apart = std::max(apart, yardstick_.apart(coarse.frames[k], fine.frames[k]));
    // Where runs part for good, no gain is sure.
    if (apart <= yardstick_.asked()) fine.holds_until = fine.frames[k].time;
  }
  const bool rescued = coarse.result.counts.rescued > 0 || fine.result.counts.rescued > 0;
  const double gained = gain(coarse.knob, fine.knob, rescued);
  fine.achieved = std::max(std::min(apart, least_sure), apart / sure_gain(gained, fine.knob.adaptive()));
  const bool known = fine.knob.parts > coarse.knob.parts ||
                     (fine.result.counts.rescued == 0 && !same_steps(coarse.result.counts, fine.result.counts));
  const bool seems_to_converge = fine.knob.adaptive() || fine.achieved < surely * yardstick_.asked() ||
                                 fine.achieved * converges < coarse.achieved;
  fine.reached = known && seems_to_converge && balanced(fine) && fine.achieved <= yardstick_.asked();
  if (fine.reached) fine.holds_until = scene_.duration;
}

// The better of two: a run that reached the accuracy, then one that holds it longer, then any that has ended.
void Search::keep(Attempt&& attempt) {
  const auto rank = [&](const Attempt& a) {
    return std::tuple(a.reached, a.whole, balanced(a), a.whole && a.result.counts.rescued == 0, a.holds_until,
                      -a.achieved, a.result.time);
  };
  if (best_.frames.empty() || rank(attempt) > rank(best_)) best_ = std::move(attempt);
}

// The share of the last error that the next run may have; nothing if this candidate has no prospects.
std::optional<double> Search::next_share(const Attempt& last, const Attempt& now, int& idle) {
  if (now.result.stopped) return {};
  const bool failed_before = !last.frames.empty() && !last.whole;
  // Smaller local errors get no further.
  if (now.knob.adaptive() && !now.whole && failed_before && now.result.time <= last.result.time) return {};
  const double least = stricter_for(now.knob.row());
  if (!now.whole) return least;
  if (!last.whole) return now.knob.adaptive() ? least : 0.5;
  // Two runs agree on a motion whose energy balance fails: finer ones would agree with them.
  if (now.knob.adaptive() && now.achieved <= yardstick_.asked() && !balanced(now) && !balanced(last)) sensitive_ = true;
  sensitive_ |= now.knob.strictest() && now.result.counts.rescued == 0;
  idle = now.achieved * converges < last.achieved ? 0 : idle + 1;
  if (!now.knob.adaptive() && idle > most_idle) return {};
  // Where the motion magnifies every difference, runs agree no more at all: then the time counts.
  return std::max(least, aim * yardstick_.asked() / now.achieved);
}

// False for a stiff candidate if fixed steps so fine that they should reach the accuracy cost more than `most`.
bool Search::in_reach(const Attempt& now, double most) const {
  if (!(first_price_ > 0) || now.knob.adaptive() || !std::isfinite(now.achieved)) return true;
  const double shorter = std::pow(now.achieved / yardstick_.asked(), 1.0 / now.knob.row().order);
  return shorter * now.price <= most;
}

void Search::try_candidate(Integrator integrator, double most) {
  const bool adaptive = row_of(integrator).level == Level::acceleration;
  std::optional<Try> knob = Try{
      integrator, adaptive ? std::max(strictest_local_error / stricter, first_local_error * yardstick_.asked()) : 0, 1};
  Attempt last;
  double spent = 0;
  int idle = 0;
  while (knob && !done() && !sensitive_) {
    if (!knob->adaptive() && spent + price_of(*knob) > most) break;
    Attempt now = attempt(*knob, most - spent);
    spent += now.price;
    if (now.whole) {
      yardstick_.see(now.frames);
      // A stiff candidate has a bound of its own.
      if (adaptive && !(first_price_ > 0)) left_ = std::min(left_, std::max(most_first_runs * now.price, least_left_));
      if (last.whole) judge(last, now);
    }
    const std::optional<double> share = next_share(last, now, idle);
    // An implicit method takes over at events without end, and what seems to be a line or a parabola gets steps of any
    // length, whatever the local error: only shorter intervals make these steps shorter.
    const StepCounts& counts = now.result.counts;
    const int shorter = counts.rescued > 0                             ? shorter_for_rescued
                        : counts.longest > long_step * scene_.duration ? shorter_for_others
                                                                       : 1;
    knob = share && in_reach(now, most - spent) ? finer(*knob, *share, shorter) : std::nullopt;
    keep(Attempt(now));
    last = std::move(now);
  }
}

// Those that take stiffness implicitly, high orders first. But what stands still costs the lowest order next to
// nothing: its first two runs, of equal and of twice as many steps as intervals.
void Search::try_stiff(double most) {
  try_candidate(Integrator::implicit, 3 * price_of({Integrator::implicit}));
  for (const IntegratorRow& row : std::views::reverse(integrator_rows))
    if ((row.stiffens || row.stable_radians == always) && !done()) try_candidate(row.integrator, most);
}

RunResult Search::run() {
  std::vector<IntegratorRow> candidates(integrator_rows.begin(), integrator_rows.end());
  // Those that choose their steps come first, then high orders.
  std::ranges::stable_sort(candidates, std::greater<>(), [](const IntegratorRow& row) {
    return std::tuple(row.level == Level::acceleration, row.order, row.stiffens);
  });
  first_price_ = stiff_price(diagnosis_at_start());
  if (first_price_ > dear * yardstick_.mechanisms()) {
    may_be_dear_ = false;
    try_stiff(share_of_surely_stiff * first_price_);
  }
  first_price_ = 0;
  bool first = true;
  auto to_come = static_cast<double>(candidates.size());
  for (const IntegratorRow& row : candidates) {
    if (done() || sensitive_) break;
    try_candidate(row.integrator, first ? left_ : left_ / to_come);
    --to_come, first = false;
    if (first_price_ > 0) {
      if (stiff_price_ > share_of_stiff * first_price_) try_stiff(share_of_stiff * first_price_);
      first_price_ = 0;
      if (!done()) try_candidate(row.integrator, left_);
    }
  }
  RunResult result = std::move(best_.result);
  const Choice choice = choice_of(best_);
  if (!best_.full || !options_.from.empty()) {
    std::string ignored;
    if (!stopped_) result = run_once(solved_by(choice, scene_), options_, ignored);
  } else if (options_.row) {
    for (const Frame& row : best_.rows) options_.row(row);
  }
  result.choice = choice;
  result.interrupted |= stopped_;
  return result;
}

Choice Search::choice_of(const Attempt& attempt) const {
  Choice choice;
  choice.integrator = attempt.knob.integrator;
  choice.local_error = attempt.knob.local_error;
  choice.step = scene_.duration / intervals_of_own_steps / attempt.knob.parts;
  choice.asked = yardstick_.asked();
  choice.of_size = yardstick_.of_size();
  choice.achieved = attempt.achieved;
  choice.reached = attempt.reached;
  choice.holds_until = attempt.holds_until;
  choice.rescued = attempt.result.counts.rescued;
  choice.first_rescue = attempt.result.first_rescue;
  choice.ended_by_budget = !attempt.reached && out_of_budget();
  choice.evaluations = std::llround(attempt.price);
  choice.runs_before = runs_ - 1;
  choice.evaluations_before = std::llround(price_ - attempt.price);
  choice.cpu_before = cpu_ - attempt.result.cpu;
  return choice;
}

}  // namespace

RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings) {
  if (!chooses_method(scene)) return run_once(scene, options, warnings);
  return Search(scene, options, warnings).run();
}

}  // namespace cdot
