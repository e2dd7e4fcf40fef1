// A problem as a tree of joints with loops closed by what is left over: for the engines in minimal coordinates.
#pragma once

#include <vector>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

struct Branch {
  int body;
  int parent;  // a body, or `world`
  int joint;   // -1: nothing holds it, it is free
};

struct Tree {
  std::vector<Branch> branches;  // parents before children
  std::vector<int> loops;        // joints that the tree does not use
};

// Throws CannotSay where a joint of the tree starts open.
Tree tree_of(const Problem& problem);

// How fast the joint of a branch moves at the start: child against parent, along or about the axis.
double rate(const Problem& problem, const Branch& branch);
// The same for a ball joint, in world axes.
Vec3 spin(const Problem& problem, const Branch& branch);

}  // namespace cdot::peers
