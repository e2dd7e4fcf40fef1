// Newton's matrix where J has turned since the start of the step: B = J' M^-1 J^T = L D U, J' of a pose, J as stored.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

class Aim {
 public:
  Aim(const RowBlocks& blocks, const JointRows& joints) : blocks_(blocks), joints_(joints) {}

  // q, time, J -> B. Appends what it stores.
  Program factor(Constants& constants, std::vector<std::string>& stored);
  // J, B, b -> lambda with B lambda = b, d = M^-1 J^T lambda; after factor().
  Program solve(Constants& constants) const;

 private:
  using Grid = std::vector<std::vector<int>>;  // operations by places in the order of elimination; -1: zero

  Grid assembled(Algebra& algebra) const;
  int coupling(Algebra& algebra, std::size_t i, std::size_t r, const Values& of_i, std::size_t k, std::size_t s,
               const Values& of_k) const;
  // L and DU are found place by place.
  struct Factoring {
    Algebra& algebra;
    Constants& constants;
    Grid B, L, DU;
  };
  int left(Factoring& f, std::size_t i, std::size_t j, std::size_t k, const std::string& name) const;
  int own(Factoring& f, std::size_t j) const;
  void eliminate(Factoring& f, std::size_t j);
  // Two places that are one block of D, as in K.
  void eliminate_pair(Factoring& f, std::size_t j);
  void store(Factoring& f, const std::string& name, int op);
  const RowSystem& system() const { return joints_.system(); }

  const RowBlocks& blocks_;
  const JointRows& joints_;
  std::map<std::string, std::optional<double>> stored_;  // members of the header's Aim; those that are constant
};

}  // namespace cdot::compile
