// Shared by all pictures: text in an element, paths, and the points with traces.
#pragma once

#include <fmt/format.h>
#include <string>
#include <string_view>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// "M1.0 2.0L3.0 4.0", of points with x and y.
template <class Points>
std::string path_through(const Points& points) {
  std::string path;
  for (const auto& p : points) path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', p.x, p.y);
  return path;
}

// The path of the point at(frame) over the film.
template <class At>
std::string trace_svg(const std::string& kind, const std::vector<Frame>& film, At at) {
  std::string svg = fmt::format("<polyline class=\"trace {}\" points=\"", kind);
  for (const Frame& frame : film) {
    const auto p = at(frame);
    svg += fmt::format("{:.1f},{:.1f} ", p.x, p.y);
  }
  return svg + "\"/>\n";
}

// Calls add(body, point) for the traces of the scene; without any, for the centre of the last movable body.
template <class Add>
void each_trace(const Scene& scene, Add add) {
  bool any = false;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    for (const Vec3& point : scene.bodies[k].traces) add(static_cast<int>(k), point), any = true;
  for (std::size_t k = scene.bodies.size(); k-- > 0 && !any;)
    if (!scene.bodies[k].is_static) add(static_cast<int>(k), Vec3{}), any = true;
}

}  // namespace cdot
