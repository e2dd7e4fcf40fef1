// The two routes to a reference: maximal coordinates with multipliers, the same code for every problem; and as few
// coordinates as the problem has freedom, with code of its own for each kind.
#pragma once

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

// What all bodies do at the problem's times, each estimated step error below `tolerance`.
using Trajectory = std::vector<std::vector<State>>;

Trajectory maximal(const Problem& problem, long double tolerance);

Trajectory minimal(const Problem& problem, long double tolerance);

}  // namespace cdot::peers
