// The work that a search may still do. It is counted, not timed: the same on every machine.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace cdot::derive {

// One unit is an operation built, moved or looked at, or a pair of operands counted.
struct Effort {
  std::int64_t left = 0;

  void spend(std::size_t units) { left = std::max<std::int64_t>(left - static_cast<std::int64_t>(units), 0); }
  bool spent() const { return left == 0; }
};

// Units for one program. The costliest of the catalogue takes 2.6 million; the costliest of a dihedral angle over four
// bodies, with 5,834 operations, takes 56 million.
inline constexpr std::int64_t most_effort = 100'000'000;

}  // namespace cdot::derive
