// A drawing and a film -> the page, with the poses of every frame, and the still, with a few snapshots.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include <cdot/methods.hpp>

#include "runtime/text/html.hpp"
#include "runtime/text/json.hpp"
#include "runtime/tool/viewer/assets.hpp"
#include "runtime/tool/viewer/marks.hpp"
#include "runtime/tool/viewer/space.hpp"
#include "runtime/tool/viewer/viewer.hpp"

namespace cdot {
namespace {

using text::Json;

constexpr int most_frames = 3000;
constexpr double most_poses = 200000;  // frames times bodies that a page carries
constexpr int snapshots = 7;           // of a still

double rounded(double value, double steps_per_unit) { return std::round(value * steps_per_unit) / steps_per_unit; }

Json anchor_json(const Anchor& anchor) {
  return {anchor.body, rounded(anchor.local[0], 100), rounded(anchor.local[1], 100)};
}

std::vector<double> numbers_of(const Place& place) {
  return {rounded(place.x, 100), rounded(place.y, 100), rounded(place.degrees, 100)};
}

std::string group(const Mark& mark, const std::vector<Place>& places) {
  if (mark.body == world_body) return mark.svg + "\n";
  return fmt::format("<g data-body=\"{}\" transform=\"{}\">{}</g>\n", mark.body,
                     transform(places[static_cast<std::size_t>(mark.body)]), mark.svg);
}

// All marks at one time, with or without those of the world.
std::string placed(const Drawing& drawing, const std::vector<Place>& places, bool with_world = true) {
  std::string svg;
  for (std::size_t k = 0; k < drawing.links.size(); ++k) {
    svg += fmt::format("<g data-link=\"{}\" transform=\"{}\">{}</g>\n", k, link_transform(drawing.links[k], places),
                       drawing.links[k].svg);
  }
  for (const std::vector<Mark>* marks : {&drawing.bodies, &drawing.pins}) {
    for (const Mark& mark : *marks) {
      if (with_world || mark.body != world_body) svg += group(mark, places);
    }
  }
  return svg;
}

// A film lasts at least six seconds.
double playing_speed(double duration) {
  constexpr double speeds[] = {0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1};
  double best = speeds[0];
  for (const double speed : speeds) {
    if (duration / speed >= 6) best = speed;
  }
  return best;
}

// The poses of movable bodies frame by frame, and the curves of the plots.
template <class NumbersOf>
void add_frames(const Scene& scene, const std::vector<Frame>& film, NumbersOf numbers_of, Json& run) {
  std::vector<std::size_t> moving;
  std::vector<double> times, poses, energy, error;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    if (!scene.bodies[k].is_static) moving.push_back(k);
  }
  for (const Frame& frame : film) {
    times.push_back(frame.time);
    energy.push_back(frame.energy);
    error.push_back(frame.worst.value);
    for (const std::size_t body : moving)
      for (const double number : numbers_of(frame.bodies[body])) poses.push_back(number);
  }
  run.update({{"moving", moving}, {"times", times}, {"poses", poses}, {"energy", energy}, {"error", error}});
  run["sensors"] = Json::array();
  for (std::size_t k = 0; k < scene.sensors.size(); ++k) {
    std::vector<double> values;
    for (const Frame& frame : film) values.push_back(frame.sensors[k]);
    run["sensors"].push_back({{"name", scene.sensors[k].name}, {"unit", scene.sensors[k].unit}, {"values", values}});
  }
}

Json film_json(const std::vector<Frame>& film) {
  const double duration = film.back().time;
  return {{"speed", playing_speed(duration)},
          {"decimals", duration < 2 ? 4 : 2},
          {"tail", std::max<std::size_t>(film.size() / 8, 1)}};
}

Json planar_run(const Scene& scene, const Drawing& drawing, const std::vector<Frame>& film) {
  Json run = film_json(film);
  run["view"] = {drawing.view.left, drawing.view.top, drawing.view.scale};
  for (const char* list : {"traces", "links", "start"}) run[list] = Json::array();
  for (const Place& place : places_of(drawing.view, film.front())) run["start"].push_back(numbers_of(place));
  for (const Link& link : drawing.links) run["links"].push_back({anchor_json(link.from), anchor_json(link.to)});
  for (const Trace& trace : drawing.traces) {
    run["traces"].push_back({{"point", anchor_json(trace.point)}, {"colour", trace.colour}});
  }
  add_frames(
      scene, film, [&](const BodyState& body) { return numbers_of(place_of(drawing.view, body)); }, run);
  return run;
}

Json point_json(const SpacePoint& p) { return {p.body, p.local[0], p.local[1], p.local[2]}; }

Json space_json(const SpaceDrawing& drawing) {
  Json bodies = Json::array(), links = Json::array(), pins = Json::array(), traces = Json::array();
  for (const SpaceBody& body : drawing.bodies)
    bodies.push_back({{"kind", body.kind}, {"faces", body.faces}, {"lines", body.lines}, {"ball", body.ball}});
  for (const SpaceLink& link : drawing.links) links.push_back({point_json(link.from), point_json(link.to), link.kind});
  for (const SpacePoint& pin : drawing.pins) pins.push_back(point_json(pin));
  for (const SpaceTrace& trace : drawing.traces)
    traces.push_back({{"point", point_json(trace.point)}, {"colour", trace.colour}});
  const Camera& camera = drawing.camera;
  return {{"bodies", bodies},
          {"links", links},
          {"pins", pins},
          {"traces", traces},
          {"floor", drawing.floor},
          {"centre", drawing.centre},
          {"radius", drawing.radius},
          {"camera", {{"yaw", camera.yaw}, {"pitch", camera.pitch}, {"zoom", camera.zoom}}}};
}

Json spatial_run(const Scene& scene, const SpaceDrawing& drawing, const std::vector<Frame>& film) {
  Json run = film_json(film);
  run["space"] = space_json(drawing);
  const double steps = 1e4 / drawing.radius;
  const auto numbers_of = [&](const BodyState& b) {
    return std::vector{rounded(b.x, steps), rounded(b.y, steps), rounded(b.z, steps), rounded(b.e0, 1e5),
                       rounded(b.e1, 1e5),  rounded(b.e2, 1e5),  rounded(b.e3, 1e5)};
  };
  run["start"] = Json::array();
  for (const BodyState& body : film.front().bodies) run["start"].push_back(numbers_of(body));
  add_frames(scene, film, numbers_of, run);
  return run;
}

// "</script>" in a name would end the element.
std::string in_a_script(const Json& json) {
  std::string text = json.dump();
  for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
  return text;
}

// Fills each {{name}} of the template.
std::string filled(std::string_view page, const std::vector<std::pair<std::string, std::string>>& values) {
  std::string result;
  while (!page.empty()) {
    const std::size_t open = std::min(page.find("{{"), page.size());
    result += page.substr(0, open);
    page.remove_prefix(open);
    if (page.empty()) break;
    const std::string_view name = page.substr(2, page.find("}}") - 2);
    for (const auto& [key, value] : values) {
      if (key == name) result += value;
    }
    page.remove_prefix(name.size() + 4);
  }
  return result;
}

std::string svg_head(double width, double height, const std::string& attributes) {
  return fmt::format("<svg {} xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\">\n", attributes, width,
                     height);
}

std::string still_head(double width, double height) {
  return svg_head(width, height, fmt::format("width=\"{:.0f}\"", 0.8 * width)) +
         fmt::format(
             "<style>\n{}@media (prefers-color-scheme: dark) {{ svg {{ --ink: #e6edf3; --paper: "
             "#0d1117; }} }}\n</style>\n",
             viewer_marks_css);
}

// The mechanism at several times, older ones fainter. at(frame, last) draws one; only the last shows immovable bodies.
template <class At>
std::string snapshots_of(const std::vector<Frame>& film, At at) {
  std::string svg;
  for (int k = 0; k < snapshots; ++k) {
    const std::size_t frame = (film.size() - 1) * static_cast<std::size_t>(k) / (snapshots - 1);
    const bool last = k == snapshots - 1;
    svg += fmt::format("<g class=\"{}\" opacity=\"{:.2f}\">\n{}</g>\n", last ? "now" : "before",
                       last ? 1 : 0.15 + 0.07 * k, at(film[frame], last));
  }
  return svg;
}

std::string planar_still(const Drawing& drawing, const std::vector<Frame>& film) {
  std::string svg = still_head(drawing.view.width, drawing.view.height);
  for (const Trace& trace : drawing.traces)
    svg += trace_svg(fmt::format("c{}", trace.colour), film, [&](const Frame& frame) {
      const Vec2 at = position(trace.point, places_of(drawing.view, frame));
      return Place{at[0], at[1], 0};
    });
  return svg + snapshots_of(film, [&](const Frame& frame, bool last) {
           return placed(drawing, places_of(drawing.view, frame), last);
         });
}

std::string spatial_still(const SpaceDrawing& drawing, const std::vector<Frame>& film) {
  return still_head(drawing.width, drawing.height) + space_background(drawing, film) +
         snapshots_of(film, [&](const Frame& frame, bool last) { return space_snapshot(drawing, frame, last); });
}

}  // namespace

