// Events of rows with bounds at the end of a step, as text.
#pragma once

#include <string>

#include "derive/compile/methods/contents.hpp"

namespace cdot::compile {

// latch(); waits: "true, false", by row.
std::string latch_of(const std::string& waits, const Contents& has);

}  // namespace cdot::compile
