// The rows of the joints of a mechanism: `evaluate` stores their J and the factor of K, other functions read these.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "derive/compile/rows/row_system.hpp"

namespace cdot::compile {

class JointRows {
 public:
  explicit JointRows(const RowBlocks& blocks);

  const RowSystem& system() const { return system_; }

  // q, time -> J. Appends what it stores.
  Program evaluate(Constants& constants, std::vector<std::string>& stored);

  // --- afterwards ---

  // Inputs of a block of the system, with J as it was stored.
  Values inputs(Algebra& algebra, std::size_t block) const;
  // C of all rows; 0 of motors.
  std::vector<int> errors(Algebra& algebra) const;
  // J v + dC/dt of all rows, with these velocities in place of v, if there are any.
  std::vector<int> rates(Algebra& algebra, const Values& velocities) const;
  // dC/dt of a row; 0 for most; of a motor whose speed follows a function of time, what it takes from the rate.
  int drift(Algebra& algebra, std::size_t row) const;
  int factor(Algebra& algebra, const std::string& name) const { return read(algebra, factor_.at(name)); }

 private:
  // A number: a constant, or a member of the header's Jacobian, or its negative.
  struct Stored {
    std::optional<double> constant;
    std::string member;
    int sign = 1;
  };
  static int read(Algebra& algebra, const Stored& stored);
  static int held(Algebra& algebra, const Values& in, int number);

  const RowBlocks& blocks_;
  RowSystem system_;
  std::vector<std::map<std::string, Stored>> J_;  // by block and field
  std::map<std::size_t, Stored> rates_;           // drift(), by row
  std::map<std::size_t, Stored> holds_;           // by block of a joint that may break
  std::map<std::string, Stored> factor_;
};

}  // namespace cdot::compile
