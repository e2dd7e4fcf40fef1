// One run of a search, and further runs that judge it.
#include <algorithm>
#include <cmath>

#include "runtime/tool/search/disturbed.hpp"
#include "runtime/tool/search/search.hpp"
#include "runtime/tool/search/stiffness.hpp"

namespace cdot {
namespace {

// Of Paces. Steps that are shorter than the usual 0.9 err by (0.9 / 0.8)^8 = 2.6 times less, so local errors may be
// twice as large (knobs.cpp), and fewer steps are rejected.
constexpr double safety = 0.8;

// Shares of masses, in a run that only measures the next ones: more than round-off by the largest gains. So a claim, a
// distance by its gain, still tells what round-off makes of a symmetric start.
constexpr double of_masses = 1e-11;
// A loose run may be so many times less sensitive than a fine one, which is not repeated for an error of so little of
// the accuracy.
constexpr double doubt = 10, little = 0.1;
constexpr double margin_of_repeated = 1.2;  // of its price, which is nearly that of the first one

}  // namespace

Attempt Search::begun(const Try& knob) const {
  Attempt attempt;
  attempt.knob = knob, attempt.dear = dear_, attempt.swings = swings(knob, start_.limited);
  if (knob.adaptive())
    attempt.paces = std::make_shared<Paces>(knob.local_error, safety, scene_.duration / knob.least_steps);
  return attempt;
}

Scene Search::scene_of(const Attempt& attempt) const {
  Scene solved = solved_by(choice_of(attempt), scene_);
  solved.step = scene_.duration / attempt.knob.steps();
  return attempt.disturbed ? with_disturbed_masses(std::move(solved), of_masses) : solved;
}

// Follows the pace of the `last` run. If it is judged by that run, it ends early where the two will not agree: by
// Attempt::foreseen, or fixed steps where they differ.
Attempt Search::attempt(const Try& knob, double most, const Attempt& last, bool judged) {
  Attempt attempt = begun(knob);
  if (last.whole && knob.adaptive()) attempt.paced_by = last.paces;
  attempt.disturbed = knob.adaptive() && !last.whole;
  attempt.full = runs_ > 0 && !attempt.disturbed && knob.intervals == intervals_of_own_steps;
  RunOptions options;
  if (attempt.full) {
    options = options_;
    options.from = {};
    if (options_.row) options.row = [&](const Frame& frame) { attempt.rows.push_back(frame); };
  }
  finish(attempt, scene_of(attempt), options, most, last, judged);
  return attempt;
}

// Claims about steps that were left to another method know all of the distance as it is.
bool Search::may_repeat(const Attempt& attempt) const {
  return !scene_.single && attempt.whole && attempt.knob.adaptive() && attempt.left_steps == 0 &&
         margin_of_repeated * attempt.price < left_for_all();
}

// By the same steps, from a disturbed start. Not of the budget for candidates.
Attempt Search::repeated(const Attempt& original) {
  Attempt attempt = begun(original.knob);
  attempt.paces = std::make_shared<Paces>(*original.paces);  // whose local errors may have grown on the way
  attempt.paced_by = original.paced_by;
  finish(attempt, disturbed(scene_of(original), disturbance), {}, infinity, {}, false);
  left_ += attempt.price;
  return attempt;
}

void Search::finish(Attempt& attempt, const Scene& solved, RunOptions options, double most, const Attempt& last,
                    bool judged) {
  const Try& knob = attempt.knob;
  if (may_be_dear_) options.diagnose_times = {2 * solved.duration};  // only if the run is stopped
  options.paced_by = attempt.paced_by.get(), options.paces = attempt.paces.get();
  options.progress = options_.progress, options.estimates_error = false;
  options.doing = name_of(knob) + ": ";
  options.most_evaluations = std::min(left_for_all(), knob.adaptive() ? most : infinity);
  const double interval = solved.duration / knob.intervals;
  options.look = [&](const Frame& frame, const RunResult& so_far) {
    if (std::abs(frame.time - static_cast<double>(attempt.frames.size()) * interval) < 1e-6 * interval)
      attempt.frames.push_back(frame);
    attempt.energy_share = so_far.balance.energy.share();
    attempt.result.counts = so_far.counts;
    attempt.energy_shares.resize(attempt.frames.size(), attempt.energy_share);
    if (!knob.adaptive()) {
      attempt.price = price_of_fixed(knob, so_far);
      return attempt.price <= most && !(judged && differ(yardstick_, last, attempt));
    }
    if (judged && (attempt.foreseen = foreseen_distance(yardstick_, solved.duration, last, attempt)) > 0) return false;
    if (judged) loosen(yardstick_, solved.duration, last, attempt);
    attempt.price = price_of_adaptive(so_far);
    const bool is_stiff = first_price_ > 0, rescued = so_far.counts.rescued > 0;
    if (is_stiff && rescued && attempt.price > unless_asked(work_if_rescued)) return false;
    const double foreseen = frame.time > 0 ? attempt.price * solved.duration / frame.time : 0;
    const double mechanisms = yardstick_.mechanisms();
    if (!may_be_dear_ || attempt.price < suspicious * mechanisms || foreseen < dear * mechanisms)
      return attempt.price <= most;
    first_price_ = foreseen, dear_ = true;
    return false;
  };
  std::string ignored;
  attempt.result = run_once(solved, options, runs_ == 0 ? warnings_ : ignored);
  const RunResult& result = attempt.result;
  const double share = static_cast<double>(result.steps) / knob.steps();
  attempt.price = knob.adaptive() ? price_of_adaptive(result) : price_of_fixed(knob, result, share);
  // A bound that is met within a step leaves that one to another method.
  attempt.left_steps = result.counts.rescued - (attempt.price > options.most_evaluations ? 1 : 0);
  see_damped(start_, solved.step, attempt);
  stiff_price_ = stiff_price(scene_, solved.step, result.diagnosis);
  attempt.whole = result.finite && !result.failed_step && !result.stopped && !result.interrupted;
  stopped_ = result.interrupted;
  ++runs_;
  may_be_dear_ = false;
  price_ += attempt.price, left_ -= attempt.price, cpu_ += result.cpu;
  given_up_ = left_for_all() < 0;
}

// Steps that end where numbers in time have kinks may be the same at every local error. Two runs by them agree,
// whatever their error; one of another order does not.
void Search::judge_by_another_method(Attempt& now, double most) {
  Try other = now.knob;
  other.integrator = now.knob.integrator == Integrator::dop853 ? Integrator::rk4 : Integrator::dop853;
  const Attempt check = attempt(other, most, {}, false);
  if (!check.whole || check.result.counts.rescued > 0) return;
  judge_unlike(scene_, yardstick_, check, now);
}

// Two runs may agree on a motion that round-off spoils: a symmetric start hides how much it grows. The first run is the
// cheapest to tell that it does not.
void Search::judge_round_off(const Attempt& first, Attempt& now) {
  if (!may_repeat(first)) return;
  const Attempt again = repeated(first);
  const double most = again.whole ? doubt * error_by_round_off(yardstick_, first, again) : infinity;
  if (most <= little * yardstick_.asked()) now.claimed = std::max(now.claimed, most);
  else limit_by_round_off(now);
}

void Search::limit_by_round_off(Attempt& now) {
  if (!may_repeat(now)) return;
  const Attempt again = repeated(now);
  if (again.whole) cdot::limit_by_round_off(yardstick_, again, now);
  sensitive_ |= !now.reached;
}

}  // namespace cdot
