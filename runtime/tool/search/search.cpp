#include "runtime/tool/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <tuple>
#include <utility>

#include <cdot/methods.hpp>

#include "runtime/tool/search/stiffness.hpp"

namespace cdot {
namespace {

constexpr double aim = 0.5;  // share of the accuracy that a further run aims at

}  // namespace

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
  if (now.result.stopped || now.knows_means) return {};
  const bool failed_before = !last.frames.empty() && !last.whole;
  // Smaller local errors get no further.
  if (now.knob.adaptive() && !now.whole && failed_before && now.result.time <= last.result.time) return {};
  const double least = stricter_for(now.knob.row());
  if (!now.whole) return ++idle <= most_idle ? std::optional(least) : std::nullopt;
  if (!last.whole && !now.knob.adaptive()) return 0.5;
  if (!last.whole) return second_share(now.knob, yardstick_.asked());
  // Two runs agree on a motion whose energy balance fails: finer ones would agree with them. They may do better without
  // steps that were left to another method.
  const bool own_steps = now.knob.adaptive() && now.result.counts.rescued == 0;
  if (own_steps && now.achieved <= yardstick_.asked() && !balanced(now) && !balanced(last)) sensitive_ = true;
  sensitive_ |= now.knob.strictest() && now.result.counts.rescued == 0;
  idle = converges(last, now) ? 0 : idle + 1;
  if (!now.knob.adaptive() && idle > most_idle) return {};
  if (now.unmeasured) return share_to_measure;
  // Where the motion magnifies every difference, runs agree no more at all: then the time counts.
  return std::max(least, aim * yardstick_.asked() / now.achieved);
}

// False for a stiff candidate if fixed steps so fine that they should reach the accuracy cost more than `most`.
bool Search::in_reach(const Attempt& now, double most) const {
  if (!(first_price_ > 0) || now.knob.adaptive() || !std::isfinite(now.achieved)) return true;
  const double shorter = std::pow(now.achieved / yardstick_.asked(), 1.0 / now.knob.row().order);
  return shorter * now.price <= most;
}

// Fixed steps of a low order are exact for motions along a line or a parabola, and cost next to nothing. Not where the
// first run located an event: they pass it between their ends, where two runs are not compared. If they agree with a
// first run of another method, they are delivered.
void Search::try_even_steps(const Attempt& even) {
  const bool is_slow = start_.price <= slow * yardstick_.mechanisms();
  Attempt now = attempt({is_slow ? Integrator::rattle : Integrator::implicit}, infinity, even, true);
  if (now.whole && now.result.counts.rescued == 0) judge_unlike(scene_, yardstick_, even, now);
  keep(std::move(now));
}

// A stiff candidate has a bound of its own.
void Search::bound_budget(const Attempt& now) {
  if (!now.knob.adaptive() || first_price_ > 0) return;
  if (now.whole) left_ = std::min(left_, std::max(most_first_runs * now.price, least_left_));
  if (!yardstick_.of_size()) return;
  const bool own_steps = now.result.counts.rescued == 0 && (now.whole || now.foreseen > 0);
  if (!own_steps) ++of_others_;
  unasked_ = (of_others_ > 1 ? unasked_work_of_others : unasked_work) / work_of_evaluation(scene_);
  const bool seems_good = now.whole && of_others_ <= 1;
  left_ = std::min(left_, seems_good ? std::max(unasked_, most_unasked_runs * now.price) : unasked_);
}

// The price of a run by fixed steps, foreseen by that of the last one: where rows press on each other, steps are dear.
double Search::price_after(const Attempt& last, const Try& knob) const {
  return price_of(knob) * (last.whole ? last.price / price_of(last.knob) : 1);
}

