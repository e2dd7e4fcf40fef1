// The viewer's files as text: viewer_assets.cpp is made of them by CMake. A page's script is the
// film, then the drawing of the plane or of space, then the player.
#pragma once

#include <string_view>

namespace cdot {

extern const std::string_view viewer_html, viewer_css, viewer_marks_css, viewer_film_js, viewer_plane_js,
    viewer_space_js, viewer_js;

}  // namespace cdot
