// A problem -> a tree of joints; the other joints close loops. For engines in minimal coordinates.
#pragma once

#include <vector>

#include "tests/bench/peers/geometry.hpp"

namespace cdot::peers {

struct Branch {
  int body;
  int parent;  // a body, or `world`
  int joint;   // -1: no joint; the body is free or static
};

struct Tree {
  std::vector<Branch> branches;  // parents before children
  std::vector<int> loops;        // joints outside the tree
};

// True if a joint has too many degrees of freedom for a tree and therefore always closes a loop.
bool only_closes(const Joint& joint);

// Throws CannotSay if a joint of the tree starts open.
Tree tree_of(const Problem& problem);

// Moves bodies until the joints of the tree meet.
void close_tree(Problem& problem);

// The branch of a hinge between two bodies; throws CannotSay if there is none.
const Branch& hinge_between(const Problem& problem, const Tree& tree, int a, int b);
// The stops and the servo of its hinge, for the angle since the start, of the child relative to its parent.
Stops stops_from_start(const Problem& problem, const Branch& branch);
Servo servo_from_start(const Problem& problem, const Branch& branch);
// 1, or -1 if the tree reverses the joint.
double sense(const Problem& problem, const Branch& branch);

// The rate of a branch's joint at the start: child relative to parent, along or about the axis.
double rate(const Problem& problem, const Branch& branch);
// The rotations of its joint from parent to child.
std::vector<Turn> turns_of(const Problem& problem, const Branch& branch, bool free_first);
// The same for a joint with several axes, in world axes.
Vec3 spin(const Problem& problem, const Branch& branch);

}  // namespace cdot::peers
