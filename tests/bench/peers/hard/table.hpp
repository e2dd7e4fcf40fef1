// All that was found, as JSON, and the page made of it.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/peers/hard/outcome.hpp"

namespace cdot::peers {

// A way to be asked: engines of the plane get a case's planar scene, those of space the other; Cdot both.
struct Column {
  const char* title;
  const char* engine;
  const char* lifted;  // asked in its place where the case has a planar scene only
  bool planar;
  bool slow = false;  // asked until a setting holds
};
const std::vector<Column>& columns();

// Cases that are one question, in the plane and in space.
struct Row {
  std::string name;  // of the fault, and what tells it from its like
  std::vector<hard::Case> cases;
};
std::vector<Row> rows();

// The case of a row that a column is asked, and by which engine; null: none that it knows.
struct Question {
  const hard::Case* hard_case = nullptr;
  const Engine* engine = nullptr;
};
Question question(const Row& row, const Column& column);

// What a column made of a row: all settings, the default first, and the best of them with a finer step.
struct Cell {
  std::vector<Outcome> settings;
  Outcome finer;
  std::size_t best() const;  // the defaults, if they do
};
nlohmann::json json_of(const Cell& cell);
Cell cell_of(const nlohmann::json& json);

// found[row name][column title] is a cell.
std::string page(const nlohmann::json& found);

}  // namespace cdot::peers
