// Pictures of a run: a page that plays it, and a still. Both are made of one list of marks (what is
// drawn on which body), so that a mechanism looks the same in both.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// When the frames of a film are taken: densely enough to look smooth, few enough for a page.
std::vector<double> film_times(const Scene& scene);

// One page with everything in it: no other file, no network.
std::string html_page(const Scene& scene, const std::vector<Frame>& film);

// The mechanism at several times, older ones fainter, with the traces.
std::string svg_still(const Scene& scene, const std::vector<Frame>& film);

}  // namespace cdot