// The work beyond the `rest` of the budget, once, for a run that promises to be the last: two runs by steps of their
// own were near each other, and it should cost little more than the second of them.
double Search::lacking_for_last(const Attempt& now, const std::optional<Try>& next, double rest) const {
  const bool measured = now.whole && now.achieved < now.apart && now.left_steps == 0 && balanced(now);
  if (extended_ || !measured || !next || !next->adaptive() || first_price_ > 0) return 0;
  const double dearer = std::pow(now.knob.local_error / next->local_error, 1.0 / next->row().order);
  return dearer > dearest_last ? 0 : std::max(0.0, margin_of_last * dearer * now.price - rest);
}

// Its runs may have this price altogether. `reach`: and with those that may follow later, if that is more.
void Search::try_candidate(Integrator integrator, double most, double reach) {
  const bool adaptive = row_of(integrator).level == Level::acceleration;
  std::optional<Try> knob =
      first_try(integrator, yardstick_.asked(), !adaptive || start_.price <= suspicious * yardstick_.mechanisms());
  Attempt first, last, between;  // the last of these has ended early
  double spent = 0;
  int idle = 0;
  bool may_end_early = adaptive;
  if (begun_.last.whole && begun_.last.knob.integrator == integrator)
    knob = begun_.next, first = std::move(begun_.first), last = std::move(begun_.last), idle = begun_.idle;
  while (knob && !done() && !sensitive_) {
    if (!knob->adaptive() && spent + price_after(last, *knob) > most) break;
    given_up_ = !knob->adaptive() && price_of(*knob) > left_for_all();
    if (given_up_) break;
    const bool judged = may_end_early && last.whole && last.result.counts.rescued == 0;
    // A last run may go beyond the budget; unless the accuracy was asked for, not beyond that work.
    const double most_of_run = yardstick_.of_size() ? std::max(left_, unasked_ - price_) : infinity;
    Attempt now = attempt(*knob, std::min(most - spent, most_of_run), last, judged);
    spent += now.price;
    if (now.foreseen > 0) {
      may_end_early = false;
      knob = after_early_end(aim * yardstick_.asked(), scene_.duration, last, now);
      between = std::move(now);
      continue;
    }
    bound_budget(now);
    if (now.whole) {
      yardstick_.see(now.frames);
      if (last.whole) judge(scene_, yardstick_, last, between, now);
      if (last.whole && adaptive && !now.reached && now.result.counts.rescued == 0 && !has_shorter_steps(last, now) &&
          same_steps(last, now))
        judge_by_another_method(now, most - spent);
      else if (runs_ == 1 && now.result.counts.events == 0 && has_long_steps(now, scene_.duration) &&
               now.price <= even * yardstick_.mechanisms())
        try_even_steps(now);
    }
    if (now.reached && adaptive && (!last.disturbed || lingers(yardstick_, first))) judge_round_off(first, now);
    const std::optional<double> share = next_share(last, now, idle);
    keep(Attempt(now));
    if (now.result.stopped && last.whole) break;  // it may go on from the last one
    const bool goes_on = share && in_reach(now, std::max(most, reach) - spent);
    knob = goes_on ? finer(now.knob, *share, shorter_after(now, scene_.duration)) : std::nullopt;
    const double lacks = lacking_for_last(now, knob, std::min(left_, most - spent));
    extended_ |= lacks > 0, left_ += lacks, most += lacks;
    if (now.disturbed) first = now;
    last = std::move(now), between = {};
  }
  begun_ = {std::move(first), std::move(last), knob, idle};
}

// After a run that ended well, or that would have ended for this price.
bool Search::Begun::promises(double duration, double most) const {
  return most > 0 && last.left_steps == 0 && (last.whole || last.price * duration <= most * last.result.time);
}

