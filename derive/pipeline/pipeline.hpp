// One spec from text to kernel.
#pragma once

#include <string>
#include <vector>

#include "derive/kernel/generate.hpp"
#include "derive/language/specs_folder.hpp"
#include "derive/pipeline/proof_record.hpp"

namespace cdot::derive {

struct Outcome {
  bool proved = false;           // else `complaints` says why not, and the rest is empty
  bool on_record = false;        // it was proved by an earlier run
  std::string said, complaints;  // for stdout and stderr
  std::vector<ProofRow> proofs;
  GeneratedJoint joint;
  std::vector<LedgerRow> hand_costs;  // of the published derivations beside it that agree
};

// Proves what is not on record.
Outcome derive_spec(const std::filesystem::path& spec, const SpecsFolder& folder, const ProofRecord& record);

}  // namespace cdot::derive
