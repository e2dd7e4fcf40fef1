// `cdot-run diagnose`: what a run that was looked at says of its islands and of its method.
#pragma once

#include <string>

#include "runtime/tool/run/simulate.hpp"

namespace cdot {

std::string diagnosis_text(const Scene& scene, const RunResult& result);
std::string diagnosis_json(const Scene& scene, const RunResult& result);

}  // namespace cdot
