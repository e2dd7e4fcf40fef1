// Joints to the texts of all generated files.
#include "derive/generate.hpp"

#include <algorithm>

#include "derive/emit.hpp"

namespace cdot::derive {

Files generate(const std::vector<Joint>& joints, const std::vector<LedgerRow>& hand_counts) {
  Files files;
  std::vector<std::string> names;
  std::vector<LedgerRow> ledger;
  for (const Joint& joint : joints) {
    const Kernel kernel = plan_kernel(joint);
    files["planar/" + joint.name + ".hpp"] = emit_kernel(kernel);
    names.push_back(joint.name);
    const std::vector<LedgerRow> rows = ledger_of(kernel);
    ledger.insert(ledger.end(), rows.begin(), rows.end());
  }
  ledger.insert(ledger.end(), hand_counts.begin(), hand_counts.end());
  std::sort(names.begin(), names.end());
  files["registry.hpp"] = emit_registry(names);
  files["ledger.csv"] = emit_ledger(std::move(ledger));
  return files;
}

}  // namespace cdot::derive
