// A scene: what a TOML file says, checked and with every name resolved, as plain data.
// specs/scenes/README.md is the format. Reading knows the joints only by their table of names and
// parameters (runtime/include/cdot/joints.hpp).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <cdot/effects.hpp>
#include <cdot/settings.hpp>
#include <cdot/world.hpp>

#include "runtime/tool/scene/mistakes.hpp"

namespace cdot {

using Vec3 = std::array<double, 3>;  // in planar scenes its third number is 0

inline constexpr int world_body = -1;  // the body index that "world" stands for in a scene

// How a body is drawn, and how its mass is spread if no inertia is given.
struct Shape {
  enum Kind { none, rod, box, disc, ball } kind = none;
  double length = 0,
         width = 0;  // along and across the body's x axis [m]; a disc's length is its diameter
  double depth = 0;  // along the body's z axis, in space: of a box, and the thickness of a disc
};

struct SceneBody {
  std::string name;
  BodyDefinition definition;      // of a planar scene
  SpatialBodyDefinition spatial;  // of a scene in space
  bool is_static = false;         // of either
  Shape shape;
  std::vector<Vec3> traces;  // points of the body whose paths are drawn
};

// Of its centre of mass at the start.
Vec3 position_of(const SceneBody& body, Dimension dimension);

struct SceneJoint {
  std::string name;
  JointDefinition definition;  // its bodies are indices into Scene::bodies, or world_body
  std::vector<CoordinateEffects> effects;
  std::optional<double> breaking;
  Span where;  // its header in the file
};

struct Scene {
  std::string file, title;
  Dimension dimension = Dimension::planar;
  Settings settings;
  bool single = false;      // computed in float
  double duration = 10;     // [s]
  double step = 0.001;      // [s]
  double accuracy = 0;      // [m], [rad] that the trajectory shall have, by a method of the runtime's choice; 0: as set
  double tolerance = 0.01;  // [m], [rad]: the joint error from which a run has failed
  OnFailure on_failure = OnFailure::stop;  // of a step
  bool project = false;                    // move an inconsistent start onto the joints
  std::vector<SceneBody> bodies;
  std::vector<SceneJoint> joints;
  std::vector<SpringDefinition> springs;
  std::shared_ptr<const Mistakes> source;  // to report, in its lines, what only the World finds
};

// Thrown if a scene has mistakes: what() is the whole report, one paragraph per mistake.
struct SceneError : std::runtime_error {
  SceneError(const std::string& report, int count) : std::runtime_error(report), mistakes(count) {}
  int mistakes;
};

Scene read_scene(const std::string& path);
Scene read_scene(std::string_view text, const std::string& name);

// The World of a scene: body k of the scene is body k of the World. What the World refuses is
// thrown as SceneError. The scene must be of the space's dimension.
template <class S>
BasicWorld<S> build_world_in(const Scene& scene);
template <class T>
World<T> build_world(const Scene& scene) {
  return build_world_in<Planar<T>>(scene);
}

// f(space), for the scene's dimension and numbers of type T.
template <class T, class F>
auto in_space_of(const Scene& scene, F f) {
  return scene.dimension == Dimension::planar ? f(Planar<T>{}) : f(Spatial<T>{});
}

// The rows that the start violates beyond `tolerance`, a paragraph for each of the first joints, and how many more
// there are; empty if there are none.
template <class S>
std::string inconsistency_report(const Scene& scene, const BasicWorld<S>& world, double tolerance);

}  // namespace cdot
