// All that `cdot derive` makes of one spec, and the memory of it: proving takes seconds, and depends on nothing but
// the texts and the program.
#pragma once

#include <string>
#include <vector>

#include "derive/derivation/specs_folder.hpp"
#include "derive/kernel/generate.hpp"
#include "derive/pipeline/cache.hpp"

namespace cdot::derive {

struct Outcome {
  bool proved = false;           // else `complaints` says why not, and the rest is empty
  bool remembered = false;       // it was found out by an earlier run
  std::string said, complaints;  // for stdout and stderr
  GeneratedJoint joint;
  std::vector<LedgerRow> hand_costs;  // of the published derivations beside it, as far as they are right
};

// Reads, proves, writes out and judges.
Outcome derive_spec(const std::filesystem::path& spec, const SpecsFolder& folder);

// The same from memory, if it holds this spec; else into it, if that was proved. `program` is identity_of_program().
Outcome derive_spec(const std::filesystem::path& spec, const SpecsFolder& folder, const Memory& memory,
                    const std::string& program, bool fresh);

std::string packed(const Outcome& outcome);
Outcome unpacked_outcome(const std::string& parcel);  // throws Unpacking::Damaged

}  // namespace cdot::derive
