// Advice of `cdot-run simulate`, pasted behind the command that gave it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cdot::test {

struct Ran {
  int status = -1;  // of the process
  nlohmann::json summary;
  // It ended with exit 0 and without a warning.
  bool silent() const {
    return status == 0 && summary["warning"] == "" && summary["trajectory_warning"] == "" &&
           summary["decision_warning"] == "";
  }
};

// `cdot-run simulate FILE OPTIONS --json`.
Ran simulated(const std::string& file, const std::string& options);

// The fault of a scene that was refused.
constexpr const char* refused = "refused";

struct FollowedAdvice {
  bool silent = false;  // the first run needed none
  std::string options;  // the advice; empty: none, or nothing that was tried is a cure
  std::string fault;    // what is wrong with the advice, with the summary of the run; empty: nothing
};

// Runs FILE with OPTIONS. A run that fails or warns has to give advice or to say that it has none; advice has to make
// the same run silent, to keep energies and momenta to the share that it promised, and to cost the steps and
// evaluations that it promised.
FollowedAdvice follow_advice(const std::string& file, const std::string& options);

}  // namespace cdot::test
