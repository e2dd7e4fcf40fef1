// Joints to the texts of all generated files.
#include "derive/generate.hpp"

#include <algorithm>

#include "derive/emit.hpp"

namespace cdot::derive {

Files generate(const std::vector<Joint>& joints, const std::vector<LedgerRow>& hand_counts) {
  Files files;
  std::map<std::string, std::vector<std::string>> names = {{"planar", {}}, {"spatial", {}}};
  std::vector<LedgerRow> ledger;
  for (const Joint& joint : joints) {
    const Kernel kernel = plan_kernel(joint);
    const std::string space = name_of_space(joint.dimension);
    files[space + "/" + joint.name + ".hpp"] = emit_kernel(kernel);
    names[space].push_back(joint.name);
    const std::vector<LedgerRow> rows = ledger_of(kernel);
    ledger.insert(ledger.end(), rows.begin(), rows.end());
  }
  ledger.insert(ledger.end(), hand_counts.begin(), hand_counts.end());
  for (auto& [space, list] : names) {
    std::sort(list.begin(), list.end());
    files[space + "/registry.hpp"] = emit_registry(space, list);
  }
  files["ledger.csv"] = emit_ledger(std::move(ledger));
  return files;
}

}  // namespace cdot::derive
