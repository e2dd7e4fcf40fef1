// The order in which a sparse symmetric elimination takes its blocks. Apart from the elimination:
// it sees a graph and no numbers.
#pragma once

#include <vector>

namespace cdot {

struct Elimination {
  int block;
  std::vector<int> neighbours;  // that it has when its turn comes, those first whose turn is next
};

// Minimum degree: always the block whose remaining neighbours have the fewest rows. Among equals
// the one that waits for the shortest succession of others, so that a chain is eliminated from both
// its ends and a processor has two divisions under way; then the first.
// neighbours: of each block, sorted, without itself.
std::vector<Elimination> minimum_degree_order(const std::vector<int>& rows,
                                              std::vector<std::vector<int>> neighbours);

}  // namespace cdot
