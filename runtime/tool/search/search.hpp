// A search for a method: candidates from the table of integrators, each refined until two of its runs agree.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "runtime/tool/search/attempt.hpp"
#include "runtime/tool/search/bounds.hpp"
#include "runtime/tool/search/knobs.hpp"
#include "runtime/tool/search/simulate.hpp"
#include "runtime/tool/search/work.hpp"

namespace cdot {

class Search {
 public:
  Search(const Scene& scene, const RunOptions& options, std::string& warnings)
      : scene_(scene), options_(options), warnings_(warnings), yardstick_(scene), all_(evaluations_of_all(scene)) {
    const double steps = scene.duration / default_step * all_;
    least_left_ = most_millisecond_runs * price_of_step(row_of(Integrator::euler)) * steps;
    left_ = options.search_work / work_of_evaluation(scene);
    least_left_ = std::min(left_, least_left_);
  }

  RunResult run();

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  std::optional<double> next_share(const Attempt& last, const Attempt& now, int& idle);
  void try_candidate(Integrator integrator, double most, double reach = 0);
  void try_stiff(double most);
  bool explicit_steps_are_too_dear(double most) const {
    return yardstick_.of_size() && first_price_ > std::min(left_, most);
  }
  void try_even_steps(const Attempt& even);
  Attempt begun(const Try& knob) const;
  Scene scene_of(const Attempt& attempt) const;
  Attempt attempt(const Try& knob, double most, const Attempt& last, bool judged);
  bool may_repeat(const Attempt& attempt) const;
  Attempt repeated(const Attempt& original);
  void finish(Attempt& attempt, const Scene& solved, RunOptions options, double most, const Attempt& last, bool judged);
  void judge_by_another_method(Attempt& now, double most);
  void judge_round_off(const Attempt& first, Attempt& now);
  void limit_by_round_off(Attempt& now);
  void keep(Attempt&& attempt);
  void bound_budget(const Attempt& now);
  bool balanced(const Attempt& attempt) const { return cdot::balanced(scene_, attempt); }
  bool out_of_budget() const { return left_ <= 0; }
  // RunOptions::most_evaluations are those of all runs.
  double left_for_all() const { return options_.most_evaluations - price_; }
  bool done() const { return stopped_ || given_up_ || best_.reached || out_of_budget(); }
  bool in_reach(const Attempt& now, double most) const;
  double price_after(const Attempt& last, const Try& knob) const;
  double lacking_for_last(const Attempt& now, const std::optional<Try>& next, double rest) const;
  // Of this share of the steps.
  double price_of_fixed(const Try& knob, const RunResult& so_far, double share = 1) const {
    return std::max(share * price_of(knob), static_cast<double>(so_far.solves));
  }
  static double price_of_adaptive(const RunResult& so_far) {
    return static_cast<double>(so_far.counts.evaluations + so_far.solves);
  }
  double price_of(const Try& knob) const { return price_of_step(knob.row()) * knob.steps() * all_; }
  Choice choice_of(const Attempt& attempt) const;

  // So much work, in evaluations, if nobody asked for the accuracy; else without a bound.
  double unless_asked(double work) const { return yardstick_.of_size() ? work / work_of_evaluation(scene_) : infinity; }

  // A candidate that may go on with a larger budget.
  struct Begun {
    Attempt first, last;
    std::optional<Try> next;
    int idle = 0;
    bool promises(double duration, double most) const;
  };

  const Scene& scene_;
  const RunOptions& options_;
  std::string& warnings_;
  Yardstick yardstick_;
  double all_;                 // evaluations_of_all()
  double left_;                // of the budget
  double unasked_ = infinity;  // for all runs, if nobody asked for the accuracy
  double least_left_;          // for all other candidates, when the first has a price
  Attempt best_;
  Begun begun_;  // the last candidate
  StiffStart start_;
  double first_price_ = 0;  // foreseen, of explicit steps that became dear; while stiff candidates run
  double stiff_price_ = 0;  // the part of it that stiffness explains
  bool may_be_dear_ = true, dear_ = false, stopped_ = false, given_up_ = false;
  bool extended_ = false;         // the budget, once
  bool sensitive_ = false;        // refined in vain: the motion itself forbids more
  int runs_ = 0, of_others_ = 0;  // of these, some did not end or left steps to another method
  double price_ = 0, cpu_ = 0;    // of all runs
};

}  // namespace cdot
