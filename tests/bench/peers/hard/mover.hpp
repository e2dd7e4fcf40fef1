// Another engine moves the bodies of a hard case, which is run and judged by its criterion as for Cdot.
#pragma once

#include "tests/bench/peers/peer.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::peers {

// One way to run one engine: the index of its setting, with each step in `finer` equal parts.
struct Asked {
  const Engine* engine;
  int setting = 0;
  int finer = 1;
  int longest = 30;  // CPU seconds of the run
};

// Plain memory, which a parent process can share.
struct Told {
  char setting[128], changed[384];  // its name, and every changed default
  double time;                      // time reached [s]
};

// Thrown if an engine has no setting of that number.
struct NoSuchSetting {};

// Thrown if a body is too far away or not finite.
struct Exploded {
  double time;
};

struct Setting {
  Series series;
  double knob = 0;  // 0: the step
};
// The engine's settings, defaults first; empty if the engine cannot pose the problem.
std::vector<Setting> settings(const Engine& engine, const Problem& problem);

void say(Told& told, const Setting& setting);

// The problem at the start of a case; throws CannotSay.
Problem problem_of(const hard::Case& hard_case);

// Updates `told` while trials run.
void let_move(const Asked& asked, Told& told);

}  // namespace cdot::peers
