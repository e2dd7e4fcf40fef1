// The chain by hand, built as the peers are: without the options of compiled scenes.
#pragma once

#include <memory>

#include "tests/bench/peers/peer.hpp"

// Of 2, 3, 4 or 10 links, in steps of h.
std::unique_ptr<cdot::peers::Run> chain_by_hand(const cdot::peers::Problem& problem, double h);
