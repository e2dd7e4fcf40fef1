// A kernel function as a flat list of scalar operations by index. Passes rewrite this form, printers read it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "derive/expression/functions.hpp"
#include "derive/program/few.hpp"

namespace cdot::derive {

enum class OpKind : std::uint8_t {
  number,  // moves into coefficients
  factor,  // a number that stays a factor of products, to be shared and taken out as any other
  input,
  sum,
  product,
  function
};

// A text that operations share: passes copy programs thousands of times. Each one is kept until the process ends.
class SharedText {
 public:
  SharedText() = default;
  SharedText(const std::string& text) : text_(text.empty() ? nullptr : kept(text)) {}
  SharedText(const char* text) : SharedText(std::string(text)) {}

  bool empty() const { return !text_; }
  const std::string& text() const {
    static const std::string none;
    return text_ ? *text_ : none;
  }
  operator const std::string&() const { return text(); }
  friend bool operator==(SharedText a, SharedText b) = default;

 private:
  static const std::string* kept(const std::string& text);

  const std::string* text_ = nullptr;
};

using Operands = Few<int, 4>;
using Coefs = Few<Rational, 2>;

// Operands come before their users. Sums and products have any number of operands.
struct Operation {
  OpKind kind = OpKind::number;
  bool is_position = false;  // input: a coordinate of a centre of mass (large, so differences come first)
  Fn fn{};                   // function
  Rational value;            // number, factor
  SharedText input;          // input: the symbol's name
  Operands args;
  Coefs coefs;         // sum
  Operands exponents;  // product, positive
  SharedText name;     // from the spec, or empty
  friend bool operator==(const Operation&, const Operation&) = default;
};

struct Output {
  std::string name;  // "C1", "K21", ...
  int op = 0;
  friend bool operator==(const Output&, const Output&) = default;
};

struct Program {
  std::vector<Operation> ops;
  std::vector<Output> outputs;

  const Operation& at(int op) const { return ops[static_cast<std::size_t>(op)]; }
  friend bool operator==(const Program&, const Program&) = default;
};

// The term that opens a sum: the first positive one. Without one it is the first with a numeric factor, as in -2 x.
// Else it is the first one, negated, which costs an operation.
struct Lead {
  std::size_t term = 0;
  bool negated = false;
};
Lead lead_of(const Program& program, const Operation& sum);

// Operations by kind. A power x^n is n - 1 products; a subtraction or negation counts as an addition; the guarded
// inverse is a division and a comparison, a guarded pivot another product besides.
struct Count {
  int add = 0, multiply = 0, divide = 0, root = 0, compare = 0, call = 0;

  int total() const { return add + multiply + divide + root + compare + call; }
  friend bool operator==(const Count&, const Count&) = default;
};
std::string text(const Count& count);  // "8 + 6 * 1 / 1 root"

struct NamedExpr {
  std::string name;
  Expr e;  // written out in components
};

// The program that computes `outputs`. Equal work is shared; nothing else is done.
Program assemble(const std::vector<NamedExpr>& outputs);

// The cheapest program that the passes find: they share pairs of terms and of factors, and take out common factors.
Program simplify(const Program& program);
// The same with the work that the search may do (effort.hpp): where it is spent, the cheapest program so far.
struct Effort;
Program simplify(const Program& program, Effort& effort);

// How often each operation is used by needed operations and outputs.
std::vector<int> use_counts(const Program& program);

// Counts the operations that an output needs.
Count count(const Program& program);

}  // namespace cdot::derive
