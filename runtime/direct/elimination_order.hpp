// The order in which a sparse symmetric elimination takes its blocks. Apart from the elimination:
// it sees a graph and no numbers.
#pragma once

#include <vector>

namespace cdot {

// Blocks that are eliminated together, and the neighbours that they have when their turn comes.
struct Elimination {
  std::vector<int> blocks;
  std::vector<int> neighbours;  // those first whose turn is next
};

// Minimum degree: always the block whose remaining neighbours have the fewest rows; before all
// others those whose neighbours are all coupled already, so that chains and trees fill nothing in.
// Among equals the one that waits for the shortest succession of others, so that a chain is
// eliminated from both its ends and a processor has two divisions under way; then the first.
// neighbours: of each block, sorted, without itself. Blocks are eliminated together, up to `widest`
// rows, where that adds nothing to what is computed: in meshes, whose last blocks are all coupled.
std::vector<Elimination> minimum_degree_order(const std::vector<int>& rows, std::vector<std::vector<int>> neighbours,
                                              int widest);

}  // namespace cdot
