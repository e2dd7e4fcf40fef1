// The drawing of a scene in space: faces and lines on bodies, links between points, pins, traces, and a floor for
// depth. The browser projects it for the page, space_still.cpp for the still.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "runtime/tool/run/frame.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

struct SpacePoint {
  int body;    // index into Scene::bodies or world_body
  Vec3 local;  // in the body's frame; of the world: in world axes
};

using SpaceFace = std::vector<Vec3>;  // anticlockwise seen from outside, in the body's frame
using SpaceLine = std::array<Vec3, 2>;

struct SpaceBody {
  std::string kind;  // the class of its colour
  std::vector<SpaceFace> faces;
  std::vector<SpaceLine> lines;
  double ball = 0;  // radius of a ball about its centre; 0: none
};

struct SpaceLink {
  SpacePoint from, to;
  std::string kind;
};

struct SpaceTrace {
  SpacePoint point;
  std::string colour;
};

// Rotated by yaw about the vertical, tilted down by pitch [rad].
struct Camera {
  double yaw = -0.9, pitch = 0.42, zoom = 1;
};

struct SpaceDrawing {
  std::vector<SpaceBody> bodies;
  std::vector<SpaceLink> links;
  std::vector<SpacePoint> pins;
  std::vector<SpaceTrace> traces;
  std::vector<SpaceLine> floor;
  Vec3 centre{};
  double radius = 1;
  Camera camera;
  double width = 1000, height = 760;  // of the picture
};

SpaceDrawing draw_in_space(const Scene& scene, const std::vector<Frame>& film);

// Content of an SVG of the drawing's size: the floor with the traces of a film, and the mechanism at one frame, with or
// without bodies that never move.
std::string space_background(const SpaceDrawing& drawing, const std::vector<Frame>& film);
std::string space_snapshot(const SpaceDrawing& drawing, const Frame& frame, bool with_still);

}  // namespace cdot
