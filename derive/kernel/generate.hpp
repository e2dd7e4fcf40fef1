// Simplified kernels to generated files: `cdot derive` writes them, `cdot derive --check` compares them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "derive/kernel/ledger.hpp"
#include "derive/kernel/plan.hpp"

namespace cdot::derive {

using Files = std::map<std::string, std::string>;  // path below generated/ -> content

// The kernel of one joint, and its cost.
struct GeneratedJoint {
  std::string space, name, kernel;
  std::vector<LedgerRow> ledger;
  bool is_effect = false;
};
GeneratedJoint print(const Kernel& kernel);

// Kernels, registries and ledger; the order of `joints` does not matter.
Files collect(const std::vector<GeneratedJoint>& joints, const std::vector<LedgerRow>& hand_counts);

}  // namespace cdot::derive
