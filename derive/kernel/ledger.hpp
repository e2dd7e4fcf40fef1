// The cost of every kernel, and of the published derivations of the same quantities after the same passes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {

struct LedgerRow {
  std::string space;                   // "planar", "spatial", "coordinate"
  std::string joint, block, quantity;  // "line", "slide.a_immovable", "jacobian"
                                       // ("apply_isotropic"); quantities from poses: "C", "J", "K"
  // "generated", or the id of a published derivation that agrees at every pose. If its scope differs from the spec, the
  // scope follows: "PRI-9 with t on a", "WLD-6 of pin". Then another row has the generated cost of that scope:
  // "generated with t on a".
  std::string source;
  Count count;

  friend bool operator==(const LedgerRow&, const LedgerRow&) = default;
};

// The functions of a kernel, and C, J and K alone from poses and parameters, to compare with other derivations.
std::vector<LedgerRow> ledger_of(const Kernel& kernel);

// The cost of computing "C", "J" or "K", entry by entry, from poses and parameters, after the passes that kernels go
// through.
Count cost_from_poses(const Joint& joint, std::string_view quantity, const std::vector<Expr>& entries);

std::string emit_ledger(std::vector<LedgerRow> rows);

}  // namespace cdot::derive
