// A program -> a tape (runtime/tape/tape.hpp), and its run over doubles.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "derive/program/program.hpp"
#include "runtime/tape/tape.hpp"

namespace cdot::derive {

class NamedTape {
 public:
  NamedTape() = default;
  // `pi` and `unlimited` are constants; all other inputs are numbered in the order of `inputs()`.
  explicit NamedTape(const Program& program);

  // Names of the inputs that the program reads, and of its outputs.
  const std::vector<std::string>& inputs() const { return inputs_; }
  const std::vector<std::string>& outputs() const { return outputs_; }
  const Tape& tape() const { return tape_; }
  // The registers before the first run: constants are in place, and a run leaves them there.
  std::vector<double> registers() const;

  // Allocates nothing. `registers` is a copy of registers(), kept from run to run by the caller: runs of several
  // threads have their own. `to` takes one number per output.
  void run(std::span<const double> inputs, std::span<double> registers, std::span<double> to) const;

 private:
  std::vector<std::string> inputs_, outputs_;
  Tape tape_;  // after the names, which its lowering writes
};

}  // namespace cdot::derive
