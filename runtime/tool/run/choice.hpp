// The method of a run that asked for an accuracy, and what the run delivers.
#pragma once

#include <string>

#include "runtime/text/json.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct Choice {
  Integrator integrator = Settings{}.integrator;
  double local_error = 0;  // the largest of the run; 0: fixed steps
  double step = 0;         // [s] as Scene::step
  double asked = 0;        // of the size of each mechanism and of 1 rad; or [m] and [rad]
  bool of_size = true;     // the first of these
  // In the same units: the largest distance from the next coarser run, divided by the square root of the gain that
  // their local errors or steps promise. Up to `asked` half as much again, or without that gain where steps were left
  // to another method.
  double achieved = 0;
  bool reached = false;
  double holds_until = 0;            // [s]: the last time up to which the run has the accuracy
  double of_events = 0;              // error of the places of its events alone, as large as if all had the same sign
  long long rescued = 0;             // steps, whose error nobody knows
  double first_rescue = 0;           // [s]
  long long evaluations = 0;         // of accelerations, in the run; for fixed steps their equivalent
  bool paced = false;                // its steps follow those of a run before (runtime/state/pace.hpp)
  bool knows_means = false;          // of loads by which a joint may break, alone
  bool ended_by_budget = false;      // the search did, in vain
  int runs_before = 0;               // the one delivered
  long long evaluations_before = 0;  // in these
  double cpu_before = 0;             // [s], in their steps
};

// The scene with the method and the steps of a choice.
Scene solved_by(const Choice& choice, Scene scene);

// Lines of a summary. Without the CPU time they are the same in every run.
std::string choice_text(const Choice& choice, bool with_cpu = true);
text::Json choice_json(const Choice& choice);
// "; the search ended at its budget, ..." if it did, in vain.
std::string budget_text(const Choice& choice);
// Why the run failed or only warns, if the accuracy is not reached; empty if it does neither. A default accuracy that
// holds for a part of the run warns, one that was asked for fails. Without a fix.
std::string accuracy_failure(const Choice& choice);
std::string accuracy_warning(const Choice& choice);

}  // namespace cdot
