// The viewer's files as text; CMake makes viewer_assets.cpp from them. The script of a page is the film, the drawing of
// the plane or of space, and the player.
#pragma once

#include <string_view>

namespace cdot {

extern const std::string_view viewer_html, viewer_css, viewer_marks_css, viewer_film_js, viewer_plane_js,
    viewer_space_js, viewer_js;

}  // namespace cdot
