// The equations of a mechanism of one freedom in its few angles u, as programs. With E = dq/du and c(u) = 0, what is
// left of its loops: all velocities are multiples of t = E t_u, c' t_u = 0, so the joints' impulses take M v to its
// part along t, v = t w t^T M v with w = 1 / (t^T M t). A correction of poses moves q from where it came free to
//   c(u) = 0,  w t^T M (q(u) - q_free) = 0
// as M^-1 J^T lambda does; its matrix A = (c'; w t^T M E) has the determinant 1 where t is that of the same pose.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "derive/compile/one_freedom/coordinates.hpp"

namespace cdot::compile {

// Equations of the header; empty: the mechanism is another one.
struct FreedomPrograms {
  std::vector<std::string> angles;  // bodies whose angles are kept: "crank"
  std::vector<std::string> stored;  // the numbers of t, of w and of the columns of A^-1 that find_tangent() writes
  // Functions of the header, by their names:
  Program find_tangent;   // q -> F: Freedom
  Program go_along;       // F, v -> next = t w t^T M v
  Program find_impulses;  // q, F, d -> lambda: M d = J^T lambda
  // F, free, found: moves of the angles -> q, moves = q - free, missed: errors of both equations, off: the square of
  // the last one's
  Program place;
  // q, F, missed -> turn: a step of Newton's method; share: of an error, squared, that one with A of the start leaves
  Program aim_angles;
  bool exists() const { return !angles.empty(); }
};
std::vector<const Program*> programs_of_freedom(const FreedomPrograms& freedom);

FreedomPrograms freedom_of(const RowBlocks& blocks, const JointRows& joints, Constants& constants);

}  // namespace cdot::compile
