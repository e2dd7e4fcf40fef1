#include "tests/bench/ulp/ledger.hpp"

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace cdot::ulp {
namespace {

// By "space,joint,block,function".
std::map<std::string, int> read() {
  std::map<std::string, int> all;
  std::ifstream file(CDOT_GENERATED "/ledger.csv");
  for (std::string line; std::getline(file, line);) {
    std::istringstream cells(line);
    std::vector<std::string> cell;
    for (std::string c; std::getline(cells, c, ',');) cell.push_back(c);
    if (cell[4] != "generated") continue;
    all[cell[0] + ',' + cell[1] + ',' + cell[2] + ',' + cell[3]] = std::stoi(cell[11]);
  }
  return all;
}

}  // namespace

int operations(const MeasuredBlock<double>& measured, Measured which) {
  const AnyBlock& block = measured.shape;
  if (measured.operations > 0) return measured.operations;
  static const std::map<std::string, int> all = read();
  if (which == Measured::factor_and_solve) {
    return operations(measured, Measured::factor) + operations(measured, Measured::solve);
  }
  if (which >= Measured::impulse_fast) return 0;  // not generated, so not in the ledger
  const std::string key =
      std::string(block.space()) + ',' + block.joint + ',' + block.block + ',' + std::string(info(which).name);
  const auto found = all.find(key);
  if (found == all.end()) throw std::runtime_error("no row of the ledger: " + key);
  return found->second;
}

}  // namespace cdot::ulp
