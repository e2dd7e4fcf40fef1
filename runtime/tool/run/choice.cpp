#include "runtime/tool/run/choice.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "runtime/tool/run/ways.hpp"

namespace cdot {

Scene solved_by(const Choice& choice, Scene scene) {
  scene.step = choice.step;
  scene.accuracy = 0;
  const Way way{.integrator = choice.integrator, .iterations = 0, .adaptive = choice.local_error > 0};
  return solved_by(way, Knob{1, choice.local_error}, std::move(scene));
}

namespace {

const char* unit_of(const Choice& choice) { return choice.of_size ? "of its size and of 1 rad" : "m, rad"; }

std::string steps_text(const Choice& choice) {
  return choice.local_error > 0 ? fmt::format("local error {:.1e}", choice.local_error)
                                : fmt::format("steps of {:.6g} s", choice.step);
}

// A method that is named finds its steps alone.
std::string pace_text(const Choice& choice) {
  return choice.paced ? "\n                  steps by the pace of the run before; named, the method takes others, at "
                        "another price"
                      : "";
}

std::string rescue_text(const Choice& choice) {
  if (choice.rescued == 0) return {};
  return fmt::format("; {} step{} left to an implicit method, first by t = {:.6g} s", choice.rescued,
                     choice.rescued == 1 ? " was" : "s were", choice.first_rescue);
}

// The reason why the run fails; empty if it has the accuracy.
std::string lack(const Choice& choice) {
  if (choice.reached) return {};
  const std::string asked = fmt::format("accuracy {:.1e} {}", choice.asked, unit_of(choice)),
                    rest = rescue_text(choice) + budget_text(choice);
  if (!std::isfinite(choice.achieved))
    return fmt::format("{} is not known: no two runs of one method ended well within the search's budget{}", asked,
                       rest);
  if (choice.knows_means)
    return fmt::format("{} is not assured: equal steps know the mean of a load alone, and joints may break by more{}",
                       asked, rest);
  if (choice.achieved <= choice.asked) return fmt::format("{} is not assured{}", asked, rest);
  if (choice.of_events > choice.asked)
    return fmt::format("{} is finer than events are located: their errors alone may add up to {:.1e}{}", asked,
                       choice.of_events, rest);
  return fmt::format("{} holds up to t = {:.6g} s; later on two runs differ by up to {:.1e}{}", asked,
                     choice.holds_until, choice.achieved, rest);
}

bool fails(const Choice& choice) {
  return !choice.reached && (!choice.of_size || (choice.holds_until == 0 && choice.rescued == 0));
}

}  // namespace

std::string budget_text(const Choice& choice) {
  return choice.ended_by_budget
             ? fmt::format("; the search ended at its budget, after {:.3g} s of CPU time", choice.cpu_before)
             : std::string();
}
std::string accuracy_failure(const Choice& choice) { return fails(choice) ? lack(choice) : std::string(); }
std::string accuracy_warning(const Choice& choice) { return fails(choice) ? std::string() : lack(choice); }

std::string choice_text(const Choice& choice, bool with_cpu) {
  std::string text = fmt::format("  accuracy        {:.1e} {}{}: {}, {}; ", choice.asked, unit_of(choice),
                                 choice.of_size ? " by default" : " asked for", name_of(integrators, choice.integrator),
                                 steps_text(choice));
  text += choice.reached ? fmt::format("{:.1e} delivered", choice.achieved) : std::string("NOT reached");
  return text +
         fmt::format(
             "\n  search          {} run{} before, at {:.2g} times the run's price{}{}\n", choice.runs_before,
             choice.runs_before == 1 ? "" : "s",
             static_cast<double>(choice.evaluations_before) / static_cast<double>(std::max(1LL, choice.evaluations)),
             with_cpu ? fmt::format(", {:.4g} s CPU", choice.cpu_before) : std::string(), pace_text(choice));
}

text::Json choice_json(const Choice& choice) {
  return {{"asked", choice.asked},
          {"unit", choice.of_size ? "size, rad" : "m, rad"},
          {"integrator", name_of(integrators, choice.integrator)},
          {"local_error", choice.local_error},
          {"step", choice.step},
          {"achieved", choice.achieved},
          {"reached", choice.reached},
          {"ended_by_budget", choice.ended_by_budget},
          {"holds_until", choice.holds_until},
          {"rescued", choice.rescued},
          {"evaluations", choice.evaluations},
          {"paced", choice.paced},
          {"search",
           {{"runs", choice.runs_before}, {"evaluations", choice.evaluations_before}, {"cpu", choice.cpu_before}}}};
}

}  // namespace cdot
