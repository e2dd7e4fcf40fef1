// A run that went wrong -> advice that was tried: the options that cure it, and their cost. Nothing is advised that was
// not run.
#pragma once

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// True if the run failed, or its balance or the estimate of its trajectory warns.
bool needs_advice(const Scene& scene, const RunResult& result);

// Searches the candidates in a fixed order for the first whose run over the same time passes without a failure and
// without such a warning. The trials have a bounded work (work.hpp); a candidate that does not end within
// it is none. Each ends as soon as it is in vain (RunOptions::is_trial).
std::optional<TriedFix> find_advice(const Scene& scene, const RunOptions& options, const RunResult& result);

}  // namespace cdot
