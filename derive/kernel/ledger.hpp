// What every kernel costs, and what the published derivations of the same quantity cost after the same passes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {

struct LedgerRow {
  std::string space;                   // "planar", "spatial"
  std::string joint, block, quantity;  // "line", "slide.a_immovable", "jacobian"
                                       // ("apply_isotropic"); quantities from poses: "C", "J", "K"
  // "generated", or the id of a published derivation that agrees wherever the joint is; then, if it does not say the
  // same as the spec, what it is about: "PRI-9 with t on a", "WLD-6 of pin". Such a one has a row beside it for what is
  // generated of the same: "generated with t on a".
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
