// The balance of a run -> its verdict in words, and its part of the summary.
#pragma once

#include <string>

#include "runtime/text/json.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// A run tells errors of its energy above this share of the scale.
double told_share(const Scene& scene);
// The largest share of a run's energies or momenta that the method lost or made up.
double worst_share(const BalanceWatch& balance);
// Why the balance fails the run, or only warns; empty if it does neither. Without a fix.
std::string balance_failure(const Scene& scene, const RunResult& result);
std::string balance_warning(const Scene& scene, const RunResult& result);

std::string balance_text(const RunResult& result);
text::Json balance_json(const RunResult& result);

}  // namespace cdot
