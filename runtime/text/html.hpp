// Text within HTML and SVG.
#pragma once

#include <string>

namespace cdot::text {

std::string html_escaped(const std::string& text);

}  // namespace cdot::text
