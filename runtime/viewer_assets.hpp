// The files viewer.html, viewer.css, viewer_marks.css and viewer.js as text: viewer_assets.cpp is
// made of them by CMake.
#pragma once

#include <string_view>

namespace cdot {

extern const std::string_view viewer_html, viewer_css, viewer_marks_css, viewer_js;

}  // namespace cdot
