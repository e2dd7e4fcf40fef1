// Questions without a proper answer: an engine may refuse them with an error before anything has moved; where there is
// something sensible to do, that will do as well.
#pragma once

#include "tests/bench/peers/hard/mover.hpp"
#include "tests/bench/peers/hard/outcome.hpp"

namespace cdot::peers {

struct Spoilt {
  const char *fault, *variant;  // of the hard case that has its scene
  double seconds;
  const char* what;  // bodies must not do, of all steps [m]
  double bound;      // finite_only: nothing will do, it has to be refused
  void (*spoil)(Problem&);
  void (*mend)(Problem&);  // how bodies should go on, if they should not stay where they are; or null
};

// Null: the case is sound.
const Spoilt* spoilt(const hard::Case& hard_case);
Problem problem_of(const Spoilt& question, const hard::Case& hard_case);

// As a trial is judged: throws where the engine gives up later, CannotSay and NoSuchSetting.
void judge(const Spoilt& question, const hard::Case& hard_case, const Asked& asked, Told& told, Outcome& outcome);

}  // namespace cdot::peers
