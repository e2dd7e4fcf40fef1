#include "runtime/tool/scene/csv.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>

#include <cdot/settings.hpp>

#include "derive/interpret/formula.hpp"
#include "runtime/tool/scene/mistakes.hpp"

namespace cdot {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr const char* blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

struct Cell {
  std::string_view text;
  std::size_t at;  // its first character in the line, from 1
};

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(line.find_first_of(",;", begin), line.size());
    const std::string_view text = trimmed(line.substr(begin, end - begin));
    cells.push_back({text, text.empty() ? begin + 1 : static_cast<std::size_t>(text.data() - line.data()) + 1});
    if (end == line.size()) return cells;
    begin = end + 1;
  }
}

double number_of(const Cell& cell, int line) {
  double value = 0;
  const char* const end = cell.text.data() + cell.text.size();
  const auto [rest, error] = std::from_chars(cell.text.data(), end, value);
  if (error != std::errc{} || rest != end)
    throw Error(fmt::format("line {}, column {}: \"{}\" is not a number", line, cell.at, cell.text));
  return value;
}

}  // namespace

Csv read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error("the file cannot be read");
  Csv csv;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    const std::string_view text = trimmed(std::string_view(line).substr(0, line.find('#')));
    if (text.empty()) continue;
    const std::vector<Cell> cells = cells_of(std::string_view(line).substr(0, line.find('#')));
    if (csv.heads_.empty()) {
      for (const Cell& cell : cells) {
        const std::size_t open = std::min(cell.text.find('['), cell.text.size());
        const std::size_t close = std::min(cell.text.find(']', open), cell.text.size());
        const std::string_view unit = open < close ? cell.text.substr(open + 1, close - open - 1) : "";
        csv.heads_.push_back({std::string(trimmed(cell.text.substr(0, open))), std::string(unit)});
      }
      csv.columns_.resize(csv.heads_.size());
      continue;
    }
    if (cells.size() != csv.heads_.size())
      throw Error(fmt::format("line {} has {} numbers for {} columns", number, cells.size(), csv.heads_.size()));
    for (std::size_t k = 0; k < cells.size(); ++k) csv.columns_[k].push_back(number_of(cells[k], number));
  }
  if (csv.heads_.empty()) throw Error("the file is empty: it needs a line of heads, \"time, F\", and lines of numbers");
  return csv;
}

std::vector<double> Csv::column(std::string_view name, std::string_view unit) const {
  const auto head = std::ranges::find(heads_, name, &Head::name);
  if (head == heads_.end()) {
    std::vector<std::string> known;
    for (const Head& one : heads_) known.push_back(one.name);
    throw Error(fmt::format("it has no column \"{}\"; {}", name, did_you_mean(name, known)));
  }
  std::vector<double> numbers = columns_[static_cast<std::size_t>(head - heads_.begin())];
  if (head->unit.empty()) return numbers;
  const FormulaInTime::Reading read = FormulaInTime::read("1 [" + head->unit + "]", unit);
  if (!read.formula)
    throw Error(fmt::format("column \"{}\" is in [{}]: {}", name, head->unit, read.mistakes.front().cause));
  const double factor = read.formula->at(0)[0];
  for (double& number : numbers) number *= factor;
  return numbers;
}

}  // namespace cdot
