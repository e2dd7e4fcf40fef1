// The outcome of a hard case with an engine. Every run is a separate process, so a crash or a hang is an outcome.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/peers/hard/mover.hpp"
#include "tests/hard_cases/trial.hpp"

namespace cdot::peers {

struct Outcome {
  // Ordered from good to bad; "" is no outcome.
  enum Kind { survives, wrong, explodes, gives_up, aborts, too_slow, cannot_say } kind = cannot_say;
  std::string setting, changed, message;
  double time = 0;  // time reached [s]
  int parts = 1;    // of each step
  std::vector<hard::Finding> findings;

  bool exists() const { return !findings.empty() || !message.empty() || kind == explodes; }
  // The finding with the largest ratio to its bound; there must be one.
  const hard::Finding& worst() const;
  // True if this outcome is better.
  bool operator<(const Outcome& other) const;
};

// Ends an outcome without findings; the message gives the reason.
void ended(Outcome& outcome, Outcome::Kind kind, const std::string& message);

const char* name_of(Outcome::Kind kind);
nlohmann::json json_of(const Outcome& outcome);
Outcome outcome_of(const nlohmann::json& json);

// Runs the case in this process.
Outcome judged(const hard::Case& hard_case, const Asked& asked, Told& told);
// Runs the case in a child process. Changes nothing if the engine has no such setting.
bool judge(const hard::Case& hard_case, const Asked& asked, Outcome& outcome);

}  // namespace cdot::peers
