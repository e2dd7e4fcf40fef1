#include "derive/derivation/free_coordinates.hpp"

#include <algorithm>

#include "derive/derivation/derivation.hpp"
#include "derive/numbers/modular.hpp"

namespace cdot::derive {
namespace {

std::vector<ScalarRow> rows_that_hold(const Joint& joint) {
  std::vector<ScalarRow> rows;
  for (const ScalarRow& row : derive_rows(joint).rows) {
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

std::vector<Coordinate> held_coordinates(const Joint& joint) {
  std::vector<Coordinate> held;
  if (joint.coordinates.empty()) return held;
  std::vector<ScalarRow> rows = rows_that_hold(joint);
  for (Coordinate c : joint.coordinates) {
    rows.push_back(derive_coordinate(joint, c).rows.front());
    c.held_by = last_depends_on(rows);
    rows.pop_back();
    if (!c.held_by.empty()) held.push_back(std::move(c));
  }
  return held;
}

void drop_held_coordinates(Joint& joint) try {
  for (Coordinate& held : held_coordinates(joint)) {
    if (held.from.empty()) continue;
    std::erase_if(joint.coordinates, [&](const Coordinate& c) { return c.name == held.name; });
    joint.dropped.push_back(std::move(held));
  }
} catch (const std::runtime_error&) {
  // Rows that cannot be differentiated hold nothing; whoever derives them says what is wrong.
}

Diagnostic held_error(const Coordinate& held) {
  return {Severity::error,
          held.where,
          {},
          "the coordinate " + held.name + " is not free: " + held_text(held),
          "drop the coordinate, or the row that holds it"};
}

std::string held_text(const Coordinate& held) {
  const bool several = held.held_by.size() > 1;
  return (several ? "the rows " : "the row ") + listed(held.held_by) + (several ? " hold it" : " holds it");
}

}  // namespace cdot::derive
