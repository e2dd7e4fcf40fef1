// A planar mechanism of one freedom in a few angles: the other coordinates follow from these one by one, by rows in
// which they have constant coefficients. Rows that are left close its loops.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "derive/compile/rows/components.hpp"
#include "derive/compile/rows/joint_rows.hpp"

namespace cdot::compile {

// Operations by rows of J and by components of the velocity; -1: zero.
using Columns = std::vector<std::vector<int>>;

struct FewCoordinates {
  // So many angles at most: inverses are cofactors then. The loops are one fewer.
  static constexpr std::size_t most = 3;
  struct Elimination {
    std::size_t row, component;
    double coefficient;  // of the component in the row
  };

  std::vector<Component> components;    // of all velocities
  std::vector<std::size_t> angles;      // components: the coordinates that are kept
  std::vector<Elimination> eliminated;  // in the order in which they follow
  std::vector<std::size_t> loops;       // rows
};

// J of the pose.
Columns jacobian_of(const RowBlocks& blocks, const RowSystem& system, Algebra& algebra);

// None for another mechanism, and for one whose joints follow time or may break, or with a body that cannot turn.
std::optional<FewCoordinates> few_coordinates(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

}  // namespace cdot::compile
