// The comment above a kernel: the joint in words, then C, J and K in the spec's own names.
#include <fmt/format.h>

#include <set>

#include "derive/emit.hpp"

namespace cdot::derive {
namespace {

// Names that the given expressions use and that are not defined yet, each with its definition, in order of need.
void add_definitions(const std::vector<Expr>& roots, std::set<std::string>& known,
                     std::vector<std::string>& lines) {
  for (const Expr e : topological(roots)) {
    if (e->name.empty() || !e->named_by_let || !known.insert(e->name).second) continue;
    lines.push_back(fmt::format("  {} = {}", e->name, text(e)));
  }
}

std::string row_text(const ScalarRow& row) {
  std::string s = "[";
  for (const JacobianEntry& entry : row.J) {
    s += fmt::format("{} {} | {}", s.size() > 1 ? " |" : "", text(entry.v), text(entry.w));
  }
  return s + " ]";
}

const char* relation(RowKind kind) {
  return kind == RowKind::inequality ? " >= 0" : kind == RowKind::velocity ? " (velocities only)" : "";
}

void describe_block(const Joint& joint, const Block& block, const std::string& label,
                    std::set<std::string>& known, std::vector<std::string>& lines) {
  std::vector<Expr> roots;
  for (const ScalarRow& row : block.rows) {
    roots.push_back(row.kind == RowKind::velocity ? row.Cdot : row.C);
    lines.push_back(fmt::format("{}{} = {}{}", label, row.name, text(roots.back()), relation(row.kind)));
  }
  for (const ScalarRow& row : block.rows) {
    for (const JacobianEntry& entry : row.J) roots.insert(roots.end(), {entry.v, entry.w});
  }
  add_definitions(roots, known, lines);
  std::string columns;
  for (const std::string& body : joint.bodies) columns += (columns.empty() ? "v_" : " | v_") + body + " | w_" + body;
  lines.push_back(fmt::format("J by [ {} ]", columns));
  for (const ScalarRow& row : block.rows) lines.push_back("  " + row.name + ": " + row_text(row));
  for (std::size_t i = 0; i < block.rows.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      lines.push_back(fmt::format("K{}{} = {}", i + 1, j + 1, text(block.K[i][j])));
    }
  }
}

}  // namespace

std::vector<std::string> describe(const Kernel& kernel) {
  const Joint& joint = *kernel.joint;
  std::vector<std::string> lines = {joint.name + ": " + joint.title};
  if (!joint.source.empty()) lines.push_back("Source: " + joint.source);
  lines.push_back("");
  std::set<std::string> known;
  describe_block(joint, kernel.rows.block, "", known, lines);
  for (const KernelBlock& coordinate : kernel.coordinates) {
    lines.push_back("");
    describe_block(joint, coordinate.block, "coordinate ", known, lines);
  }
  return lines;
}

}  // namespace cdot::derive
