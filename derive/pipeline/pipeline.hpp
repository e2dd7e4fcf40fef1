// One spec from text to kernel.
//
// Each result is made once and handed on:
//   text         read from its file once a run; an entry of a .hand file elaborates the same text again, into a pool
//                of its own, so that the names of one entry never show in another
//   derivation   made once: the object that is proved is the one that is planned, printed and described
//   expressions  interned by the Pool of the joint; a memo by node lives as long as one walk (time_derivative,
//                Transposition, Components)
//   proofs       the only cache that outlives a run: generated/proofs.csv, by content (proof_record.hpp)
#pragma once

#include <functional>
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

using UseKernel = std::function<void(const Kernel&)>;

// Proves what is not on record. Warns of programs whose search for fewer operations these bounds ended. `use` gets the
// kernel instead of the printer and of the published derivations.
Outcome derive_spec(const std::filesystem::path& spec, const SpecsFolder& folder, const ProofRecord& record,
                    SearchBounds bounds = usual_bounds, const UseKernel& use = {});

}  // namespace cdot::derive