std::vector<double> film_times(const Scene& scene) {
  const double bodies = std::max<double>(1, static_cast<double>(scene.bodies.size()));
  const double most = std::min<double>(most_frames, most_poses / bodies);
  const double frames = std::clamp(60 * scene.duration, 600.0, std::max(600.0, most));
  // A film has no more frames than the run has steps.
  return every(std::max(scene.duration / frames, scene.step), scene.duration);
}

std::string html_page(const Scene& scene, const std::vector<Frame>& film, const std::string& report) {
  std::string stage, script(viewer_film_js);
  Json run;
  if (scene.dimension == Dimension::planar) {
    const Drawing drawing = draw(scene, film);
    stage = svg_head(drawing.view.width, drawing.view.height, "id=\"stage\"") + "<g id=\"paths\"></g>\n" +
            placed(drawing, places_of(drawing.view, film.front())) + "</svg>";
    run = planar_run(scene, drawing, film);
    script += viewer_plane_js;
  } else {
    const SpaceDrawing drawing = draw_in_space(scene, film);
    stage = svg_head(drawing.width, drawing.height, "id=\"stage\"") +
            "<path id=\"floor\" class=\"floor\"/><g id=\"space\"></g><g id=\"paths\"></g>\n</svg>";
    run = spatial_run(scene, drawing, film);
    script += viewer_space_js;
  }
  const std::string title = text::html_escaped(scene.title.empty() ? scene.file : scene.title);
  const Settings& method = scene.settings;
  const std::string steps = method.local_error > 0 ? fmt::format("local error {:.1e}", method.local_error)
                                                   : fmt::format("step {:.4g} s", scene.step);
  const std::string facts = fmt::format("{} bodies, {} joints, {}, {}", scene.bodies.size(), scene.joints.size(),
                                        name_of(integrators, method.integrator), steps);
  return filled(viewer_html, {{"title", title},
                              {"style", std::string(viewer_marks_css) + std::string(viewer_css)},
                              {"facts", facts},
                              {"report", text::html_escaped(report)},
                              {"stage", stage},
                              {"run", in_a_script(run)},
                              {"script", script + std::string(viewer_js)}});
}

std::string svg_still(const Scene& scene, const std::vector<Frame>& film) {
  return (scene.dimension == Dimension::planar ? planar_still(draw(scene, film), film)
                                               : spatial_still(draw_in_space(scene, film), film)) +
         "</svg>\n";
}

}  // namespace cdot
