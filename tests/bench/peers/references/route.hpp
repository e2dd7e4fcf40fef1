// The two routes to a reference: maximal coordinates with multipliers, the same code for every problem; and minimal
// coordinates, with separate code for each kind.
#pragma once

#include "tests/bench/peers/peer.hpp"

namespace cdot::peers {

// The states of all bodies at the problem's times, with each estimated step error below `tolerance`.
using Trajectory = std::vector<std::vector<State>>;

Trajectory maximal(const Problem& problem, long double tolerance);

Trajectory minimal(const Problem& problem, long double tolerance);

}  // namespace cdot::peers
