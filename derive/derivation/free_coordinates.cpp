#include "derive/derivation/free_coordinates.hpp"

#include <algorithm>

#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

std::vector<ScalarRow> constraining_rows(const Block& block) {
  std::vector<ScalarRow> rows;
  for (const ScalarRow& row : block.rows) {
    if (row.kind != RowKind::inequality) rows.push_back(row);
  }
  return rows;
}

// The names of the rows that the last one depends on; empty if it is independent of them.
std::vector<std::string> last_depends_on(const std::vector<ScalarRow>& rows) {
  std::vector<std::string> names;
  for (const GenericRank::Dependence& d : generic_rank(columns_of(rows)).dependences) {
    if (d.row + 1 != static_cast<int>(rows.size())) continue;
    for (const int row : d.on) {
      const ScalarRow& on = rows[static_cast<std::size_t>(row)];
      const std::string name = on.row->name;  // of a vector row, not of its components
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

void drop_constrained_coordinates(Derivation& derivation) {
  std::vector<ScalarRow> rows = constraining_rows(derivation.rows);
  std::vector<Coordinate> coordinates = std::move(derivation.joint.coordinates);
  std::vector<Block> blocks = std::move(derivation.coordinates);
  derivation.joint.coordinates.clear();
  derivation.coordinates.clear();
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    Coordinate& c = coordinates[i];
    rows.push_back(blocks[i].rows.front());
    c.constrained_by = last_depends_on(rows);
    rows.pop_back();
    if (!c.constrained_by.empty() && !c.from.empty()) {
      derivation.joint.dropped.push_back(std::move(c));
      continue;
    }
    derivation.joint.coordinates.push_back(std::move(c));
    derivation.coordinates.push_back(std::move(blocks[i]));
  }
}

std::vector<Diagnostic> errors_of_constrained_coordinates(const Joint& joint) {
  std::vector<Diagnostic> errors;
  for (const Coordinate& c : joint.coordinates) {
    if (c.constrained_by.empty()) continue;
    errors.push_back({Severity::error,
                      c.where,
                      {},
                      "the coordinate " + c.name + " is not free: " + constraint_text(c),
                      "remove the coordinate, or the row that constrains it"});
  }
  return errors;
}

std::string constraint_text(const Coordinate& constrained) {
  const bool several = constrained.constrained_by.size() > 1;
  return (several ? "the rows " : "the row ") + listed(constrained.constrained_by) +
         (several ? " constrain it" : " constrains it");
}

}  // namespace cdot::derive
