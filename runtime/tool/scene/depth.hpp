// Bounds the depth of a scene's text, before toml++ reads it.
#pragma once

#include <optional>
#include <string_view>

#include "runtime/tool/scene/mistakes.hpp"

namespace cdot {

// More than any key of a scene has. toml++ bounds nested values itself, but not the parts of a dotted key, each of
// which costs a stack frame.
inline constexpr int most_parts_of_key = 16;

// The first key a.b.c… with too many parts: where the first part beyond the bound begins.
std::optional<Span> find_deep_key(std::string_view text);

}  // namespace cdot
