// No generated C, J or K costs more than the cheapest published derivation of the same.
#include <array>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

// Space, joint, block, C or J or K, and a restriction such as "of pin" or "with t on a".
using Quantity = std::array<std::string, 5>;

// The cost of a quantity from poses and parameters after the passes of kernels: the number of operations, and the sum
// weighted by the cycles of each kind in a throughput-bound loop.
struct Cost {
  int total = 0, weighted = 0;
};

Cost cost_of(const std::vector<std::string>& cell) {
  constexpr int weights[] = {1, 1, 8, 10, 1, 40};  // add, multiply, divide, root, compare, call
  Cost cost;
  for (std::size_t kind = 0; kind < 6; ++kind) {
    const int count = std::stoi(cell.at(5 + kind));
    cost.total += count;
    cost.weighted += weights[kind] * count;
  }
  return cost;
}

struct Hand {
  Quantity of;
  std::string source;
  Cost cost;
};

struct Ledger {
  std::map<Quantity, Cost> generated;
  std::vector<Hand> hand;
};

Ledger read_ledger() {
  Ledger ledger;
  std::ifstream file(CDOT_SOURCE_DIR "/generated/ledger.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
    const std::string source = cell[4].substr(0, cell[4].find(' '));
    const Quantity of = {cell[0], cell[1], cell[2], cell[3], cell[4].substr(source.size())};
    if (source == "generated") {
      ledger.generated[of] = cost_of(cell);
    } else {
      ledger.hand.push_back({of, source, cost_of(cell)});
    }
  }
  return ledger;
}

// The published formulas of the joints of one space.
struct Compared {
  std::set<std::string> joints, quantities;
  int all = 0, cheaper = 0, scoped = 0;
};

Compared compare(const std::string& space) {
  const Ledger ledger = read_ledger();
  Compared compared;
  for (const Hand& hand : ledger.hand) {
    if (hand.of[0] != space) continue;
    const std::string what =
        hand.of[0] + " " + hand.of[1] + ", " + hand.of[2] + hand.of[4] + ": " + hand.of[3] + " against " + hand.source;
    const auto ours = ledger.generated.find(hand.of);
    if (ours == ledger.generated.end()) {
      ADD_FAILURE() << what << ": nothing is generated of the same";
      continue;
    }
    const Cost generated = ours->second, published = hand.cost;
    EXPECT_LE(generated.total, published.total) << what;
    EXPECT_LE(generated.weighted, published.weighted) << what << ", weighted";
    ++compared.all;
    compared.cheaper += generated.total < published.total ? 1 : 0;
    compared.scoped += hand.of[4].empty() ? 0 : 1;
    compared.joints.insert(hand.of[1]);
    compared.quantities.insert(hand.of[3]);
  }
  std::printf(
      "%s: %d published C, J and K, of %zu joints: %d cost more than what is generated, the others "
      "as much; %d are of some rows, or with directions fixed elsewhere\n",
      space.c_str(), compared.all, compared.joints.size(), compared.cheaper, compared.scoped);
  return compared;
}

}  // namespace

// The ledger has the formulas that agree at every pose. A formula that agrees only under an assumption may be cheaper.
TEST(Ledger, has_no_published_derivation_in_the_plane_cheaper_than_the_generated) {
  const Compared compared = compare("planar");
  EXPECT_EQ(compared.quantities, (std::set<std::string>{"C", "J", "K"}));
  EXPECT_GE(compared.joints.size(), 16u) << "most of the catalogue has been published by somebody";
  EXPECT_GE(compared.all, 90);
}

TEST(Ledger, has_no_published_derivation_in_space_cheaper_than_the_generated) {
  const Compared compared = compare("spatial");
  EXPECT_EQ(compared.quantities, (std::set<std::string>{"C", "J", "K"}));
  EXPECT_GE(compared.joints.size(), 14u) << "whatever agrees only once frames do is not compared";
  EXPECT_GE(compared.all, 45);
}
