// Simplified kernels to the texts of generated files: what `cdot derive` writes and `cdot derive --check` compares.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "derive/kernel/ledger.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::derive {

using Files = std::map<std::string, std::string>;  // path below generated/ -> content

// What one joint contributes: its kernel, and what that costs.
struct GeneratedJoint {
  std::string space, name, kernel;
  std::vector<LedgerRow> ledger;
};
GeneratedJoint print(const Kernel& kernel);

// Kernels, registries and ledger; the order of `joints` does not matter.
Files collect(const std::vector<GeneratedJoint>& joints, const std::vector<LedgerRow>& hand_counts);

}  // namespace cdot::derive
