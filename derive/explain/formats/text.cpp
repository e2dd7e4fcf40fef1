// The derivation for a terminal: one equation a line, the rule behind it, long sums broken between terms.
#include <algorithm>

#include "derive/explain/formats/write.hpp"

namespace cdot::derive {
namespace {

constexpr std::size_t text_width = 100;
constexpr std::size_t rule_column = 64;

// clang-format off
const FormulaStyle style = {
    .name = [](const Formula& leaf, const std::vector<std::string>&) { return leaf.name; },
    .opening_minus = "-", .minus = " - ", .plus = " + ", .product = " ", .dot = " · ", .cross = " × ", .comma = ", ",
    .integer = "#1", .negative = "-#1", .fraction = "#1/#2", .power = "#1^#2", .call = "#1(#2)", .norm = "|#1|",
    .component = "#1.#2", .transpose = "#1'", .identity = "E", .parentheses = "(#1)",
    .matrix = "[ #1 ]", .entry = "#1", .next_entry = " | ", .next_row = " ; ", .fraction_encloses = false};
// clang-format on

std::size_t width(const std::string& s) {
  return static_cast<std::size_t>(
      std::count_if(s.begin(), s.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

// Words broken at blanks; further lines start at `indent`.
std::string wrapped(const std::string& words, std::size_t indent, std::size_t page_width = text_width) {
  std::string out, line;
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    const std::string word = words.substr(at, end - at);
    if (!line.empty() && indent + width(line) + 1 + width(word) > page_width) {
      out += line + "\n" + std::string(indent, ' ');
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
    at = end + 1;
  }
  return out + line;
}

// "name = a + b", later links under the first sign of equality.
class ChainText {
 public:
  // Lines start with `margin` blanks and, rules aside, end within `page_width`.
  ChainText(std::size_t margin, std::size_t page_width) : margin_(margin), page_width_(page_width) {}

  std::string write(const Chain& chain) {
    std::string left = std::string(margin_, ' ') + formula_.write(chain.left);
    indent_ = width(left);
    // A long left side stands in a line of its own.
    if (indent_ > page_width_ / 2) {
      out_ += left + "\n";
      indent_ = margin_ + 2;
      left = std::string(indent_, ' ');
    }
    for (std::size_t i = 0; i < chain.links.size(); ++i) {
      line_ = i == 0 ? left : std::string(indent_, ' ');
      line_ += " = ";
      write_formula(chain.links[i].formula);
      write_rule(chain.links[i].rule);
    }
    return out_;
  }

 private:
  void write_formula(const Formula& f) {
    if (f.shape == Shape::matrix) return write_matrix(f);
    for (const std::string& piece : formula_.pieces(f)) {
      if (width(line_) + width(piece) > page_width_ && width(line_) > indent_ + 3) {
        finish_line();
        line_ = std::string(indent_ + 2, ' ');
      }
      line_ += piece;
    }
  }

  void write_matrix(const Formula& f) {
    const std::string whole = formula_.write(f);
    const bool one_row = f.args.size() == static_cast<std::size_t>(f.columns);
    const bool fits = width(line_) + width(whole) <= page_width_;
    if (one_row && fits) line_ += whole;
    else if (fits || width(whole) / f.args.size() * static_cast<std::size_t>(f.columns) < 80) write_rows(f);
    else write_entries(f);
  }

  // An entry a line where a row is too long for one: | before each but a row's first, ; before a new row.
  void write_entries(const Formula& f) {
    for (std::size_t i = 0; i < f.args.size(); ++i) {
      if (i > 0) finish_line();
      if (i > 0) line_ = std::string(indent_ + 3, ' ');
      line_ += i == 0 ? "[ " : i % static_cast<std::size_t>(f.columns) == 0 ? "; " : "| ";
      line_ += formula_.write(f.args[i]);
    }
    line_ += " ]";
  }

  // A row a line, columns under columns.
  void write_rows(const Formula& f) {
    const std::size_t columns = static_cast<std::size_t>(f.columns);
    std::vector<std::string> cells;
    std::vector<std::size_t> widths(columns);
    for (std::size_t i = 0; i < f.args.size(); ++i) {
      cells.push_back(formula_.write(f.args[i]));
      widths[i % columns] = std::max(widths[i % columns], width(cells.back()));
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t column = i % columns;
      if (i == 0) line_ += "[ ";
      else if (column == 0) line_ = std::string(indent_ + 3, ' ') + "  ";
      else line_ += " | ";
      const bool last_of_row = column + 1 == columns, last = i + 1 == cells.size();
      line_ += cells[i];
      if (!last_of_row || last) line_ += std::string(widths[column] - width(cells[i]), ' ');
      if (last) line_ += " ]";
      else if (last_of_row) finish_line();
    }
  }

  // Beside the formula if there is room, else below it.
  void write_rule(const std::string& rule) {
    if (!rule.empty()) {
      const std::string words = "(" + rule + ")";
      const std::size_t used = width(line_), beside = std::max(used + 2, rule_column);
      if (beside + width(words) <= page_width_ + 20) {
        line_ += std::string(beside - used, ' ') + words;
      } else {
        finish_line();
        const std::size_t below = std::min<std::size_t>(indent_ + 5, page_width_ / 2);
        line_ = std::string(below, ' ') + wrapped(words, below, page_width_);
      }
    }
    finish_line();
  }

  void finish_line() {
    out_ += line_ + "\n";
    line_.clear();
  }

  FormulaWriter formula_{style};
  std::string out_, line_;
  std::size_t margin_, page_width_, indent_ = 0;
};

std::string head(const std::string& title) { return title + "\n" + std::string(width(title), '=') + "\n"; }

std::string plain(const std::string& words) { return words; }

std::string item(const std::string& words, bool bullet) {
  return bullet ? "  - " + wrapped(words, 4) + "\n" : "  " + wrapped(words, 2) + "\n";
}

std::string chain(const Chain& chain, const FormulaWriter&) { return ChainText(4, text_width).write(chain); }

}  // namespace

std::string chain_text(const Chain& chain, std::size_t page_width) { return ChainText(0, page_width).write(chain); }

std::string explanation_text(const Explanation& explanation) {
  return written(explanation, {style, head, "", "\n#1. #2\n", "", "", "#1", plain, plain, item, chain});
}

}  // namespace cdot::derive
