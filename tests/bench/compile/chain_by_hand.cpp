#include "tests/bench/compile/chain_by_hand.hpp"

#include "tests/bench/peers/engines/minimal_chain.hpp"

using namespace cdot::peers;

std::unique_ptr<Run> chain_by_hand(const Problem& problem, double h) {
  switch (problem.bodies.size()) {
    case 2: return std::make_unique<ChainRun<2>>(problem, h);
    case 3: return std::make_unique<ChainRun<3>>(problem, h);
    case 4: return std::make_unique<ChainRun<4>>(problem, h);
    default: return std::make_unique<ChainRun<10>>(problem, h);
  }
}
