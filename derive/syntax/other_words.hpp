// The words of other languages for statements of this one.
#pragma once

#include <string_view>

namespace cdot::derive {

// "scalar" for `parameter`; a sentence if no statement has that meaning; empty for unknown words.
std::string_view meaning_of(std::string_view word);

}  // namespace cdot::derive
