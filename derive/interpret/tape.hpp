// A program -> a tape: one operation a step over doubles, in the order in which the printed kernel computes. So a tape
// gives the bits of the compiled kernel.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "derive/program/program.hpp"

namespace cdot::derive {

class Tape {
 public:
  Tape() = default;
  // `pi` is a constant; all other inputs are numbered in the order of `inputs()`.
  explicit Tape(const Program& program);

  // Names of the inputs that the program reads, and of its outputs.
  const std::vector<std::string>& inputs() const { return inputs_; }
  const std::vector<std::string>& outputs() const { return outputs_; }
  // The registers before the first run: constants are in place, and a run leaves them there.
  const std::vector<double>& registers() const { return registers_; }

  // Allocates nothing. `registers` is a copy of registers(), kept from run to run by the caller: runs of several
  // threads have their own. `to` takes one number per output.
  void run(std::span<const double> inputs, std::span<double> registers, std::span<double> to) const;

 private:
  enum class Code : unsigned char { add, subtract, multiply, negate, function };
  // register[to] = register[a] (code) register[b]; a function reads its arguments from a, b, c.
  struct Step {
    Code code;
    Fn fn;
    int to, a, b, c;
  };
  int constant(double value);
  int emit(Code code, int a, int b = 0, Fn fn = {}, int c = 0);
  int sum(const Program& program, const Operation& op);
  int product(const Operation& op);
  int term(const Program& program, const Operation& sum, std::size_t term, Rational coef);

  std::vector<Step> steps_;
  std::vector<double> registers_;
  std::vector<std::string> inputs_, outputs_;
  std::vector<int> input_at_, output_at_;
  std::vector<int> at_;  // register of each operation, while the tape is made
};

}  // namespace cdot::derive
