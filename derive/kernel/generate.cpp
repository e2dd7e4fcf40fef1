#include "derive/kernel/generate.hpp"

#include <algorithm>

#include "derive/kernel/emit.hpp"

namespace cdot::derive {

GeneratedJoint print(const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  return {name_of_space(joint.dimension), joint.name, emit_kernel(kernel), ledger_of(kernel)};
}

Files collect(const std::vector<GeneratedJoint>& joints, const std::vector<LedgerRow>& hand_counts) {
  Files files;
  std::map<std::string, std::vector<std::string>> names = {{"planar", {}}, {"spatial", {}}};
  std::vector<LedgerRow> ledger;
  for (const GeneratedJoint& joint : joints) {
    files[joint.space + "/" + joint.name + ".hpp"] = joint.kernel;
    names[joint.space].push_back(joint.name);
    ledger.insert(ledger.end(), joint.ledger.begin(), joint.ledger.end());
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
