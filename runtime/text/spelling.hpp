// The nearest word, for "did you mean".
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace cdot::text {

// The candidate with the fewest edits of a letter (insert, delete, replace, swap of neighbours), at most `most_edits`;
// capitals do not count. Of equal candidates the first; empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string> candidates, std::size_t most_edits);
// "; did you mean `angle`?", empty if no candidate is near. Words of up to four letters differ from every other one by
// few edits.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace cdot::text
