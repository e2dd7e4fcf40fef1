// Invalid problems: an engine may refuse them with an error before the first step, or do something sensible if that is
// possible.
#pragma once

#include "tests/bench/peers/hard/mover.hpp"
#include "tests/bench/peers/hard/outcome.hpp"

namespace cdot::peers {

struct Spoilt {
  const char *fault, *variant;  // of the hard case that has its scene
  double seconds;
  const char* what;  // forbidden motion of bodies over all steps [m]
  double bound;      // finite_only: the problem must be refused
  void (*spoil)(Problem&);
  void (*mend)(Problem&);  // the correct problem, if bodies should move; or null
};

// Null: the case is valid.
const Spoilt* spoilt(const hard::Case& hard_case);
Problem problem_of(const Spoilt& question, const hard::Case& hard_case);

// Judges like a trial: throws if the engine gives up later, CannotSay, NoSuchSetting.
void judge(const Spoilt& question, const hard::Case& hard_case, const Asked& asked, Told& told, Outcome& outcome);

}  // namespace cdot::peers
