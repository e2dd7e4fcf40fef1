// A scene -> its run: by the method that it names, or by one that reaches its accuracy.
#pragma once

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

// Runs a scene that names its method as it is. For one that asks for an accuracy (see chooses_method()) it tries
// methods, the most promising first, each with finer and finer steps. A run counts if it has ended, no step of it was
// left to an implicit method, and its distance from the run before it, less the gain by the finer steps, is within the
// accuracy. It ends early if that distance will be too large. Equal steps of a low order count if a first run of
// another method agrees with them. The last run is delivered. `warnings` receives warnings in the lines of the scene.
RunResult simulate(const Scene& scene, const RunOptions& options, std::string& warnings);

}  // namespace cdot
