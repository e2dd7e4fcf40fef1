// Files that hold the state of a run: where one stops, another goes on, with the same bits.
#pragma once

#include <string>

#include <cdot/snapshot.hpp>

namespace cdot {

// Throws cdot::Error with the path if there is no such file, or if it is no state.
Snapshot read_state(const std::string& path);

// The file appears whole or not at all.
void write_state(const std::string& path, const Snapshot& state);

}  // namespace cdot
