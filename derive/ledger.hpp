// What every kernel costs, and what the published derivations of the same quantity cost after the
// same passes.
#pragma once

#include <string>
#include <vector>

#include "derive/kernel.hpp"

namespace cdot::derive {

struct LedgerRow {
  std::string space;                   // "planar", "spatial"
  std::string joint, block, quantity;  // "line", "slide.a_immovable", "jacobian"
                                       // ("apply_isotropic"); quantities from poses: "C", "J", "K"
  std::string source;                  // "generated", or the id of a hand derivation
  Count count;
};

// The functions of a kernel, and C, J and K alone from poses and parameters, to compare with other
// derivations.
std::vector<LedgerRow> ledger_of(const Kernel& kernel);

// The cost of computing these scalars of a joint from poses and parameters, after the passes that
// kernels go through.
Count cost_from_poses(const Joint& joint, const std::vector<Expr>& scalars);

std::string emit_ledger(std::vector<LedgerRow> rows);

}  // namespace cdot::derive
