// The estimated error of a trajectory -> its verdict in words, and its part of the summary.
#pragma once

#include <string>

#include "runtime/text/json.hpp"
#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// A run warns of an estimate above this share of a mechanism's size, or of 1 rad.
double warned_trajectory_share(const Scene& scene);
// Why the estimate fails the run, or only warns; empty if it does neither. Without a fix. A run that was searched for
// has an error that was measured instead.
std::string trajectory_failure(const Scene& scene, const RunResult& result);
std::string trajectory_warning(const Scene& scene, const RunResult& result);

// Of blows that the errors of steps decide, or of a joint that may break by them; empty if there are none. Without a
// fix.
std::string decision_warning(const Scene& scene, const RunResult& result);

// Of motors that no motion obeys; empty if there are none.
std::string contradiction(const Scene& scene, const RunResult& result);

std::string error_text(const Scene& scene, const TrajectoryError& error);
text::Json error_json(const Scene& scene, const TrajectoryError& error);

}  // namespace cdot