// Those that take stiffness implicitly, the high order first. But what stands still costs the lowest order next to
// nothing: its first two runs, of equal and of twice as many steps as intervals. In large mechanisms it goes on for the
// price of some steps of the high order, while it promises to get there. Where impacts make the high order dear, the
// lowest takes over; then the high one goes on if it promises an end.
void Search::try_stiff(double most) {
  const double of_collocation = steps_of_collocation * price_of_derivatives(scene_);
  try_candidate(Integrator::implicit, std::max(3 * price_of({Integrator::implicit}), std::min(most, of_collocation)),
                most);
  if (done()) return;
  Begun lowest = std::exchange(begun_, {});
  const double first = std::min(most, unless_asked(first_work_of_collocation));
  try_candidate(Integrator::radau5, first);
  Begun high = std::exchange(begun_, std::move(lowest));
  const double rest = std::min(most, unless_asked(unasked_work) - price_) - first;
  const bool goes_on = high.promises(scene_.duration, rest);
  // Where collocation leaves steps to another method, or events make it that dear, explicit ones get no further.
  const bool in_vain = high.last.left_steps > 0 || (first < most && !goes_on);
  const bool others = !explicit_steps_are_too_dear(unless_asked(in_vain ? unasked_work_of_others : unasked_work));
  // Where nothing else is left, a finer run is worth its price even if it does not get there.
  const double reach = goes_on || others ? 0 : infinity;
  if (!done()) try_candidate(Integrator::implicit, std::min(most, unless_asked(work_of_lowest_order)), reach);
  begun_ = std::move(high);
  if (goes_on && !done()) try_candidate(Integrator::radau5, rest);
  if (!done() && best_.whole && !others) left_ = 0;
}

RunResult Search::run() {
  std::vector<IntegratorRow> candidates(integrator_rows.begin(), integrator_rows.end());
  // Those that choose their steps come first, then high orders.
  std::ranges::stable_sort(candidates, std::greater<>(), [](const IntegratorRow& row) {
    return std::tuple(row.level == Level::acceleration, row.order, row.stiffens);
  });
  start_ = stiffness_at_start(scene_, yardstick_);
  first_price_ = start_.price;
  if (first_price_ > dear * yardstick_.mechanisms()) {
    may_be_dear_ = false, dear_ = true;
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
  // Where no runs agree to the end, some agree longest by chance.
  if (!done() && best_.holds_until > 0) limit_by_round_off(best_);
  RunResult result = std::move(best_.result);
  const Choice choice = choice_of(best_);
  if (!best_.full || !options_.from.empty()) {
    std::string ignored;
    RunOptions options = options_;
    options.paced_by = best_.paced_by.get(), options.paces = best_.paces.get();
    if (!stopped_ && !given_up_) result = run_once(solved_by(choice, scene_), options, ignored);
  } else if (options_.row) {
    for (const Frame& row : best_.rows) options_.row(row);
  }
  result.choice = choice;
  result.interrupted |= stopped_;
  result.stopped |= given_up_;
  return result;
}

Choice Search::choice_of(const Attempt& attempt) const {
  Choice choice;
  choice.integrator = attempt.knob.integrator;
  choice.local_error = attempt.knob.local_error;
  const bool adaptive = attempt.knob.adaptive();
  choice.step = scene_.duration / (adaptive ? intervals_of_own_steps * attempt.knob.parts : attempt.knob.steps());
  choice.asked = yardstick_.asked();
  choice.of_size = yardstick_.of_size();
  choice.achieved = attempt.claimed;
  choice.reached = attempt.reached;
  choice.holds_until = attempt.holds_until;
  choice.of_events = attempt.of_events;
  choice.rescued = attempt.result.counts.rescued;
  choice.first_rescue = attempt.result.first_rescue;
  choice.knows_means = attempt.knows_means;
  choice.ended_by_budget = !attempt.reached && out_of_budget();
  choice.paced = attempt.paced_by != nullptr;
  choice.evaluations = std::llround(attempt.price);
  choice.runs_before = runs_ - 1;
  choice.evaluations_before = std::llround(price_ - attempt.price);
  choice.cpu_before = cpu_ - attempt.result.cpu;
  return choice;
}

RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings) {
  if (!chooses_method(scene)) return run_once(scene, options, warnings);
  return Search(scene, options, warnings).run();
}

}  // namespace cdot
