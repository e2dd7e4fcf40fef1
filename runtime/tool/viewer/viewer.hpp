// A film -> a page that plays it, and a still. Both use the same drawing.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// The times of the frames: dense enough to look smooth, few enough for a page.
std::vector<double> film_times(const Scene& scene);

// One self-contained page: no other file, no network. `report` tells how the method was chosen.
std::string html_page(const Scene& scene, const std::vector<Frame>& film, const std::string& report = {});

// The mechanism at several times, older ones fainter, with the traces.
std::string svg_still(const Scene& scene, const std::vector<Frame>& film);

}  // namespace cdot
