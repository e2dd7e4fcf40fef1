// Another engine moves the bodies of a hard case: the case is run, and judged by its own criterion, as it is for Cdot.
#pragma once

#include "tests/bench/peers/peer.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::peers {

// One way to ask one engine: the how-manyeth of its settings, each step cut into `finer` equal parts.
struct Asked {
  const Engine* engine;
  int setting = 0;
  int finer = 1;
  int longest = 30;  // CPU seconds of the run
};

// Plain memory, which a parent process can share.
struct Told {
  char setting[128], changed[384];  // what the engine calls it, and every default that it changes
  double time;                      // how far the bodies were moved [s]
};

// Thrown where an engine has no setting of that number.
struct NoSuchSetting {};

// Thrown where a body went beyond all measure, or nowhere: it is no number.
struct Exploded {
  double time;
};

struct Setting {
  Series series;
  double knob = 0;  // 0: the step
};
// The engine's defaults first. Empty if the problem is not of its kind.
std::vector<Setting> settings(const Engine& engine, const Problem& problem);

void say(Told& told, const Setting& setting);

// What a case asks, as it starts; throws CannotSay.
Problem problem_of(const hard::Case& hard_case);

// What has been told stays up to date while trials run.
void let_move(const Asked& asked, Told& told);

}  // namespace cdot::peers
