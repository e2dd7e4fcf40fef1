// What an engine makes of a hard case. Every run is a process of its own: one that crashes or hangs is an outcome.
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
  double time = 0;  // that was reached [s]
  int parts = 1;    // of each step
  std::vector<hard::Finding> findings;

  bool exists() const { return !findings.empty() || !message.empty() || kind == explodes; }
  // The finding that is worst against its bound; there must be one.
  const hard::Finding& worst() const;
  // Whether it is better than another.
  bool operator<(const Outcome& other) const;
};

// Without findings, for the reason that the message gives.
void ended(Outcome& outcome, Outcome::Kind kind, const std::string& message);

const char* name_of(Outcome::Kind kind);
nlohmann::json json_of(const Outcome& outcome);
Outcome outcome_of(const nlohmann::json& json);

// Runs it in this process.
Outcome judged(const hard::Case& hard_case, const Asked& asked, Told& told);
// In a child. Sets nothing if the engine has no such setting.
bool judge(const hard::Case& hard_case, const Asked& asked, Outcome& outcome);

}  // namespace cdot::peers
