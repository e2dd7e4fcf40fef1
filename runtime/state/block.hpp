// The bytes of a State, one array after another, each from a multiple of Snapshot::alignment on.
#pragma once

#include <cstddef>
#include <vector>

#include <cdot/snapshot.hpp>

namespace cdot {

struct Block {
  struct Range {
    std::size_t begin, end;
  };
  std::vector<std::byte> bytes;
  std::vector<Snapshot::Item> items;
  Range common{};                           // time and counts
  std::vector<std::vector<Range>> islands;  // the share of each in all that steps change
};

// Lays out the State of a World whose islands were just analysed, and moves it there. Allocates.
template <class S>
struct WorldData;
template <class S>
void settle_state(WorldData<S>& world);

}  // namespace cdot
