// The stiffness of tension between bodies as rows: the part of -d(J^T lambda)/dq that couples their displacements, as
// in a taut rod or rope. As the World does it: runtime/solve/tension.hpp. Its symmetric part H of a joint is
//
//   H = W^T D W + (own rotations),   impulse mu = -h/4 D W v of a round (middle.cpp)
//
// with rows W and D > 0 by elimination, always of the displacement with the largest stiffness.
#pragma once

#include <algorithm>
#include <deque>
#include <vector>

#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

class Tensions {
 public:
  Tensions(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

  std::size_t rows() const { return rows_; }
  // The numbers of W, row by row, of bodies that move.
  std::size_t numbers() const { return numbers_; }

  // Of a block as write() counts them.
  bool has(std::size_t block) const { return std::ranges::find(taut_, block, &Taut::block) != taut_.end(); }
  // Those of a joint (its number in the system of joints) or, after these, of a row with bounds, from its stiffness A:
  // outputs B.w and B.d, the numbers of W and D, which other programs read as N.w and N.d. Takes them from A, so that
  // own rotations are left.
  void write(Algebra& algebra, std::size_t block, std::vector<std::vector<int>>& A) const;

  // As blocks of a system, one for each joint that has some.
  std::vector<RowBlock> blocks() const;
  // The numbers that the block with this number reads.
  Values inputs(Algebra& algebra, const RowBlocks& blocks, std::size_t number) const;
  // By row of that block: sqrt(h/4 D), by which an effect's rows count in a system.
  std::vector<int> share(Algebra& algebra, std::size_t number) const;

 private:
  struct Taut {
    std::size_t block;  // of a joint or, after these, of a row with bounds
    RowBlock of;
    std::size_t count, first_row, first_number;
    RowPrograms programs;
  };
  struct Place {  // of a number of a row
    std::size_t body, column;
  };
  std::vector<Place> places(const RowBlock& block) const;

  const RowBlocks& blocks_;
  std::deque<Taut> taut_;  // whose blocks point to their programs
  std::size_t rows_ = 0, numbers_ = 0;
};

}  // namespace cdot::compile
