// All results as JSON -> the page.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/peers/hard/outcome.hpp"

namespace cdot::peers {

// A column: planar engines get a case's planar scene, spatial engines the spatial one, Cdot both.
struct Column {
  const char* title;
  const char* engine;
  const char* lifted;  // engine for cases with a planar scene only
  bool planar;
  bool slow = false;  // stops at the first setting that holds
};
const std::vector<Column>& columns();

// The planar and the spatial case of one question.
struct Row {
  std::string name;  // the fault and the variant
  std::vector<hard::Case> cases;
};
std::vector<Row> rows();

// The case and the engine of a row and a column; null: not supported.
struct Question {
  const hard::Case* hard_case = nullptr;
  const Engine* engine = nullptr;
};
Question question(const Row& row, const Column& column);

// The results of a column in a row: all settings, the default first, and the best one with a finer step.
struct Cell {
  std::vector<Outcome> settings;
  Outcome finer;
  std::size_t best() const;  // the defaults, if they hold the case
};
nlohmann::json json_of(const Cell& cell);
Cell cell_of(const nlohmann::json& json);

// found[row name][column title] is a cell.
std::string page(const nlohmann::json& found);

}  // namespace cdot::peers
