#include "runtime/tool/search/attempt.hpp"

#include <algorithm>
#include <cmath>

namespace cdot {
namespace {

constexpr double round_off = 1e-15;  // of what is compared
constexpr double far = 0.8;          // of a size or of a radian: larger distances say nothing about errors
// Where stability bounds the steps, a loose run does not resolve the fast oscillations. Its distance stays at their
// size, however far it is off: from this distance on no more than this gain is sure.
constexpr double far_if_dear = 0.03, gain_if_dear = 10;

// Of the distance: an energy that is off by less says nothing about the motion. A motor keeps a wheel's energy whatever
// its angle is.
constexpr double witness = 1e-5;
// Beyond this share of steps with kinks it says nothing either: an error that is made at a kink depends on where in a
// step it falls, so one run may be exact by chance.
constexpr double few_kinks = 0.01;

// --- Claims.
constexpr double least_sure = 1e-12;  // below it, smaller steps gain nothing for sure
// Between two looks the error may be so many local errors. Beyond this share of the accuracy they still count in a
// claim, but refuse no run.
constexpr double local_errors = 30, unseen = 0.1;
// A local error allows each velocity an error that is larger in proportion to 1 + the velocity, and it goes on until
// the end. Where forces have kinks within steps, the error may be so many of them.
constexpr double velocity_errors = 3;
// Up to the accuracy asked for, a claim is so many times the error that seems sure, or what the distance allows.
constexpr double margin = 1.5;
constexpr double unlike = 2;  // the error in units of the distance of two methods of different kind
// The distances of runs by fixed steps must fall by this: a first one says nothing about that, as long steps may have
// no order yet.
constexpr double least_fall = 1.5;
constexpr double surely = 1e-3;  // or be below this share of the accuracy

// Each event is located to about this share of what it depends on (events/guarded.hpp), whatever the local error is.
constexpr double share_of_events = 1e-9;

// Errors grow at least with time. From this share of the run on, the distance of two runs is taken to grow by the power
// of time with which it grew over the second half up to then. The run that comes next expects a little more.
constexpr double tells = 0.25, most_growth = 2, further_growth = 0.5;

// A run that agrees well with the one before goes on with a larger local error: at most these shares of the accuracy,
// as interpolants err by some local errors between the ends of steps, and of the local error before. What is foreseen
// then counts so many times, and grows at least with the energy's error of the run before, and is to be within this
// share of the accuracy. Smaller changes are not worth while.
constexpr double loosest_of_asked = 0.25, loosest_share = 0.01, times_foreseen = 4, aim_if_looser = 0.5,
                 least_looser = 1.2;

// Round-off of all steps spoils a run as much as this share of its start does, as seen of mechanisms whose starts are
// symmetric.
constexpr double round_off_of_steps = 2e-15;

constexpr double stays = 1e-6;  // within this of its place, in the units of the yardstick

// --- The next run.
constexpr int shorter_for_rescued = 4, shorter_for_others = 2;
constexpr double long_step = 0.4;  // of the duration
constexpr double unresolved = 1;   // [rad] of an oscillation in a step
// After a run that ends early, since its distance from the run before will be too large, the next one aims at a local
// error that is smaller by this factor at least, and by that of a second run at most. Where that is not enough, the run
// before measures nothing: the next one is a plain refinement.
constexpr double least_jump = 10;

std::size_t stride_of(const Attempt& coarse, const Attempt& fine) {
  return static_cast<std::size_t>(fine.knob.intervals / coarse.knob.intervals);
}

bool is_kinked(const Attempt& attempt) {
  const RunResult& run = attempt.result;
  return static_cast<double>(run.kinked) > few_kinks * static_cast<double>(run.counts.taken);
}

// The error of places of events, as large as if all had the same sign.
double error_of_events(const Yardstick& yardstick, const Attempt& attempt) {
  return yardstick.of_largest(share_of_events) * static_cast<double>(attempt.result.counts.events);
}

// The local error of velocities, if it goes on to the end.
double error_of_velocities(const Yardstick& yardstick, const Attempt& attempt) {
  if (attempt.frames.empty()) return 0;
  double pace = 0;
  for (const Frame& frame : attempt.frames) pace = std::max(pace, yardstick.allowed_pace(frame));
  return attempt.knob.local_error * pace * (attempt.frames.back().time - attempt.frames.front().time);
}

// The error that a run may have where the comparison does not show it, up to the accuracy asked for: between its times;
// by events, of which hundreds in a row may agree in two runs by chance; and by velocities, if the loose run happens to
// be as good as the fine one, as where forces have kinks. Equal steps are compared where they end: a damped motion may
// be over before.
double unseen_error(const Yardstick& yardstick, const Attempt& attempt) {
  if (!attempt.knob.adaptive() || is_kinked(attempt)) return yardstick.asked();
  const double error = std::max(local_errors * (attempt.knob.local_error + error_of_events(yardstick, attempt)),
                                velocity_errors * error_of_velocities(yardstick, attempt));
  return std::min(error, yardstick.asked());
}
// A share of it may refuse a run, and where forces have kinks the whole error of velocities.
double refusing_error(const Yardstick& yardstick, const Attempt& attempt) {
  return std::max({std::min(local_errors * attempt.knob.local_error, unseen * yardstick.asked()),
                   error_of_events(yardstick, attempt),
                   is_kinked(attempt) ? error_of_velocities(yardstick, attempt) : 0});
}

// True unless one run meets an end that the other one passes by.
bool same_events(const Attempt& coarse, const Attempt& fine) {
  return !fine.knob.adaptive() || coarse.result.counts.events == fine.result.counts.events;
}

// The gain by steps: that of a run between the two up to where it ended early, as it is measured by its distance `left`
// from the fine one, and the sure one from there on. A loose run may be so far off that its error does not grow with
// its local errors any more.
double gain_by(const Yardstick& yardstick, const Attempt& coarse, const Attempt& between, const Attempt& fine,
               double left) {
  const std::size_t ends = (between.frames.size() - 1) / stride_of(coarse, between);
  return distance(yardstick, coarse, fine, ends).largest / left * sure_gain(yardstick, between, fine, left);
}

}  // namespace

Distance distance(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine, std::size_t ends) {
  const std::size_t stride = stride_of(coarse, fine);
  Distance distance{round_off, 0};
  for (std::size_t k = 0; k <= ends && k < coarse.frames.size() && k * stride < fine.frames.size(); ++k) {
    const Frame& frame = fine.frames[k * stride];
    distance.largest = std::max(distance.largest, yardstick.apart(coarse.frames[k], frame));
    if (distance.largest <= yardstick.asked()) distance.agree_until = frame.time;
  }
  return distance;
}

namespace {

// sure_gain() of a fine run by this knob whose error of the energy is so many times smaller than the coarse one's.
double sure_gain_of(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine, const Try& knob,
                    double of_energy, double apart) {
  if (fine.knob.adaptive() && apart > far) return 1;
  const bool rescued = coarse.result.counts.rescued > 0 || fine.result.counts.rescued > 0;
  const bool events = coarse.result.counts.events > 0 || fine.result.counts.events > 0;
  const double noise = yardstick.of_largest(events ? share_of_events : strictest_local_error);
  const bool tells_of_energy = coarse.energy_share >= witness * apart && !is_kinked(coarse) && !is_kinked(fine);
  const double sure = sure_gain(knob.row(), gain(coarse.knob, knob, rescued, noise), tells_of_energy ? of_energy : 1);
  const bool unresolved = fine.knob.adaptive() && fine.dear && apart > far_if_dear;
  return unresolved ? std::min(sure, gain_if_dear) : sure;
}

// Two runs up to an end of the coarse run's intervals.
struct Course {
  std::size_t ends = 0;  // 0: the fine run is between two of them
  double share = 0;      // of the time
  double now = 0;        // the distance
  double growth = 0;     // its power of time
  // With this power, within bounds.
  double at_end(double power, double further) const {
    return now / std::pow(share, std::clamp(power, 1.0, most_growth) + further);
  }
};

Course course_of(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine) {
  const std::size_t stride = stride_of(coarse, fine), ends = (fine.frames.size() - 1) / stride;
  if (ends * stride != fine.frames.size() - 1) return {};
  const double now = distance(yardstick, coarse, fine, ends).largest;
  const double growth = std::log2(now / distance(yardstick, coarse, fine, ends / 2).largest);
  return {ends, fine.frames.back().time / duration, now, growth};
}

}  // namespace

double sure_gain(const Yardstick& yardstick, const Attempt& coarse, const Attempt& fine, double apart) {
  const double of_energy = coarse.energy_share / std::max(round_off, fine.energy_share);
  return sure_gain_of(yardstick, coarse, fine, fine.knob, of_energy, apart);
}

bool same_steps(const Attempt& a, const Attempt& b) {
  const StepCounts &of_a = a.result.counts, &of_b = b.result.counts;
  return of_a.taken > 0 && of_a.taken == of_b.taken && of_a.shortest == of_b.shortest && of_a.longest == of_b.longest;
}

bool same_parts(const Attempt& a, const Attempt& b) {
  const double shorter = static_cast<double>(b.knob.steps()) / a.knob.steps();
  return static_cast<double>(b.result.solves) < std::sqrt(shorter) * static_cast<double>(a.result.solves);
}

// h (d + h k) K falls at least in proportion to h. Euler's step is implicit up to the limits.
bool swings(const Try& knob, double limited) {
  return !knob.adaptive() && knob.integrator != Integrator::euler && limited * intervals_of_own_steps > knob.steps();
}

void see_damped(const StiffStart& start, double step, Attempt& attempt) {
  if (attempt.knob.adaptive() || start.omega * step <= unresolved) return;
  // Steps that are too long for a spring damp it, and that counts as its work.
  const double lost = std::abs(attempt.result.balance.energy.amount) + attempt.result.balance.last.taken;
  attempt.damped = std::sqrt(lost / start.energy);
}

bool balanced(const Scene& scene, const Attempt& attempt) {
  return attempt.result.balance.energy.share() <= scene.energy_tolerance;
}

bool converges(const Attempt& coarse, const Attempt& fine) { return fine.achieved * least_fall < coarse.achieved; }

void judge(const Scene& scene, const Yardstick& yardstick, const Attempt& coarse, const Attempt& between,
           Attempt& fine) {
  const auto [apart, agree_until] = distance(yardstick, coarse, fine);
  fine.apart = apart, fine.holds_until = agree_until;
  double gained = same_events(coarse, fine) ? sure_gain(yardstick, coarse, fine, apart) : 1;
  if (!between.frames.empty()) {
    const auto [left, agrees_until] = distance(yardstick, between, fine);
    gained = std::min(gained, gain_by(yardstick, coarse, between, fine, left));
    fine.holds_until = std::max(fine.holds_until, agrees_until);
    fine.unmeasured = apart > far;
  }
  fine.of_events = error_of_events(yardstick, fine);
  fine.achieved = std::max({std::min(apart, least_sure), apart / gained, refusing_error(yardstick, fine)});
  const bool known = fine.knob.adaptive() ? has_shorter_steps(coarse, fine) ||
                                                (fine.result.counts.rescued == 0 && !same_steps(coarse, fine))
                                          : !same_parts(coarse, fine);
  // Where a fast oscillation is not resolved, distances fall less than the errors should.
  const bool falls = coarse.apart >= gained * apart;
  const bool seems_to_converge = fine.knob.adaptive() || fine.achieved < surely * yardstick.asked() ||
                                 (std::isfinite(coarse.achieved) && converges(coarse, fine) && falls);
  fine.achieved = std::max(fine.achieved, fine.damped);
  // Two runs may agree by chance on steps that were left to another method: no gain is sure there.
  const bool rescued = fine.result.counts.rescued > 0;
  const bool agrees = known && seems_to_converge && !fine.swings && balanced(scene, fine) &&
                      std::max(fine.achieved, rescued ? apart : 0) <= yardstick.asked();
  // A joint may break by a load that is over before the step ends.
  fine.knows_means = agrees && fine.result.may_break && !fine.knob.adaptive();
  fine.reached = agrees && !fine.knows_means;
  if (fine.reached) fine.holds_until = scene.duration;
  // Errors on the same side, of which one is g times the other, are apart by g - 1 times the smaller one.
  const double same_side = gained > 1 ? apart / (gained - 1) : std::numeric_limits<double>::infinity();
  const double claim = rescued ? std::max(apart, coarse.apart)
                               : std::max({margin * fine.achieved, same_side, unseen_error(yardstick, fine)});
  fine.claimed = std::max(fine.achieved, std::min(claim, yardstick.asked()));
}

void judge_unlike(const Scene& scene, const Yardstick& yardstick, const Attempt& other, Attempt& now) {
  const auto [apart, agree_until] = distance(yardstick, other, now);
  now.achieved = std::max({least_sure, unlike * apart, refusing_error(yardstick, now), now.damped});
  now.holds_until = agree_until;
  now.reached = !now.swings && balanced(scene, now) && now.achieved <= yardstick.asked();
  now.claimed = std::max(now.achieved, unseen_error(yardstick, now));
  if (now.reached) now.holds_until = scene.duration;
}

bool lingers(const Yardstick& yardstick, const Attempt& attempt) {
  for (std::size_t k = 0; 4 * k <= attempt.frames.size(); ++k)
    if (yardstick.apart(attempt.frames[0], attempt.frames[k]) > stays) return false;
  return true;
}

double error_by_round_off(const Yardstick& yardstick, const Attempt& run, const Attempt& disturbed, std::size_t ends) {
  return round_off_of_steps / disturbance * distance(yardstick, run, disturbed, ends).largest;
}

void limit_by_round_off(const Yardstick& yardstick, const Attempt& disturbed, Attempt& now) {
  const double error = error_by_round_off(yardstick, now, disturbed);
  now.achieved = std::max(now.achieved, error), now.claimed = std::max(now.claimed, error);
  if (error <= yardstick.asked()) return;
  now.reached = false;
  std::size_t k = 0;
  while (k + 1 < now.frames.size() && error_by_round_off(yardstick, now, disturbed, k + 1) <= yardstick.asked()) ++k;
  now.holds_until = std::min(now.holds_until, now.frames[k].time);
}

bool differ(const Yardstick& yardstick, const Attempt& other, const Attempt& now) {
  return unlike * distance(yardstick, other, now).largest > yardstick.asked();
}

double foreseen_distance(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine) {
  const Course course = course_of(yardstick, duration, coarse, fine);
  if (course.ends == 0 || course.share < tells) return 0;
  const double foreseen = course.at_end(course.growth, 0);
  const double allowed = yardstick.asked() * sure_gain(yardstick, coarse, fine, foreseen);
  return foreseen > allowed ? course.at_end(course.growth + further_growth, 0) : 0;
}

double looser_error(const Yardstick& yardstick, double duration, const Attempt& coarse, const Attempt& fine) {
  const double now = fine.knob.local_error;
  const Course course = course_of(yardstick, duration, coarse, fine);
  const bool events_to_come = coarse.result.counts.events > fine.result.counts.events;
  if (course.ends == 0 || events_to_come || is_kinked(coarse)) return now;  // kinks may be still to come
  const double shared = std::max(round_off, coarse.energy_shares[course.ends]);
  const double foreseen =
      times_foreseen * std::max(1.0, coarse.energy_share / shared) * course.at_end(course.growth, further_growth);
  Try looser = fine.knob;
  for (looser.local_error = std::min(loosest_of_asked * yardstick.asked(), loosest_share * coarse.knob.local_error);
       looser.local_error > least_looser * now; looser.local_error /= least_looser) {
    const double of_energy = shared / std::max(round_off, fine.energy_share) * now / looser.local_error;
    const double gain = sure_gain_of(yardstick, coarse, fine, looser, of_energy, foreseen);
    if (foreseen <= aim_if_looser * yardstick.asked() * gain) return looser.local_error;
  }
  return now;
}

void loosen(const Yardstick& yardstick, double duration, const Attempt& coarse, Attempt& fine) {
  const double local_error = looser_error(yardstick, duration, coarse, fine);
  if (local_error <= fine.knob.local_error) return;
  fine.knob.local_error = local_error;
  fine.paces->loosen(fine.frames.back().time, local_error);
}

bool has_long_steps(const Attempt& now, double duration) {
  return now.knob.adaptive() && now.result.counts.longest > long_step * duration;
}

Shorter shorter_after(const Attempt& now, double duration) {
  if (now.result.counts.rescued > 0) return {.intervals = shorter_for_rescued};
  return {.steps = has_long_steps(now, duration) ? shorter_for_others : 1};
}

bool has_shorter_steps(const Attempt& coarse, const Attempt& fine) {
  return fine.knob.parts > coarse.knob.parts || fine.knob.least_steps > coarse.knob.least_steps;
}

std::optional<Try> after_early_end(double aim, double duration, const Attempt& last, const Attempt& now) {
  const double before = last.knob.local_error / now.knob.local_error;
  const double jump = std::max(least_jump, gain_for(now.knob.row(), now.foreseen / aim) / before);
  return finer(now.knob, 1 / (jump * stricter_for(now.knob.row()) > 1 ? least_jump : jump),
               shorter_after(now, duration));
}

}  // namespace cdot
