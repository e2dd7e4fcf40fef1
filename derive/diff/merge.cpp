#include "derive/diff/merge.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <regex>

#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

// A sentence is "place: reason".
std::string reason_of(const Difference& d) { return d.sentence.substr(d.sentence.find(": ") + 2); }

template <class Text>
bool all_same(const std::vector<Difference>& entries, Text text) {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    if (text(entries[i], i) != text(entries[0], 0)) return false;
  }
  return true;
}

// Component i of a vector formula, as the formula: "-cross(ra, n).x" as "-cross(ra, n)".
std::string without_component(const std::string& text, std::size_t i) {
  return std::regex_replace(text, std::regex(std::string("\\.") + "xyz"[i] + "\\b"), "");
}

std::string condition_of(const Difference& d) {
  const std::string words = "equal only where ";
  const std::size_t at = d.sentence.find(words);
  return at == std::string::npos ? "" : d.sentence.substr(at);
}

void set_reason(Difference& d, const std::string& reason) {
  std::string place = d.sentence.substr(0, d.sentence.find(","));  // "J", "claim on C"
  if (!d.row.empty()) place += (d.row.find_first_of("-,") == d.row.npos ? ", row " : ", rows ") + d.row;
  const bool numbers = d.column.find_first_not_of("0123456789-") == d.column.npos;
  if (!d.column.empty()) place += (numbers ? ", columns " : ", ") + d.column;
  d.sentence = place + ": " + reason;
}

}  // namespace

Matrix difference_of(const Matrix& hand, const Matrix& generated, const Joint& joint) {
  Matrix difference = hand;
  for (std::size_t i = 0; i < hand.entries.size(); ++i) {
    difference.entries[i] = difference_of(hand.entries[i], generated.entries[i], joint);
  }
  return difference;
}

std::string text_of(const Matrix& m, const Joint& joint) {
  if (m.entries.size() == 1) return brief_text(m.at(0, 0), joint);
  std::string s;
  for (int r = 0; r < m.rows; ++r) {
    s += r == 0 ? "[" : " ; ";
    for (int c = 0; c < m.columns; ++c) s += (c == 0 ? "" : ", ") + brief_text(m.at(r, c), joint);
  }
  return s + "]";
}

Matrix part_of(const Matrix& m, int row, int rows, int column, int columns) {
  Matrix block{rows, columns, {}};
  for (int r = row; r < row + rows; ++r) {
    for (int c = column; c < column + columns; ++c) block.entries.push_back(m.at(r, c));
  }
  return block;
}

std::vector<Difference> merged(std::vector<Difference> entries, const BlockPlace& place) {
  if (entries.size() < 2) return entries;
  Difference one = entries[0];
  one.row = place.row;
  one.column = place.column;
  const bool kinds = all_same(entries, [](const Difference& d, std::size_t) { return d.kind; });
  const auto formula = [](const std::string Difference::*text) {
    return [text](const Difference& d, std::size_t i) { return without_component(d.*text, i); };
  };
  const auto reason = [](const Difference& d, std::size_t i) { return without_component(reason_of(d), i); };
  if (kinds && entries.size() == 3 && all_same(entries, reason) && all_same(entries, formula(&Difference::hand)) &&
      all_same(entries, formula(&Difference::generated)) && all_same(entries, formula(&Difference::difference))) {
    set_reason(one, reason(entries[0], 0));
    for (std::string Difference::*text : {&Difference::hand, &Difference::generated, &Difference::difference}) {
      one.*text = without_component(one.*text, 0);
    }
    return {one};
  }
  if (kinds && all_same(entries, [](const Difference& d, std::size_t) { return reason_of(d); })) {
    set_reason(one, reason_of(entries[0]));
    one.generated = place.generated;
    one.hand = place.hand;
    one.difference = place.difference;
    return {one};
  }
  const std::string condition = condition_of(entries[0]);
  const bool same_condition = all_same(entries, [](const Difference& d, std::size_t) { return condition_of(d); });
  if (!kinds || condition.empty() || !same_condition) return entries;
  set_reason(one, fmt::format("{} entries of it are {} (the first is shown)", entries.size(), condition));
  return {one};
}

}  // namespace cdot::derive
