// A problem as a tree of joints with loops closed by what is left over: for the engines in minimal coordinates.
#pragma once

#include <vector>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

struct Branch {
  int body;
  int parent;  // a body, or `world`
  int joint;   // -1: nothing holds it, it is free, or does not move
};

struct Tree {
  std::vector<Branch> branches;  // parents before children
  std::vector<int> loops;        // joints that the tree does not use
};

// Whether a joint leaves too much free for a tree, and closes a loop always.
bool only_closes(const Joint& joint);

// Throws CannotSay where a joint of the tree starts open.
Tree tree_of(const Problem& problem);

// Moves bodies until the joints of the tree meet.
void close_tree(Problem& problem);

// The branch of the tree by which a hinge holds one of two bodies to the other; throws CannotSay if there is none.
const Branch& hinge_between(const Problem& problem, const Tree& tree, int a, int b);
// The stops of its hinge, for the angle that it has turned since the start, of the child against its parent.
Stops stops_from_start(const Problem& problem, const Branch& branch);
// 1, or -1 if the tree has its joint the other way round.
double sense(const Problem& problem, const Branch& branch);

// How fast the joint of a branch moves at the start: child against parent, along or about the axis.
double rate(const Problem& problem, const Branch& branch);
// The turns of its joint from parent to child.
std::vector<Turn> turns_of(const Problem& problem, const Branch& branch, bool free_first);
// The same for a joint that turns about more than one axis, in world axes.
Vec3 spin(const Problem& problem, const Branch& branch);

}  // namespace cdot::peers
