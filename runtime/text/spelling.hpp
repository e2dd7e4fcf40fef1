// How near two words are, for "did you mean".
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace cdot::text {

// The candidate that becomes the word by the fewest edits of a letter (insert, delete, replace, swap of neighbours), at
// most so many; capitals do not count. Of equally near ones the first by the alphabet; empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string> candidates, std::size_t most_edits);

}  // namespace cdot::text
