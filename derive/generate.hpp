// All generated files of a set of joints, in memory: what `cdot derive` writes and `cdot derive
// --check` compares.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "derive/kernel.hpp"
#include "derive/ledger.hpp"

namespace cdot::derive {

using Files = std::map<std::string, std::string>;  // path below generated/ -> content

// Kernels, registry and ledger; the order of `joints` does not matter.
Files generate(const std::vector<Joint>& joints, const std::vector<LedgerRow>& hand_counts);

}  // namespace cdot::derive
