// Messages for a terminal, in colour.
#pragma once

#include <cstdio>
#include <string>

namespace cdot::text {

// Whether texts for this stream may have colours: it is a terminal that can show them, and nobody set NO_COLOR
// (no-color.org).
bool has_colours(std::FILE* stream);

// The messages of `text` with their kinds, carets and fixes in colour; its letters stay.
std::string in_colour(const std::string& text);

// Writes messages, in colour where the stream has colours.
void print_messages(std::FILE* stream, const std::string& text);

}  // namespace cdot::text
