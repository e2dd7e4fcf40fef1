// The bytes of a State: its arrays one after another, each aligned to Snapshot::alignment.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <cdot/snapshot.hpp>

namespace cdot {

struct Block {
  struct Range {
    std::size_t begin, end;
  };
  std::vector<std::byte> bytes;
  std::shared_ptr<const std::vector<Snapshot::Item>> items;  // of these bytes
  Range common{};                                            // time and counts
  std::vector<std::vector<Range>> islands;                   // ranges of each that steps change
  // Of whoever shows the bytes to a program (derive/python): receives them when another layout replaces them.
  std::weak_ptr<std::vector<std::byte>> heir;
};

// Lays out the State of a World after the analysis of islands and moves it into one block. Allocates.
template <class S>
struct WorldData;
template <class S>
void settle_state(WorldData<S>& world);

}  // namespace cdot
