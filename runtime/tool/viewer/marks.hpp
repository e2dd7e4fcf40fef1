// The drawing of a planar scene: marks on bodies, links between two points, traces. Picture coordinates: x right, y
// down, the longer side of the mechanism about 1000 wide.
#pragma once

#include <string>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"
#include "runtime/tool/viewer/picture.hpp"

namespace cdot {

using Vec2 = std::array<double, 2>;

// World to picture: X = scale (x - left), Y = scale (top - y); angles change sign and are in degrees.
struct View {
  double left = 0, top = 0, scale = 1;
  double width = 0, height = 0;  // of the picture
};

struct Place {
  double x, y, degrees;
};

View view_of(const Scene& scene, const std::vector<Frame>& film);
Place place_of(const View& view, const BodyState& state);
std::string transform(const Place& place);

struct Anchor {
  int body;    // index into Scene::bodies or world_body
  Vec2 local;  // in the body's frame, in picture units with y down; for the world: in the picture
};

struct Mark {
  int body;
  std::string svg;
};

// A drawing from (0, 0) to (1, 0), placed by its ends: scale(length, 1) leaves the stroke width.
struct Link {
  Anchor from, to;
  const char* svg;
};

struct Trace {
  Anchor point;
  int colour;  // of its body
};

struct Drawing {
  View view;
  std::vector<Mark> bodies, pins;  // pins lie above bodies
  std::vector<Link> links;
  std::vector<Trace> traces;
};

Drawing draw(const Scene& scene, const std::vector<Frame>& film);

Vec2 position(const Anchor& anchor, const std::vector<Place>& places);  // in the picture
std::string link_transform(const Link& link, const std::vector<Place>& places);
std::vector<Place> places_of(const View& view, const Frame& frame);

}  // namespace cdot
