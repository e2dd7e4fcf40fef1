// Kernels to the ledger of operation counts, generated/ledger.csv: the diff of a change shows its price.
#include "derive/kernel/ledger.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <tuple>

namespace cdot::derive {
namespace {

void add_functions(const Joint& joint, const KernelBlock& block, const std::string& name,
                   std::vector<LedgerRow>& rows) {
  for (const KernelFunction& f : block.functions) {
    const std::string quantity = f.name + (f.isotropic ? "_isotropic" : "");
    rows.push_back({name_of_space(joint), joint.name, name, quantity, "generated", count(f.program)});
  }
  for (const KernelBlock& variant : block.variants) {
    add_functions(joint, variant, (name == "rows" ? "" : name + ".") + variant.name, rows);
  }
}

void add_quantities(const Joint& joint, const Block& block, const std::string& name, std::vector<LedgerRow>& rows) {
  if (block.rows.empty()) return;
  const std::string space = name_of_space(joint);
  std::vector<Expr> C, J, K;
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    C.push_back(block.rows[i].C);
    for (const Expr entry : columns_of(block.rows[i].J)) J.push_back(entry);
    for (const Expr entry : block.K[i]) K.push_back(entry);
  }
  for (const auto& [quantity, entries] : {std::pair{"C", C}, {"J", J}, {"K", K}}) {
    rows.push_back({space, joint.name, name, quantity, "generated", cost_from_poses(joint, quantity, entries)});
  }
}

}  // namespace

Count cost_from_poses(const Joint& joint, std::string_view quantity, const std::vector<Expr>& entries) {
  PoseInputs pose(joint);
  std::vector<NamedExpr> outputs;
  for (const Expr entry : entries) {
    // A kernel's Jacobian stores one number for an entry and its negative; its readers add or subtract. C and K are
    // returned with their signs.
    const Expr e = pose.of(entry);
    const bool negative = e->kind == Kind::sum && !e->coefs.empty() && e->coefs[0].sign() < 0;
    outputs.push_back({"", negative && quantity == "J" ? -e : e});
  }
  return count(simplify(assemble(outputs)));
}

std::vector<LedgerRow> ledger_of(const Kernel& kernel) {
  std::vector<LedgerRow> rows;
  const Joint& joint = kernel.derivation->joint;
  add_quantities(joint, *kernel.rows.block, "rows", rows);
  add_functions(joint, kernel.rows, "rows", rows);
  for (const KernelBlock& coordinate : kernel.coordinates) {
    add_quantities(joint, *coordinate.block, coordinate.name, rows);
    add_functions(joint, coordinate, coordinate.name, rows);
  }
  return rows;
}

std::string emit_ledger(std::vector<LedgerRow> rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const LedgerRow& a, const LedgerRow& b) {
    return std::tie(a.space, a.joint, a.block, a.quantity) < std::tie(b.space, b.joint, b.block, b.quantity);
  });
  std::string s = "space,joint,block,quantity,source,add,multiply,divide,root,compare,call,total\n";
  for (const LedgerRow& r : rows) {
    const Count& c = r.count;
    s += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", r.space, r.joint, r.block, r.quantity, r.source, c.add,
                     c.multiply, c.divide, c.root, c.compare, c.call, c.total());
  }
  return s;
}

}  // namespace cdot::derive
