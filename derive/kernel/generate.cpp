#include "derive/kernel/generate.hpp"

#include <algorithm>

#include "derive/kernel/emit.hpp"

namespace cdot::derive {

GeneratedJoint print(const Kernel& kernel) {
  const Joint& joint = kernel.derivation->joint;
  return {name_of_space(joint), joint.name, emit_kernel(kernel), ledger_of(kernel), joint.law.has_value()};
}

Files collect(const std::vector<GeneratedJoint>& joints, const std::vector<LedgerRow>& hand_counts) {
  Files files;
  struct Names {
    std::vector<std::string> joints, effects;
  };
  std::map<std::string, Names> names = {{"coordinate", {}}, {"planar", {}}, {"spatial", {}}};
  std::vector<LedgerRow> ledger;
  for (const GeneratedJoint& joint : joints) {
    files[joint.space + "/" + joint.name + ".hpp"] = joint.kernel;
    Names& of_space = names[joint.space];
    (joint.is_effect ? of_space.effects : of_space.joints).push_back(joint.name);
    ledger.insert(ledger.end(), joint.ledger.begin(), joint.ledger.end());
  }
  ledger.insert(ledger.end(), hand_counts.begin(), hand_counts.end());
  for (auto& [space, list] : names) {
    std::sort(list.joints.begin(), list.joints.end());
    std::sort(list.effects.begin(), list.effects.end());
    files[space + "/registry.hpp"] = emit_registry(space, list.joints, list.effects);
  }
  files["ledger.csv"] = emit_ledger(std::move(ledger));
  return files;
}

}  // namespace cdot::derive
