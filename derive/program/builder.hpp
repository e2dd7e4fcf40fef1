// Builds a Program, each operation once. The assembler and every pass end in it.
#pragma once

#include <algorithm>
#include <span>
#include <utility>

#include "derive/program/program.hpp"

namespace cdot::derive {

// The place of an operand; the number of operands if it is none of them.
inline std::size_t index_of(std::span<const int> args, int arg) {
  return static_cast<std::size_t>(std::ranges::find(args, arg) - args.begin());
}

// coefs[0] args[0] + coefs[1] args[1] + ...
struct Summands {
  Operands args;
  Coefs coefs;
  void add(Rational coef, int arg) { args.push_back(arg), coefs.push_back(coef); }
};

// The rules that bring an operation into its normal form. Who stores operations, and where, is left to the heirs.
class Builder {
 public:
  virtual ~Builder() = default;
  int number(Rational value);
  // Numeric coefficients of operands move into sums and out of products; nothing is flattened.
  int sum(Summands terms, SharedText name = {});
  int product(Operands args, Operands exponents, SharedText name = {});
  int function(Fn fn, Operands args, SharedText name = {});
  int leaf(const Operation& op);  // an input or a factor
  // The same operation with other operands.
  int rebuild(const Operation& op, Operands args);

  virtual const Operation& at(int op) const = 0;

 protected:
  // The operation equal to `op`, or its negative if that is known, or `op` itself, stored.
  virtual int intern(Operation op) = 0;

 private:
  Summands ordered(Summands terms, std::size_t n) const;
  // Takes the numeric factor out of an operand: a sum with one term, or a number.
  Rational pull_coefficient(int& arg) const;
};

class ProgramBuilder final : public Builder {
 public:
  explicit ProgramBuilder(std::size_t expected = 0);

  const Operation& at(int op) const override { return program_.at(op); }
  int size() const { return static_cast<int>(program_.ops.size()); }
  void output(std::string name, int op) { program_.outputs.push_back({std::move(name), op}); }
  Program finish() { return std::move(program_); }

 private:
  int intern(Operation op) override;
  void enter(int op);

  Program program_;
  std::vector<std::size_t> hash_;  // by operation
  std::vector<int> slots_;         // hash table with open addresses: operations, or -1; at most half are taken
};

// The same for a sum and its negative.
std::size_t hash_of(const Operation& op);
// The sign s with a = s b; 0 if there is none. Only sums of several terms are negatives of each other.
int sign_between(const Operation& a, const Operation& b);

}  // namespace cdot::derive
