// The matrix D of the whole system, D v = 0: rows by joint, columns by movable body. No solver builds D.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <cdot/world.hpp>

namespace cdot {

struct SystemMatrix {
  struct Joint {
    int joint;              // of the World
    int first, rows;        // rows of D
    std::vector<int> body;  // its movable bodies, as positions in `bodies`
  };
  int freedom;                // columns of a body: 3 in the plane, 6 in space
  std::vector<int> bodies;    // movable ones, in the order of the World
  std::vector<Joint> joints;  // joints of a movable body
  int rows = 0, columns = 0;
  std::vector<double> D, K;  // [rows][columns], [rows][rows]: K = D M^-1 D^T
  std::vector<char> frozen;  // by column: 1 if the body cannot move in that direction
  int rank = 0, degrees_of_freedom = 0;

  double entry(int row, int column) const { return D[row * columns + column]; }
  // True if the joint's rows have no nonzero column for that body (position in `bodies`).
  bool empty_block(const Joint& joint, int body) const;
};

// D of all joints at the present poses, without effects.
template <class S>
SystemMatrix system_matrix(BasicWorld<S>& world);

// Pairs of joints that share a movable body and so cannot be solved in parallel. A greedy colouring gives the joints of
// a pair different colours.
struct ConflictGraph {
  std::vector<std::pair<int, int>> edges;  // positions in SystemMatrix::joints, ascending
  std::vector<int> colour;
  int colours = 0;
};
ConflictGraph conflicts(const SystemMatrix& system);

}  // namespace cdot
