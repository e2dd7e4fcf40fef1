// Events of rows with bounds at the end of a step, as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// Distances of all rows from their events, with the forces that rows have; and of row i the masks begins_now, ends_now,
// from the numbers `began`, `ended` so far.
std::string distances_now(const Contents& has);
inline constexpr const char* happens_now =
    "      const auto begins_now = after[i] <= near && began < T(1), ends_now = until[i] <= near && ended < T(1);\n";
// latch(); waits: "true, false", by row.
std::string latch_of(const std::string& waits, const Contents& has);

}  // namespace cdot::compile
