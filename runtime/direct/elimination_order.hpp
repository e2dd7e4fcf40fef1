// The graph of coupled blocks -> the order in which a sparse symmetric elimination takes them.
#pragma once

#include <vector>

namespace cdot {

// Blocks that are eliminated together, and their neighbours at that time.
struct Elimination {
  std::vector<int> blocks;
  std::vector<int> neighbours;  // in the order of elimination
};

// Minimum degree: takes the block whose remaining neighbours have the fewest rows. Blocks without fill-in come first,
// so chains and trees fill in nothing. Among equals it takes the block with the shortest chain of eliminations before
// it, then the first. A chain is thus eliminated from both ends, and two divisions overlap in the processor.
// neighbours: for each block, sorted, without itself. Blocks are joined up to `widest` rows where that adds no
// operations: in meshes, whose last blocks are all coupled.
std::vector<Elimination> minimum_degree_order(const std::vector<int>& rows, std::vector<std::vector<int>> neighbours,
                                              int widest);

}  // namespace cdot
