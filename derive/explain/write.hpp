// From formulas to text, once for all formats: where parentheses stand is decided here, what the
// signs look like by each format.
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

class FormulaWriter {
 public:
  virtual ~FormulaWriter() = default;

  std::string write(const Formula& f) const { return write(f, Place::whole); }
  // A sum as one piece a term, signs included; anything else as one piece.
  std::vector<std::string> pieces(const Formula& f) const;

 protected:
  virtual std::string name(const Formula& leaf) const = 0;
  virtual std::string number(Rational value) const = 0;
  virtual std::string sign(bool minus, bool first) const = 0;
  virtual std::string between(Shape shape) const = 0;  // what joins factors, dot and cross
  virtual std::string fraction(const std::string& above, const std::string& below) const = 0;
  virtual bool fraction_encloses() const { return true; }  // its parts need no parentheses
  virtual std::string power(const std::string& base, int exponent) const = 0;
  virtual std::string call(const std::string& function, const std::vector<std::string>& args) const = 0;
  virtual std::string norm(const std::string& arg) const = 0;
  virtual std::string component(const std::string& arg, const std::string& axis) const = 0;
  virtual std::string transpose(const std::string& arg) const = 0;
  virtual std::string identity() const = 0;
  virtual std::string matrix(int columns, const std::vector<std::string>& entries) const = 0;
  virtual std::string parentheses(const std::string& inner) const = 0;

 private:
  enum class Place { whole, term, negated, opening_minus, factor, operand, base };

  std::string write(const Formula& f, Place place) const;
  std::string bare(const Formula& f) const;
  std::string fraction_of(const Formula& f) const;
  bool needs_parentheses(const Formula& f, Place place) const;
  std::string joined(const Formula& f, Place inner) const;
};

// The words with each {} replaced by what `formula` writes, and the rest by what `plain` makes of
// it.
template <class Plain, class Written>
std::string fill(const Words& words, Plain plain, Written formula) {
  std::string out;
  std::size_t at = 0;
  for (const Formula& f : words.formulas) {
    const std::size_t next = words.text.find("{}", at);
    out += plain(words.text.substr(at, next - at)) + formula(f);
    at = next + 2;
  }
  return out + plain(words.text.substr(at));
}

}  // namespace cdot::derive
