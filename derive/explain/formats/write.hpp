// From formulas and steps to text, once for all formats: this room decides on parentheses and the order of
// parts; the tables of a format give the signs.
#pragma once

#include "derive/explain/explain.hpp"

namespace cdot::derive {

// A name taken apart: `ua_dot` is u with index a and one dot, `inv_m_a` the inverse of m with index
// a, `K[pin, line]` is K with the index "pin, line".
struct SpelledName {
  std::string letter, index;
  int dots = 0;
  bool inverse = false;
};
SpelledName spell(const std::string& name, const std::vector<std::string>& bodies);

// How a format writes formulas; #1 and #2 stand for the parts.
struct FormulaStyle {
  std::string (*name)(const Formula& leaf, const std::vector<std::string>& bodies);
  std::string_view opening_minus, minus, plus, product, dot, cross, comma;  // between parts
  std::string_view integer, negative, fraction, power, call, norm, component, transpose, identity, parentheses;
  std::string_view matrix, entry, next_entry, next_row;  // #2 of a matrix: its columns as "c|c|c"
  bool fraction_encloses = true;                         // its parts need no parentheses
};

class FormulaWriter {
 public:
  explicit FormulaWriter(const FormulaStyle& style, std::vector<std::string> bodies = {})
      : style_(style), bodies_(std::move(bodies)) {}

  std::string write(const Formula& f) const { return write(f, Place::whole); }
  // A sum as one piece a term, signs included; anything else as one piece.
  std::vector<std::string> pieces(const Formula& f) const;

 private:
  enum class Place { whole, term, negated, opening_minus, factor, operand, base };

  std::string write(const Formula& f, Place place) const;
  std::string bare(const Formula& f) const;
  std::string integer(std::int64_t n) const;
  std::string fraction_of(const Formula& f) const;
  std::string matrix_of(const Formula& f) const;
  bool needs_parentheses(const Formula& f, Place place) const;
  std::string joined(const Formula& f, std::string_view between, Place inner) const;

  const FormulaStyle& style_;
  std::vector<std::string> bodies_;
};

// How a format writes the rest.
struct Format {
  const FormulaStyle& formula;
  std::string (*head)(const std::string& title);
  std::string_view foot, section, list_begin, list_end;        // #1, #2 of a section: number and heading
  std::string_view inline_formula;                             // in words
  std::string (*escaped)(const std::string& text);             // headings
  std::string (*prose)(const std::string& words);              // with `code` between backticks
  std::string (*item)(const std::string& words, bool bullet);  // in a line of its own
  std::string (*chain)(const Chain& chain, const FormulaWriter& formula);
};
std::string written(const Explanation& explanation, const Format& format);

std::string filled(std::string_view pattern, std::string_view first, std::string_view second = {});

}  // namespace cdot::derive
