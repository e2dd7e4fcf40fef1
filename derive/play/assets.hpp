// The parts of the page, which CMake puts into the program.
#pragma once

#include <string_view>

namespace cdot::play {

extern const std::string_view page_html, page_css, worker_js;
extern const std::string_view scripts[];  // in this order
extern const int script_count;

}  // namespace cdot::play
